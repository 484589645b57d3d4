//! Flies scenarios on the desktop and serves the control law to other simulators.

mod arguments;

use arguments::{
    Arguments, CampaignArguments, Command, CompareArguments, HilArguments, MergeArguments, SitlArguments, TuneArguments,
};
use clap::Parser;
use host_sim::campaign::draw::circumstances;
use host_sim::campaign::summary::Summary;
use host_sim::campaign::{self, CampaignError};
use host_sim::certify::certify;
use host_sim::claims;
use host_sim::compare::{self, CompareError, compare};
use host_sim::fly::{FlyError, fly};
use host_sim::hil::port::Port;
use host_sim::hil::relay::Relay;
use host_sim::hil::{self, Clients, End, HilError};
use host_sim::interrupt::Interrupt;
use host_sim::law::LawServer;
use host_sim::log::bytes_per_row;
use host_sim::rivals::gains::{self, Set};
use host_sim::rivals::tuning;
use host_sim::sitl::{self, SitlError};
use host_sim::table::{percent, short};
use host_sim::tune::effort::Effort;
use host_sim::tune::{Tuned, output, tune, widest_bounds};
use host_sim::whole_file::WholeFile;
use scenario::{STUDY, Scenario, bounds, check_name};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// A well-posed run whose claims fail.
const CLAIMS_FAIL: u8 = 1;
/// Input that cannot be used, or output that cannot be written.
const BAD_INPUT: u8 = 2;
/// What a signal's number is added to, as shells do.
const INTERRUPTED: u8 = 128;
/// The largest log that nobody is asked about, bytes.
const LARGE_LOG: u64 = 1_000_000_000;

fn main() -> ExitCode {
    let outcome = match Arguments::try_parse() {
        Err(message) => explain(&message),
        Ok(Arguments { command }) => match command {
            None => run_fly(None, None, false, false),
            Some(Command::Fly { file, out, mcap, large_log }) => run_fly(file.as_deref(), out, mcap, large_log),
            Some(Command::Certify { file }) => run_certify(file.as_deref()),
            Some(Command::Tune(arguments)) => run_tune(&arguments),
            Some(Command::Campaign(arguments)) => run_campaign(&arguments),
            Some(Command::Merge(arguments)) => run_merge(&arguments),
            Some(Command::Compare(arguments)) => run_compare(&arguments),
            Some(Command::Law { file }) => run_law(file.as_deref()),
            Some(Command::Hil(arguments)) => run_hil(&arguments),
            Some(Command::Sitl(arguments)) => run_sitl(&arguments),
        },
    };
    outcome.unwrap_or_else(|message| {
        eprintln!("error: {message}");
        ExitCode::from(BAD_INPUT)
    })
}

/// Writes to standard output, whole. A reader that has gone away changes no verdict.
fn print(write: impl FnOnce() -> io::Result<()>) -> Result<(), String> {
    match write().and_then(|()| io::stdout().flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(format!("standard output: cannot be written: {error}"))
        }
        _ => Ok(()),
    }
}

fn print_text(text: &str) -> Result<(), String> {
    print(|| io::stdout().write_all(text.as_bytes()))
}

/// Help, the version, or what is wrong with the arguments.
fn explain(message: &clap::Error) -> Result<ExitCode, String> {
    if message.use_stderr() {
        // Where even stderr cannot be written, the status is all that is left.
        let _ = message.print();
    } else {
        print(|| message.print())?;
    }
    Ok(ExitCode::from(u8::try_from(message.exit_code()).unwrap_or(BAD_INPUT)))
}

fn load(file: Option<&Path>) -> Result<Scenario, String> {
    file.map_or_else(Scenario::paper, Scenario::load).map_err(|error| error.to_string())
}

/// What a scenario is read from, once: a pipe cannot be read twice.
fn text_of(file: Option<&Path>) -> Result<String, String> {
    let read = |file: &Path| {
        std::fs::read_to_string(file).map_err(|error| format!("{}: cannot be read: {error}", file.display()))
    };
    file.map_or_else(|| Ok(scenario::PAPER.to_owned()), read)
}

fn watch() -> Result<Interrupt, String> {
    Interrupt::watch().map_err(|error| format!("signals cannot be watched: {error}"))
}

