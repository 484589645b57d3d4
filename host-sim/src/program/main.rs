//! Flies scenarios on the desktop and serves the control law to other simulators.

mod arguments;
mod readers;
mod real_flights;
mod searches;
mod terminal;

use arguments::{
    Arguments, CampaignArguments, CertifyArguments, Command, FirstFlightArguments, HilArguments, ManArguments,
    MergeArguments, ReferenceArguments, ReplayArguments, SitlArguments, completions, manual,
};
use clap::{CommandFactory, Parser};
use host_sim::commands::certify::rigorous::{self, Rigorous};
use host_sim::commands::certify::{certify, constants, may_fly};
use host_sim::commands::fly::default_task::{FlownFile, with_default_task};
use host_sim::commands::fly::{FlyError, fly, watched};
use host_sim::commands::law::LawServer;
use host_sim::flight::claims;
use host_sim::output::table::short;
use host_sim::output::whole_file::WholeFile;
use host_sim::reports::log::bytes_per_row;
use host_sim::reports::plots::replay::gif;
use host_sim::reports::reference_rows;
use host_sim::rivals::choice::LawChoice;
use host_sim::sessions::first_flight::checks::CHECKS;
use host_sim::sessions::first_flight::line::Line;
use host_sim::sessions::first_flight::record::Record;
use host_sim::sessions::first_flight::vehicle::{Stop, Vehicle};
use host_sim::sessions::first_flight::walk::Walk;
use host_sim::sessions::first_flight::{self, course};
use host_sim::sessions::hil::port::SimulatorPort;
use host_sim::sessions::hil::relay::Relay;
use host_sim::sessions::hil::{self, Clients, End, HilError};
use host_sim::sessions::sitl::{self, SitlError};
use host_sim::studies::campaign::draw::circumstances;
use host_sim::studies::campaign::summary::Summary;
use host_sim::studies::campaign::written::above;
use host_sim::studies::campaign::{self, CampaignError};
use host_sim::studies::recovery::{Refused, recovery};
use readers::{given_or_study, run_identify, run_log, run_vehicle};
use real_flights::{run_replay_estimator, run_replay_law, run_replay_model};
use scenario::verdict::Verdict;
use scenario::{Scenario, board};
use searches::{run_compare, run_tune};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use terminal::{BAD_INPUT, complain, not_a_campaigns, print, print_text, same_file, status, text_of, watch};

/// The largest log without `--large-log`.
const LARGE_LOG_BYTES: u64 = 1_000_000_000;

