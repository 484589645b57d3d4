//! The two commands that search for gains: `tune` for our law, `compare` for others.

use crate::arguments::{CompareArguments, TuneArguments};
use crate::terminal::{complain, not_a_campaigns, print_text, same_file, status, text_of, watch};
use host_sim::campaign::fly::grounded;
use host_sim::certify::certify;
use host_sim::compare::{self, CompareError, compare};
use host_sim::rivals::gains::Set;
use host_sim::rivals::tuning;
use host_sim::table::{percent, short};
use host_sim::tune::effort::Effort;
use host_sim::tune::{Tuned, output, tune, widest_bounds};
use host_sim::whole_file::WholeFile;
use scenario::{Scenario, bounds, check_name};
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// What a comparison calls the gains that it found.
const RIVALS: &str = "rivals.toml";

pub fn run_tune(arguments: &TuneArguments) -> Result<ExitCode, String> {
    let requirements = arguments.requirements()?;
    let original = text_of(Some(&arguments.file))?;
    let read = Scenario::parse(&original, &arguments.file.display().to_string());
    let mut scenario = read.map_err(|error| error.to_string())?;
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
            complain(format_args!(
                "error: {}: {stopped}no gains meet the requirements, nothing is written; the closest fail in: {what} \
                 (height lost {lost} m)",
                scenario.name
            ));
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

pub fn run_compare(arguments: &CompareArguments) -> Result<ExitCode, String> {
    let effort = arguments.effort()?;
    let text = text_of(Some(&arguments.file))?;
    let scenario = Scenario::parse(&text, &arguments.file.display().to_string()).map_err(|error| error.to_string())?;
    if let Some(problem) = grounded(&scenario) {
        return Err(format!("{}: {problem}", arguments.file.display()));
    }
    let directory = arguments.directory(&scenario.name);
    not_a_campaigns(&directory)?;
    if effort.is_none() {
        none_but(arguments.gains.as_deref(), &directory)?;
    }
    let interrupt = watch()?;
    let mut found = None;
    let set = match (&effort, &arguments.gains) {
        (Some(effort), _) => match tuning::tune(&scenario, *effort, &interrupt) {
            Ok(set) => {
                found = Some((RIVALS, set.written(&scenario, &arguments.command(effort))));
                set
            }
            Err(message) => {
                complain(format_args!("error: {}: {message}", scenario.name));
                return Ok(status(false, interrupt.signal()));
            }
        },
        (None, file) => Set::read(&scenario, file.as_deref()).map_err(|error| error.to_string())?,
    };
    let mut comparison = match compare(&scenario, &text, &set, arguments.flights, &interrupt) {
        Ok(comparison) => comparison,
        Err(error @ (CompareError::NotCertified(_) | CompareError::Interrupted(_))) => {
            complain(format_args!("error: {}: {error}", scenario.name));
            return Ok(status(false, interrupt.signal()));
        }
        Err(error) => return Err(error.to_string()),
    };
    comparison.files.extend(found);
    compare::write(&comparison, &directory).map_err(|error| error.to_string())?;
    print_text(&format!(
        "{}: our law and {} others; {} random flights of each\n\n{}\n* another law does better; {}; table, pictures, report in {}\n",
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

/// Refuses a directory that holds other gains than those that are to fly: they would pass for those that flew. They are not removed,
/// because a search for them takes long.
fn none_but(gains: Option<&Path>, directory: &Path) -> Result<(), String> {
    let there = directory.join(RIVALS);
    if !there.exists() || gains.is_some_and(|gains| same_file(gains, &there)) {
        return Ok(());
    }
    let there = there.display();
    Err(format!("{there}: holds other gains than are to fly: take them with --gains {there}, or choose another --out"))
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