/// The status of a run that held or did not, unless it was cut short.
fn status(holds: bool, signal: Option<u8>) -> ExitCode {
    match (signal, holds) {
        (Some(signal), _) => ExitCode::from(INTERRUPTED + signal),
        (None, true) => ExitCode::SUCCESS,
        (None, false) => ExitCode::from(CLAIMS_FAIL),
    }
}

fn run_fly(file: Option<&Path>, out: Option<PathBuf>, mcap: bool, large_log: bool) -> Result<ExitCode, String> {
    let text = text_of(file)?;
    let name = file.map_or_else(|| "scenarios/paper.toml (built in)".to_owned(), |file| file.display().to_string());
    let scenario = Scenario::parse(&text, &name).map_err(|error| error.to_string())?;
    if let Some(size) = large(&scenario) {
        let named = file.map_or_else(String::new, |file| format!("{}: ", file.display()));
        if !large_log {
            return Err(format!(
                "{named}{size}: take a shorter duration, a lower control.rate, or allow it with --large-log"
            ));
        }
        eprintln!("{named}{size}");
    }
    let directory = out.unwrap_or_else(|| Path::new("flights").join(&scenario.name));
    fly_into(&scenario, &text, &directory, mcap)
}

/// Flies one flight of a scenario from a file with this `text`, and says what came of it.
fn fly_into(scenario: &Scenario, text: &str, directory: &Path, mcap: bool) -> Result<ExitCode, String> {
    let outcome = match fly(scenario, text, directory, mcap, &watch()?) {
        Ok(outcome) => outcome,
        Err(error @ (FlyError::Flight(_) | FlyError::Interrupted(_))) => {
            eprintln!("error: {}: {error}", scenario.name);
            let signal = if let FlyError::Interrupted(signal) = error { Some(signal) } else { None };
            return Ok(status(false, signal));
        }
        Err(error) => return Err(error.to_string()),
    };
    let holds = claims::all_hold(&outcome.claims);
    print_text(&format!(
        "{}: {} s flown; {}\n\n{}\n{}; log, figures and report in {}\n",
        scenario.name,
        scenario.timing.duration(),
        outcome.certification,
        claims::table(&outcome.claims),
        if holds { "every claim holds" } else { "NOT every claim holds" },
        directory.display()
    ))?;
    Ok(status(holds, None))
}

fn run_campaign(arguments: &CampaignArguments) -> Result<ExitCode, String> {
    let (scenario, text) = arguments.scenario()?;
    let orders = arguments.orders(&scenario)?;
    if let Some(number) = arguments.replay {
        let mut thrown = circumstances(&scenario, &scenario.campaign.ranges, orders.seed, number);
        thrown.name = format!("{}-{number}", scenario.name);
        return fly_into(&thrown, &text, &arguments.directory(&thrown), false);
    }
    let (directory, interrupt) = (arguments.directory(&scenario), watch()?);
    show_campaign(campaign::fly::campaign(&scenario, &text, &orders, &directory, &interrupt), &directory)
}

fn run_merge(arguments: &MergeArguments) -> Result<ExitCode, String> {
    show_campaign(campaign::fly::merge(&arguments.shards, &arguments.out), &arguments.out)
}

fn show_campaign(flown: Result<Summary, CampaignError>, directory: &Path) -> Result<ExitCode, String> {
    match flown {
        Ok(summary) => {
            print_text(&format!(
                "{summary}\nevery flight is a row of {}\n",
                directory.join("campaign.arrow").display()
            ))?;
            Ok(status(summary.holds, None))
        }
        Err(CampaignError::Interrupted(signal)) => {
            eprintln!("error: {}: {}", directory.display(), CampaignError::Interrupted(signal));
            Ok(status(false, Some(signal)))
        }
        Err(error) => Err(error.to_string()),
    }
}

/// What the log of a flight will take, if that is a lot.
fn large(scenario: &Scenario) -> Option<String> {
    let rows = scenario.timing.ticks;
    let bytes = rows.saturating_mul(bytes_per_row(&scenario.reality));
    (bytes > LARGE_LOG).then(|| format!("log.csv will take about {} GB, {rows} rows", short(bytes as f64 / 1e9)))
}

fn run_law(file: Option<&Path>) -> Result<ExitCode, String> {
    let scenario = load(file)?;
    let mut server = LawServer::new(&scenario).map_err(|error| error.to_string())?;
    server.serve(io::stdin().lock(), io::stdout().lock()).map_err(|error| error.to_string())?;
    Ok(ExitCode::SUCCESS)
}