fn main() -> ExitCode {
    let outcome = match Arguments::try_parse() {
        Err(message) => explain(&message),
        Ok(Arguments { command }) => match command {
            None => run_fly(None, None, false, false),
            Some(Command::Fly { file, out, mcap, large_log }) => run_fly(file.as_deref(), out, mcap, large_log),
            Some(Command::Replay(arguments)) => run_replay(&arguments),
            Some(Command::Reference(arguments)) => run_reference(&arguments),
            Some(Command::Certify(arguments)) if arguments.recovery => run_recovery(&arguments),
            Some(Command::Certify(arguments)) => run_certify(&arguments),
            Some(Command::Tune(arguments)) => run_tune(&arguments),
            Some(Command::Identify(arguments)) => run_identify(&arguments),
            Some(Command::ReplayModel(arguments)) => run_replay_model(&arguments),
            Some(Command::ReplayEstimator(arguments)) => run_replay_estimator(&arguments),
            Some(Command::ReplayLaw(arguments)) => run_replay_law(&arguments),
            Some(Command::Log(arguments)) => run_log(&arguments),
            Some(Command::Vehicle(arguments)) => run_vehicle(&arguments),
            Some(Command::Campaign(arguments)) => run_campaign(&arguments),
            Some(Command::Merge(arguments)) => run_merge(&arguments),
            Some(Command::Compare(arguments)) => run_compare(&arguments),
            Some(Command::Law { file }) => run_law(file.as_deref()),
            Some(Command::Hil(arguments)) => run_hil(&arguments),
            Some(Command::Sitl(arguments)) => run_sitl(&arguments),
            Some(Command::FirstFlight(arguments)) => run_first_flight(&arguments),
            Some(Command::Schema) => {
                print_text(&format!("{:#}\n", scenario::schema::schema())).map(|()| ExitCode::SUCCESS)
            }
            Some(Command::Completions(arguments)) => {
                print(|| io::stdout().write_all(&completions(&arguments, Arguments::command())))
                    .map(|()| ExitCode::SUCCESS)
            }
            Some(Command::Man(arguments)) => run_man(&arguments),
        },
    };
    outcome.unwrap_or_else(|message| {
        complain(format_args!("error: {message}"));
        ExitCode::from(BAD_INPUT)
    })
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

fn run_fly(file: Option<&Path>, out: Option<PathBuf>, mcap: bool, large_log: bool) -> Result<ExitCode, String> {
    let text = text_of(file)?;
    let name = file.map_or_else(|| "scenarios/paper.toml (built in)".to_owned(), |file| file.display().to_string());
    let FlownFile { scenario, text, added } = with_default_task(text, &name).map_err(|error| error.to_string())?;
    let named = file.map_or_else(String::new, |file| format!("{}: ", file.display()));
    permit(&scenario, &named, "duration", large_log)?;
    let directory = out.unwrap_or_else(|| Path::new("flights").join(&scenario.name));
    if let Some(added) = added {
        print_text(&format!("{named}has neither [initial] nor [reference], so it flies {added}\n"))?;
    }
    fly_into(&scenario, &text, &LawChoice::Ours, &directory, mcap)
}

/// Flies one flight of a scenario from a file with this `text`, and prints its claims.
fn fly_into(
    scenario: &Scenario,
    text: &str,
    law: &LawChoice,
    directory: &Path,
    mcap: bool,
) -> Result<ExitCode, String> {
    not_a_campaigns(directory)?;
    let outcome = match fly(scenario, text, law, directory, mcap, &watch()?) {
        Ok(outcome) => outcome,
        Err(error) => return stopped(scenario, &error),
    };
    let holds = claims::all_hold(&outcome.claims);
    print_text(&format!(
        "{}: {} s flown, {}\n\n{}\n{}; log, figures and report in {}\n",
        scenario.name,
        scenario.timing.duration(),
        outcome.certification,
        claims::table(&outcome.claims),
        claims::verdict_line(&outcome.claims),
        directory.display()
    ))?;
    Ok(status(holds, None))
}

/// What a flight without a report ends with.
fn stopped(scenario: &Scenario, error: &FlyError) -> Result<ExitCode, String> {
    let signal = match error {
        FlyError::Flight(_) => None,
        FlyError::Interrupted(signal) => Some(*signal),
        _ => return Err(error.to_string()),
    };
    complain(format_args!("error: {}: {error}", scenario.name));
    Ok(status(false, signal))
}

fn run_reference(arguments: &ReferenceArguments) -> Result<ExitCode, String> {
    let (scenario, rate, path) = (load(arguments.file.as_deref())?, arguments.rate()?, &arguments.rows);
    let name = path.display();
    if arguments.file.as_ref().is_some_and(|file| same_file(path, file)) {
        return Err(format!("{name}: --rows must be another file than the scenario"));
    }
    let unwritable = |error: io::Error| format!("{name}: cannot be written: {error}");
    let mut file = WholeFile::create(path).map_err(unwritable)?;
    let rows = reference_rows::write(&scenario, rate, arguments.slower()?, &mut file).map_err(unwritable)?;
    file.finish().map_err(unwritable)?;
    let refusal = Verdict::judge(&scenario).map_err(|error| error.to_string())?.refusal();
    print_text(&format!("{}: {rows} rows in {name}\n", scenario.name))?;
    if let Some(refusal) = &refusal {
        complain(format_args!("{}: not certified for this reference: {refusal}", scenario.name));
    }
    Ok(status(refusal.is_none(), None))
}

fn run_replay(arguments: &ReplayArguments) -> Result<ExitCode, String> {
    let file = arguments.file.as_deref();
    let name = file.map_or_else(String::new, |file| file.display().to_string());
    let scenario = with_default_task(text_of(file)?, &name).map_err(|error| error.to_string())?.scenario;
    let stretch = arguments.stretch(scenario.timing.duration())?;
    let path = &arguments.gif;
    if arguments.file.as_ref().is_some_and(|file| same_file(path, file)) {
        return Err(format!("{}: --gif must be another file than the scenario", path.display()));
    }
    let unwritable = |error: io::Error| format!("{}: cannot be written: {error}", path.display());
    let mut file = WholeFile::alone(path).map_err(unwritable)?;
    let track = match watched(&scenario, &watch()?) {
        Ok(track) => track,
        Err(error) => return stopped(&scenario, &error),
    };
    let bytes = gif(&track, &[], stretch).map_err(|error| format!("{}: cannot be drawn: {error}", path.display()))?;
    file.write_all(&bytes).and_then(|()| file.finish()).map_err(unwritable)?;
    print_text(&format!(
        "{}: {} s to {} s at {} times life in {}\n",
        scenario.name,
        short(stretch.from),
        short(stretch.to),
        short(stretch.speed),
        path.display()
    ))?;
    Ok(status(true, None))
}

fn run_campaign(arguments: &CampaignArguments) -> Result<ExitCode, String> {
    let source = arguments.source()?;
    let scenario = source.scenario();
    let (orders, law) = (arguments.orders(scenario)?, arguments.law(scenario)?);
    let name = match &law {
        LawChoice::Ours => scenario.name.clone(),
        LawChoice::Rival(kind, _) => format!("{}-{}", scenario.name, kind.name()),
    };
    if let Some(number) = arguments.replay {
        let mut thrown = circumstances(scenario, &scenario.campaign.ranges, orders.seed, number);
        thrown.name = format!("{name}-{number}");
        permit(&thrown, &format!("{}: ", source.file()), "campaign.duration", arguments.large_log)?;
        let text = above(source.text(), &thrown, orders.seed, number);
        return fly_into(&thrown, &text, &law, &arguments.directory(&thrown.name), false);
    }
    let (directory, interrupt) = (arguments.directory(&name), watch()?);
    show_campaign(campaign::fly::campaign(&source, &law, &orders, &directory, &interrupt), &directory)
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
            complain(format_args!("error: {}: {}", directory.display(), CampaignError::Interrupted(signal)));
            Ok(status(false, Some(signal)))
        }
        Err(error) => Err(error.to_string()),
    }
}

