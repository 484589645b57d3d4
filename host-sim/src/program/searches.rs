//! The two commands that search for gains: `tune` for our law, `compare` for others.

use crate::arguments::{CompareArguments, GainsWanted, TuneArguments};
use crate::terminal::{complain, not_a_campaigns, print_text, same_file, status, text_of, watch};
use host_sim::commands::certify::summary;
use host_sim::output::progress::in_words;
use host_sim::output::table::{percent, short};
use host_sim::output::whole_file::WholeFile;
use host_sim::rivals::gains::Set;
use host_sim::rivals::rate;
use host_sim::studies::campaign::fly::grounded;
use host_sim::studies::compare::{self, CompareError, compare, compare_in_reality, compare_without_a_rotor};
use host_sim::studies::tune::effort::Effort;
use host_sim::studies::tune::{Tuned, output, rivals, tune, widest_bounds};
use scenario::{Scenario, check_name, constants};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// A comparison's name for gains that `--tune` found.
const TUNED_GAINS_FILE: &str = "rivals.toml";
/// Its name for gains that it searched because none are built in.
const SEARCHED_GAINS_FILE: &str = "gains.toml";

pub fn run_tune(arguments: &TuneArguments) -> Result<ExitCode, String> {
    let requirements = arguments.requirements()?;
    let original = text_of(Some(&arguments.file))?;
    let read = Scenario::parse(&original, &arguments.file.display().to_string());
    let mut scenario = read.map_err(|error| error.to_string())?;
    let (name, path, mut file) = destination(arguments, &scenario)?;
    scenario.name = name;
    let unwritable = |error| format!("{}: cannot be written: {error}", path.display());
    let effort = Effort { generations: arguments.generations, population: arguments.population, seed: arguments.seed };
    let interrupt = watch()?;
    let tuned = match tune(&scenario, requirements, effort, &interrupt) {
        Ok(tuned) => tuned,
        Err(closest) => {
            let what = closest.failed.clone().unwrap_or_default();
            let lost = short(closest.figures.height_lost);
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
    file.write_all(text.as_bytes()).and_then(|()| file.finish()).map_err(unwritable)?;
    let mut summary = found(&tuned, &path, interrupt.signal().is_some())?;
    if arguments.widen {
        let (factor, widest) =
            widest_bounds(&tuned.scenario.configuration, requirements.margin).map_err(|error| error.to_string())?;
        summary += &format!(
            "\nwith these gains every margin stays at least {} for references {} times as demanding:\n\n{}",
            percent(requirements.margin),
            short(factor),
            constants::written(widest.entries())
        );
    }
    print_text(&summary)?;
    Ok(status(true, interrupt.signal()))
}

pub fn run_compare(arguments: &CompareArguments) -> Result<ExitCode, String> {
    let wanted = arguments.gains()?;
    let text = text_of(Some(&arguments.file))?;
    let scenario = Scenario::parse(&text, &arguments.file.display().to_string()).map_err(|error| error.to_string())?;
    if let Some(problem) = grounded(&scenario) {
        return Err(format!("{}: {problem}", arguments.file.display()));
    }
    if arguments.rotor_loss && scenario.configuration.rotors().is_none() {
        let problem = "--rotor-loss needs [rotors]: there is no rotor that could fail; add that section";
        return Err(format!("{}: {problem}", arguments.file.display()));
    }
    let kinds = arguments.kinds();
    let theirs = match arguments.rate {
        Some(hz) => rate::at(&scenario, hz).map_err(|problem| format!("--rate: {problem}"))?,
        None => scenario.clone(),
    };
    let directory = arguments.directory(&scenario.name);
    not_a_campaigns(&directory)?;
    // The gains, or how hard to search for them and in which file to keep them.
    let known = match wanted {
        GainsWanted::Of(file) => Ok(Set::read(&theirs, Some(&file), &kinds).map_err(|error| error.to_string())?),
        GainsWanted::Searched(effort) => Err((effort, TUNED_GAINS_FILE)),
        GainsWanted::BuiltInOr(effort) => Set::built_in(&theirs, &kinds).ok_or((effort, SEARCHED_GAINS_FILE)),
    };
    none_but(arguments.gains.as_deref(), known.as_ref().err().map(|(_, name)| *name), &directory)?;
    let interrupt = watch()?;
    let failed = |error: CompareError| match error {
        CompareError::NotCertified(_) | CompareError::Interrupted(_) => {
            complain(format_args!("error: {}: {error}", scenario.name));
            Ok(status(false, interrupt.signal()))
        }
        error => Err(error.to_string()),
    };
    // A search takes minutes: whatever is wrong with the rest shows now.
    let reserved = compare::certified(&scenario).and_then(|_| compare::reserve(&directory));
    let _lock = match reserved {
        Ok(lock) => lock,
        Err(error) => return failed(error),
    };
    let (set, found) = match known {
        Ok(set) => (set, None),
        Err((effort, name)) => {
            if name == SEARCHED_GAINS_FILE {
                complain(format_args!(
                    "{}: no gains of the other laws are built in for this vehicle: they are searched first, each as \
                     hard as `tune` searches ours, which may take {}",
                    scenario.name,
                    in_words(rivals::expected(&theirs, &kinds, &effort).as_secs_f64())
                ));
            }
            match rivals::tune(&theirs, &kinds, effort, &interrupt) {
                Ok(set) => {
                    let written = set.written(&theirs, &arguments.command(&effort));
                    (set, Some((name, written)))
                }
                Err(message) => {
                    complain(format_args!("error: {}: {message}", scenario.name));
                    return Ok(status(false, interrupt.signal()));
                }
            }
        }
    };
    let files = (&scenario, &theirs);
    let compared = if arguments.realism {
        compare_in_reality(files, &set, &interrupt)
    } else if arguments.rotor_loss {
        compare_without_a_rotor(files, &set, &interrupt)
    } else {
        compare(files, &text, &set, arguments.flights, &interrupt)
    };
    let mut comparison = match compared {
        Ok(comparison) => comparison,
        Err(error) => return failed(error),
    };
    let kept = found.as_ref().map_or_else(String::new, |(name, _)| {
        let file = directory.join(name);
        format!("gains found in {0}: --gains {0} takes them the next time\n", file.display())
    });
    comparison.files.extend(found);
    compare::write(&comparison, &directory).map_err(|error| error.to_string())?;
    let hz = |rate: f64| format!(" at {} Hz", short(rate));
    let (flown, verdict, written) = if arguments.realism {
        ("the vehicle is not as the file says".to_owned(), ["ours is never lost", "ours is LOST"], "table")
    } else if arguments.rotor_loss {
        let verdict = ["ours always lands softly", "ours does NOT always land softly"];
        ("rotor 1 fails, and keeps so much of its thrust".to_owned(), verdict, "table")
    } else {
        let all = "every random flight of ours settles, unclipped, within its bounds";
        let not_all = "NOT every random flight of ours settles, unclipped, within its bounds";
        (format!("{} random flights of each", arguments.flights), [all, not_all], "table, pictures, report")
    };
    print_text(&format!(
        "{}: our law and {} others{}; {flown}\n\n{}\n{}{}* another law does better; {}; {written} in {}\n{kept}",
        scenario.name,
        set.rivals.len(),
        arguments.rate.map_or_else(String::new, hz),
        comparison.text,
        set.of_other_rates(1.0 / theirs.timing.period()).map_or_else(String::new, |others| others + "\n"),
        set.left_out().map_or_else(String::new, |left_out| left_out + "\n"),
        verdict[usize::from(!comparison.holds)],
        directory.display()
    ))?;
    Ok(status(comparison.holds, None))
}

/// Refuses a directory with other gains than those that will fly (from `gains`, or written as `written`): a reader
/// would take them for the flown ones. They are not removed, because a search for them takes long.
fn none_but(gains: Option<&Path>, written: Option<&str>, directory: &Path) -> Result<(), String> {
    for name in [TUNED_GAINS_FILE, SEARCHED_GAINS_FILE] {
        let there = directory.join(name);
        let flies = written == Some(name) || gains.is_some_and(|gains| same_file(gains, &there));
        if there.exists() && !flies {
            let there = there.display();
            return Err(format!(
                "{there}: holds other gains than are to fly: take them with --gains {there}, or choose another --out"
            ));
        }
    }
    Ok(())
}

/// The name of a tuned scenario and the file it goes to, begun: whatever is wrong with them shows now, not after the
/// search.
fn destination(arguments: &TuneArguments, scenario: &Scenario) -> Result<(String, PathBuf, WholeFile), String> {
    let stem = arguments.out.as_deref().and_then(Path::file_stem);
    let name = stem.map_or_else(|| format!("{}-tuned", scenario.name), |stem| stem.to_string_lossy().into_owned());
    check_name(&name).map_err(|error| format!("--out: becomes the scenario's name: {error}"))?;
    let path = arguments.out.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.toml")));
    if same_file(&path, &arguments.file) {
        return Err(format!("{}: --out must be another file than the one tuned", path.display()));
    }
    let file = WholeFile::alone(&path).map_err(|error| format!("{}: cannot be written: {error}", path.display()))?;
    Ok((name, path, file))
}

/// A search's line about the constants it found.
fn found(tuned: &Tuned, path: &Path, interrupted: bool) -> Result<String, String> {
    let summary = summary(&tuned.scenario).map_err(|error| error.to_string())?;
    let before = match &tuned.before.failed {
        Some(what) => format!("the file's own constants do not meet the requirements: {what}\n"),
        None if !tuned.improved() => {
            "nothing better found: these are the constants that the search started from\n".to_owned()
        }
        None => String::new(),
    };
    Ok(format!(
        "{summary}\n{}{before}{}{} candidates judged; written to {}\n",
        tuned.table(),
        if interrupted { "interrupted: the best so far; " } else { "" },
        tuned.judged,
        path.display()
    ))
}