fn run_hil(arguments: &HilArguments) -> Result<ExitCode, String> {
    let scenario = Scenario::load(&arguments.file).map_err(|error| error.to_string())?;
    let (session, ground) = (arguments.session()?, arguments.ground()?);
    let (interrupt, patience) = (watch()?, arguments.patience()?);
    let mut port = Port::open(&arguments.address()?, patience, &interrupt).map_err(|error| error.to_string())?;
    let mut tell = |line: &str| drop(print_text(&format!("{line}\n")));
    let clients = match ground {
        None => None,
        Some((line, ports)) => {
            let relay = Relay::open(line, &ports, patience, &interrupt).map_err(|error| error.to_string())?;
            Some(Clients { relay, tell: &mut tell })
        }
    };
    match hil::serve(&scenario, &mut port, &session, arguments.log.as_deref(), clients) {
        Ok(summary) => {
            print_text(&format!("{}: {summary}\n", scenario.name))?;
            let signal = if let End::Interrupted(signal) = summary.end { Some(signal) } else { None };
            Ok(status(true, signal))
        }
        Err(error @ HilError::Flight(_)) => {
            eprintln!("error: {}: {error}", scenario.name);
            Ok(status(false, None))
        }
        Err(error) => Err(error.to_string()),
    }
}

fn run_sitl(arguments: &SitlArguments) -> Result<ExitCode, String> {
    let (text, name) = match &arguments.file {
        Some(file) => (text_of(Some(file))?, file.display().to_string()),
        None => (STUDY.to_owned(), "vehicles/study.toml (built in)".to_owned()),
    };
    let scenario = Scenario::parse(&text, &name).map_err(|error| error.to_string())?;
    let session = arguments.session(text)?;
    // Whoever has stopped to read is none the less a pilot.
    let show = |line: &str| drop(print_text(&format!("{line}\n")));
    match sitl::run(&scenario, &session, &watch()?, show) {
        Ok(summary) => {
            print_text(&format!("{}: {summary}\n", scenario.name))?;
            Ok(status(true, summary.signal))
        }
        Err(error @ SitlError::Diverged(_)) => {
            eprintln!("error: {}: {error}", scenario.name);
            Ok(status(false, None))
        }
        Err(SitlError::Input(what)) => Err(what),
    }
}

fn run_certify(file: Option<&Path>) -> Result<ExitCode, String> {
    let (text, certified) = certify(&load(file)?).map_err(|error| error.to_string())?;
    print_text(&text)?;
    Ok(status(certified, None))
}

fn run_tune(arguments: &TuneArguments) -> Result<ExitCode, String> {
    let requirements = arguments.requirements()?;
    let mut scenario = Scenario::load(&arguments.file).map_err(|error| error.to_string())?;
    let original = std::fs::read_to_string(&arguments.file)
        .map_err(|error| format!("{}: cannot be read: {error}", arguments.file.display()))?;
    let (name, path) = destination(arguments, &scenario)?;
    scenario.name = name;
    let unwritable = |error| format!("{}: cannot be written: {error}", path.display());
    let effort = Effort { generations: arguments.generations, population: arguments.population, seed: arguments.seed };
    let interrupt = watch()?;
    let tuned = match tune(&scenario, requirements, effort, &interrupt) {
        Ok(tuned) => tuned,
        Err(closest) => {
            let what = closest.failed.clone().unwrap_or_default();
            let lost = short(closest.shown.height_lost);
            let stopped = if interrupt.signal().is_some() { "interrupted before any gains were found; " } else { "" };
            eprintln!(
                "error: {}: {stopped}no gains meet the requirements, nothing is written; the closest fail in: {what} \
                 (height lost {lost} m)",
                scenario.name
            );
            return Ok(status(false, interrupt.signal()));
        }
    };
    let text = output::rewritten(&original, &tuned).map_err(|error| error.to_string())?;
    WholeFile::write(&path, &text).map_err(unwritable)?;
    let mut summary = found(&tuned, &path, interrupt.signal().is_some())?;
    if arguments.widen {
        let (factor, widest) =
            widest_bounds(&tuned.scenario.configuration, requirements.margin).map_err(|error| error.to_string())?;
        summary += &format!(
            "\nwith these gains every margin stays at least {} for references {} times as demanding:\n\n{}",
            percent(requirements.margin),
            short(factor),
            bounds::written(&widest)
        );
    }
    print_text(&summary)?;
    Ok(status(true, interrupt.signal()))
}