/// Refuses a flight with a large log unless that is `allowed`; names the size and `duration`, the key that sets it.
fn permit(scenario: &Scenario, named: &str, duration: &str, allowed: bool) -> Result<(), String> {
    let rows = scenario.timing.ticks;
    let bytes = rows.saturating_mul(bytes_per_row(&scenario.reality));
    if bytes <= LARGE_LOG_BYTES {
        return Ok(());
    }
    let size = format!("{named}log.csv will take about {} GB, {rows} rows", short(bytes as f64 / 1e9));
    if !allowed {
        return Err(format!("{size}: take a shorter {duration}, a lower control.rate, or allow it with --large-log"));
    }
    complain(format_args!("{size}"));
    Ok(())
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
    let (interrupt, timeout) = (watch()?, arguments.timeout()?);
    if let Some(log) = &arguments.log {
        let alone = WholeFile::alone(log).map(drop);
        alone.map_err(|error| format!("--log {}: cannot be written: {error}", log.display()))?;
    }
    let mut port =
        SimulatorPort::open(&arguments.address()?, timeout, &interrupt).map_err(|error| error.to_string())?;
    let mut show = |line: &str| drop(print_text(&format!("{line}\n")));
    let clients = match ground {
        None => None,
        Some((line, ports)) => {
            let relay = Relay::open(line, &ports, timeout, &interrupt).map_err(|error| error.to_string())?;
            Some(Clients { relay, show: &mut show })
        }
    };
    match hil::serve(&scenario, &mut port, &session, arguments.log.as_deref(), clients) {
        Ok(summary) => {
            print_text(&format!("{}: {summary}\n", scenario.name))?;
            let signal = if let End::Interrupted(signal) = summary.end { Some(signal) } else { None };
            Ok(status(true, signal))
        }
        Err(error @ HilError::Flight(_)) => {
            complain(format_args!("error: {}: {error}", scenario.name));
            Ok(status(false, None))
        }
        Err(HilError::Scenario(what)) => Err(format!("{}: {what}", arguments.file.display())),
        Err(error) => Err(error.to_string()),
    }
}

fn run_sitl(arguments: &SitlArguments) -> Result<ExitCode, String> {
    let (text, name) = given_or_study(arguments.file.as_deref())?;
    let scenario = Scenario::parse(&text, &name).map_err(|error| error.to_string())?;
    let session = arguments.session(text, name)?;
    // A session goes on after the reader of its output has gone.
    let show = |line: &str| drop(print_text(&format!("{line}\n")));
    match sitl::run(&scenario, &session, &watch()?, |line| complain(line), show) {
        Ok(summary) => {
            print_text(&format!("{}: {summary}\n", scenario.name))?;
            Ok(status(true, summary.signal))
        }
        Err(error @ SitlError::Diverged(_)) => {
            complain(format_args!("error: {}: {error}", scenario.name));
            Ok(status(false, None))
        }
        Err(SitlError::Input(what)) => Err(what),
    }
}

