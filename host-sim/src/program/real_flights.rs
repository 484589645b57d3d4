//! The commands about flights of real vehicles.

use crate::arguments::{IdentifyArguments, RealFlightArguments, ReplayLawArguments};
use crate::terminal::{complain, print_text, same_file, status, text_of};
use host_sim::output::whole_file::WholeFile;
use host_sim::real_flights::command::{self, Refused, Task};
use host_sim::real_flights::picture;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn task(arguments: &RealFlightArguments) -> Result<Task, String> {
    Ok(Task {
        log: arguments.log.clone(),
        columns: arguments.columns.clone(),
        original: text_of(Some(&arguments.scenario))?,
        file: arguments.scenario.display().to_string(),
    })
}

/// Prints what came of it.
fn shown(report: Result<String, Refused>) -> Result<ExitCode, String> {
    match report {
        Ok(report) => {
            print_text(&report)?;
            Ok(status(true, None))
        }
        Err(Refused::NotShown(what)) => {
            complain(format_args!("error: {what}"));
            Ok(status(false, None))
        }
        Err(Refused::Input(what)) => Err(what),
    }
}

pub fn run_replay_model(arguments: &RealFlightArguments) -> Result<ExitCode, String> {
    shown(command::replayed_model(&task(arguments)?))
}

pub fn run_replay_estimator(arguments: &RealFlightArguments) -> Result<ExitCode, String> {
    shown(command::replayed_estimator(&task(arguments)?))
}

pub fn run_replay_law(ReplayLawArguments { flight, plot }: &ReplayLawArguments) -> Result<ExitCode, String> {
    let read = [Some(&flight.log), flight.columns.as_ref(), Some(&flight.scenario)];
    other_than(plot.as_deref(), "--plot", &read)?;
    let report = match command::replayed_law(&task(flight)?) {
        Err(refused) => Err(refused),
        Ok((report, result)) => {
            if let Some(plot) = plot {
                write(plot, &picture::drawn(&result.track))?;
            }
            Ok(report)
        }
    };
    shown(report)
}

/// `identify --columns`.
pub fn identified(arguments: &IdentifyArguments, original: String, file: String) -> Result<ExitCode, String> {
    let task = Task { log: arguments.log.clone(), columns: arguments.columns.clone(), original, file };
    let report = match command::identified(&task) {
        Err(refused) => Err(refused),
        Ok((report, text)) => {
            let written =
                arguments.out.as_ref().map(|out| write(out, &text).map(|()| format!("written to {}\n", out.display())));
            Ok(report + &written.transpose()?.unwrap_or_default())
        }
    };
    shown(report)
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    WholeFile::write(path, text).map_err(|error| format!("{}: cannot be written: {error}", path.display()))
}

fn other_than(out: Option<&Path>, option: &str, read: &[Option<&PathBuf>]) -> Result<(), String> {
    match out {
        Some(out) if read.iter().flatten().any(|file| same_file(out, file)) => {
            Err(format!("{}: {option} must be another file than those that are read", out.display()))
        }
        _ => Ok(()),
    }
}
