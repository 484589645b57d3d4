//! The commands that read files of others: `identify` and `log` flights, `vehicle` models.

use crate::arguments::{IdentifyArguments, LogArguments, VehicleArguments};
use crate::real_flights::identified;
use crate::terminal::{complain, print_text, same_file, status, text_of};
use host_sim::identification::identify::command::{self, Refused, Task};
use host_sim::identification::import;
use host_sim::identification::import::existing;
use host_sim::identification::import::written::written;
use host_sim::identification::ulog;
use host_sim::output::whole_file::WholeFile;
use scenario::{STUDY, Scenario};
use std::path::Path;
use std::process::ExitCode;

/// A scenario's text and its name: of `file`, or of what is built in where boards are meant.
pub fn given_or_study(file: Option<&Path>) -> Result<(String, String), String> {
    match file {
        Some(file) => Ok((text_of(Some(file))?, file.display().to_string())),
        None => Ok((STUDY.to_owned(), "vehicles/study.toml (built in)".to_owned())),
    }
}

pub fn run_identify(arguments: &IdentifyArguments) -> Result<ExitCode, String> {
    let (original, file) = given_or_study(arguments.scenario.as_deref())?;
    if let Some(out) = &arguments.out {
        let read = [
            ("the scenario", &arguments.scenario),
            ("the log", &Some(arguments.log.clone())),
            ("the bench file", &arguments.bench),
            ("the file of columns", &arguments.columns),
        ];
        if let Some((what, _)) = read.iter().find(|(_, file)| file.as_ref().is_some_and(|file| same_file(out, file))) {
            return Err(format!("{}: --out must be another file than {what}", out.display()));
        }
    }
    if arguments.columns.is_some() {
        return identified(arguments, original, file);
    }
    let task =
        Task { log: arguments.log.clone(), original, file, bench: arguments.bench.clone(), out: arguments.out.clone() };
    match command::run(&task) {
        Ok(report) => {
            print_text(&report)?;
            Ok(status(true, None))
        }
        Err(Refused::NotIdentifiable(what)) => {
            complain(format_args!("error: {what}"));
            Ok(status(false, None))
        }
        Err(Refused::Input(what)) => Err(what),
    }
}

/// From a log and a place to the text that says what was written there.
type Conversion = fn(&Path, &Path) -> Result<String, String>;

pub fn run_log(LogArguments { log, ulog, spectrum }: &LogArguments) -> Result<ExitCode, String> {
    let runs: [(_, _, Conversion); 2] =
        [("--ulog", ulog, ulog::command::run), ("--spectrum", spectrum, ulog::command::draw)];
    for (option, out, run) in runs {
        let Some(out) = out else { continue };
        if same_file(out, log) {
            return Err(format!("{}: {option} must be another file than the log", out.display()));
        }
        print_text(&run(log, out)?)?;
    }
    Ok(status(true, None))
}

pub fn run_vehicle(arguments: &VehicleArguments) -> Result<ExitCode, String> {
    let (source, out) = (arguments.source.display(), arguments.out.display());
    let name = arguments.name()?;
    if same_file(&arguments.source, &arguments.out) {
        return Err(format!("{out}: --out must be another file than the source"));
    }
    let text = text_of(Some(&arguments.source))?;
    let vehicle = import::read(&text, &arguments.source, arguments.format());
    let vehicle = vehicle.map_err(|what| format!("{source}: {what}"))?;
    let from = arguments.source.file_name().unwrap_or_default().to_string_lossy();
    let file = written(&vehicle, &name, &from, &arguments.wishes()).map_err(|what| format!("--with {what}"))?;
    if arguments.out.is_file() && !arguments.overwrite {
        let there = scenario::text::read(&arguments.out).map_err(|error| format!("{out}: is there: {error}"))?;
        if let Some(why) = existing::objection(&there, &file.text) {
            return Err(format!("{out}: {why}; --with KEY=VALUE keeps a number, --overwrite none"));
        }
    }
    WholeFile::write(&arguments.out, &file.text).map_err(|error| format!("{out}: cannot be written: {error}"))?;
    let parsed = Scenario::parse(&file.text, &out.to_string());
    let unusual = parsed.iter().flat_map(|scenario| &scenario.unusual);
    let unusual: String = unusual.map(|unusual| format!("unusual: {unusual}\n")).collect();
    let refused = parsed.err().map(|error| error.to_string());
    let next = match &refused {
        None => format!("next: host-sim certify {out}"),
        Some(_) if !file.missing.is_empty() => format!(
            "missing: {}; the file says how to measure each, --with gives one: NOT to be used before",
            file.missing.join(", ")
        ),
        Some(why) => format!("NOT to be used as it is: {why}"),
    };
    print_text(&format!("{source}: {}; written to {out}\n{unusual}{next}\n", vehicle.source))?;
    Ok(status(refused.is_none(), None))
}