fn run_first_flight(arguments: &FirstFlightArguments) -> Result<ExitCode, String> {
    let text = text_of(Some(&arguments.file))?;
    let scenario = Scenario::parse(&text, &arguments.file.display().to_string()).map_err(|error| error.to_string())?;
    board::fits(&scenario, &arguments.file.display().to_string())?;
    let (subject, mut person, page) = (arguments.subject(&text)?, arguments.person()?, arguments.page());
    let (mut record, why) = Record::open(&arguments.record(), subject)?;
    why.iter().for_each(complain);
    WholeFile::try_name(&page).map_err(|error| format!("--page {}: cannot be written: {error}", page.display()))?;
    let vehicle = Vehicle::new(Line::open(arguments.link.clone())?, watch()?, arguments.slower);
    let mut walk = Walk::new(vehicle, person.as_mut(), &scenario, arguments.board());
    let made = course::make(&mut walk, &mut record, arguments.only.as_deref());
    let text = first_flight::page::page(&record, &CHECKS, &scenario.name, &first_flight::page::now());
    first_flight::record::write(&page, &text)?;
    print_text(&format!("{}\n", page.display()))?;
    match made {
        Ok(holds) => Ok(status(holds, None)),
        Err(Stop::Interrupted(signal)) => Ok(status(false, Some(signal))),
        Err(Stop::Unwritable(what)) => Err(what),
        Err(Stop::Left) => {
            complain("broken off: the next walk goes on here");
            Ok(status(false, None))
        }
        Err(Stop::Silent(what)) => {
            complain(format_args!("{}: no answer to {what}", arguments.link));
            Ok(status(false, None))
        }
    }
}

fn run_man(ManArguments { out }: &ManArguments) -> Result<ExitCode, String> {
    let pages =
        manual(out, Arguments::command()).map_err(|error| format!("{}: cannot be written: {error}", out.display()))?;
    print_text(&format!(
        "{pages} pages in {}; man -l {} shows one\n",
        out.display(),
        out.join("host-sim.1").display()
    ))?;
    Ok(ExitCode::SUCCESS)
}

fn run_certify(CertifyArguments { file, show, rigorous, .. }: &CertifyArguments) -> Result<ExitCode, String> {
    let scenario = load(file.as_deref())?;
    let (mut text, mut certified) = certify(&scenario).map_err(|error| error.to_string())?;
    if *rigorous {
        let rigorous = Rigorous::new(&scenario.configuration).map_err(|error| error.to_string())?;
        text += &format!("\n{}", rigorous.report());
        certified &= rigorous.holds();
        if let Some((sentence, holds)) = rigorous::along(&scenario) {
            text += &sentence;
            certified &= holds;
        }
    }
    let may_fly = may_fly::lines(&scenario);
    text += &format!("\n{may_fly}");
    if *show {
        // Sections to paste are never folded.
        let constants = constants::constants(&scenario);
        let may_fly: String = may_fly.lines().map(|line| format!("# {line}\n")).collect();
        print(|| io::stdout().write_all(format!("{constants}\n{may_fly}").as_bytes()))?;
    } else {
        print_text(&text)?;
    }
    Ok(status(certified, None))
}

fn run_recovery(arguments: &CertifyArguments) -> Result<ExitCode, String> {
    let scenario = load(arguments.file.as_deref())?;
    let (sets, orders, interrupt) = (arguments.sets()?, arguments.orders()?, watch()?);
    match recovery(&scenario, &sets, &orders, &interrupt) {
        Ok(report) => {
            print_text(&report.to_string())?;
            complain(format_args!("error: {}", report.reason()));
            Ok(status(false, None))
        }
        Err(refused) => {
            let name = arguments.file.as_ref().map_or(scenario.name, |file| file.display().to_string());
            complain(format_args!("error: {name}: {refused}"));
            let signal = if let Refused::Interrupted(signal) = refused { Some(signal) } else { None };
            Ok(status(false, signal))
        }
    }
}