fn run_compare(arguments: &CompareArguments) -> Result<ExitCode, String> {
    let effort = arguments.effort()?;
    let scenario = Scenario::load(&arguments.file).map_err(|error| error.to_string())?;
    let directory = arguments.directory(&scenario.name);
    let interrupt = watch()?;
    let mut found = None;
    let set = match (&effort, &arguments.gains) {
        (Some(effort), _) => match tuning::tune(&scenario, *effort, &interrupt) {
            Ok(set) => {
                found = Some(("rivals.toml", set.written(&scenario, &arguments.command(effort))));
                set
            }
            Err(message) => {
                eprintln!("error: {}: {message}", scenario.name);
                return Ok(status(false, interrupt.signal()));
            }
        },
        (None, Some(file)) => {
            Set::of(&scenario, &text_of(Some(file))?, &file.display().to_string()).map_err(|error| error.to_string())?
        }
        (None, None) => Set::of(&scenario, gains::BUILT_IN, "the built-in gains").map_err(|error| error.to_string())?,
    };
    let mut comparison = match compare(&scenario, &set, arguments.flights, &interrupt) {
        Ok(comparison) => comparison,
        Err(error @ (CompareError::NotCertified(_) | CompareError::Interrupted(_))) => {
            eprintln!("error: {}: {error}", scenario.name);
            return Ok(status(false, interrupt.signal()));
        }
        Err(error) => return Err(error.to_string()),
    };
    comparison.files.extend(found);
    compare::write(&comparison, &directory).map_err(|error| error.to_string())?;
    print_text(&format!(
        "{}: our law and {} others; {} random flights of each\n\n{}\n* another law does better; {}; table, pictures in {}\n",
        scenario.name,
        set.rivals.len(),
        arguments.flights,
        comparison.text,
        if comparison.holds {
            "every random flight of ours settles, unclipped, within its bounds"
        } else {
            "NOT every random flight of ours settles, unclipped, within its bounds"
        },
        directory.display()
    ))?;
    Ok(status(comparison.holds, None))
}

/// The name of a tuned scenario and the file it goes to. Whatever is wrong with them shows now, not after the search.
fn destination(arguments: &TuneArguments, scenario: &Scenario) -> Result<(String, PathBuf), String> {
    let stem = arguments.out.as_deref().and_then(Path::file_stem);
    let name = stem.map_or_else(|| format!("{}-tuned", scenario.name), |stem| stem.to_string_lossy().into_owned());
    check_name(&name).map_err(|error| format!("--out: becomes the scenario's name: {error}"))?;
    let path = arguments.out.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.toml")));
    if same_file(&path, &arguments.file) {
        return Err(format!("{}: --out must be another file than the one tuned", path.display()));
    }
    let writable =
        if path.is_dir() { Err(io::ErrorKind::IsADirectory.into()) } else { WholeFile::create(&path).map(drop) };
    writable.map_err(|error| format!("{}: cannot be written: {error}", path.display()))?;
    Ok((name, path))
}

/// What a search says of the gains it found.
fn found(tuned: &Tuned, path: &Path, interrupted: bool) -> Result<String, String> {
    let (certificate, _) = certify(&tuned.scenario).map_err(|error| error.to_string())?;
    let active = tuned.verdict.tightest.map_or(String::new(), |tightest| {
        format!("active constraint: {}, margin {}\n", tightest.name, percent(tightest.margin()))
    });
    let shown = &tuned.verdict.shown;
    Ok(format!(
        "{certificate}\n{}\nheight lost {} m, back after {} s; gust {} m; step {} s; under noise {} m and {} N a tick; cost {}\n\
         {active}{}{} candidates judged; written to {}\n",
        tuned.frontier.table(),
        short(shown.height_lost),
        short(shown.recovered),
        short(shown.gust),
        short(shown.step),
        short(shown.noise),
        short(shown.activity),
        short(tuned.verdict.cost),
        if interrupted { "interrupted: the best so far; " } else { "" },
        tuned.judged,
        path.display()
    ))
}

/// Whether both paths lead to one file that exists.
fn same_file(one: &Path, other: &Path) -> bool {
    matches!((one.canonicalize(), other.canonicalize()), (Ok(one), Ok(other)) if one == other)
}
