//! The `identify` command: files in, a report and a scenario out.

use super::bench::{self, Bench};
use super::flight_log::{FlightLog, Source};
use super::output::{Values, rewritten};
use super::quantities::{Quantities, Quantity};
use super::{foreign, identify, margins, observability, ulog};
use crate::identification::ulog::MAGIC;
use crate::identification::ulog::command::LOG_MAX_BYTES;
use crate::output::table::{aligned, short};
use crate::output::whole_file::WholeFile;
use controller_core::allocation::Rotors;
use scenario::Scenario;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The arguments of one identification.
#[derive(Debug, Clone)]
pub struct Task {
    /// log.csv, or a ULog of the firmware or of PX4.
    pub log: PathBuf,
    /// The scenario's text, and how errors call it.
    pub original: String,
    /// See [`Self::original`].
    pub file: String,
    /// Bench data.
    pub bench: Option<PathBuf>,
    /// The scenario to write.
    pub out: Option<PathBuf>,
}

/// Why nothing was identified.
#[derive(Debug)]
pub enum Refused {
    /// A file cannot be used or written.
    Input(String),
    /// The log is in order, but does not identify the vehicle.
    NotIdentifiable(String),
}

/// Identifies, writes `task.out` if there is one, and returns the report.
///
/// # Errors
/// [`Refused`]; then nothing is written.
pub fn run(task: &Task) -> Result<String, Refused> {
    let scenario = Scenario::parse(&task.original, &task.file).map_err(|error| Refused::Input(error.to_string()))?;
    let of_file = |what: String| Refused::Input(format!("{}: {what}", task.file));
    let rotors = scenario.configuration.rotors();
    let rotors =
        rotors.ok_or_else(|| of_file("rotors: is missing; identify needs a model of the rotors".to_owned()))?;
    let gravity = f64::from(scenario.configuration.vehicle().gravity);
    let out = task.out.as_deref().map(|path| destination(path, &scenario.name)).transpose()?;
    let bench = match &task.bench {
        None => Bench::default(),
        Some(path) => bench::read(&text(path)?, rotors, gravity).map_err(|what| in_file(path, &what))?,
    };
    let log = read(&task.log, rotors, bench.curve)?;
    let cannot = |lines: Vec<String>| {
        Refused::NotIdentifiable(format!("{}: not identifiable\n  {}", task.log.display(), lines.join("\n  ")))
    };
    let missing = observability::unexcited(&log);
    if !missing.is_empty() {
        return Err(cannot(missing));
    }
    let identified = identify(&log, &scenario, &bench).map_err(|what| cannot(vec![format!("the log {what}")]))?;
    let unknown = observability::unobservable(&identified);
    if !unknown.is_empty() {
        let known = observability::known(&identified);
        let known = (!known.is_empty()).then(|| format!("known all the same: {}", known.join("; ")));
        return Err(cannot(unknown.into_iter().chain(known).collect()));
    }
    let mut report = head(&scenario, &log);
    report += &table(&identified, &scenario);
    report += &remarks(&identified, &bench);
    let (eaten, all) = margins::report(&task.original, &task.file, &identified)
        .map_err(|what| cannot(vec![format!("the vehicle found cannot fly: {what}")]))?;
    report += &format!("\nwhat the uncertainty eats of the margins\n{eaten}");
    report += if all {
        "every margin is left in the worst corner of the intervals\n"
    } else {
        "NOT every margin is left: measure better what is widest, or tune again with the file written\n"
    };
    if let Some((name, path, mut file)) = out {
        let text = rewritten(&task.original, &name, &Values::estimates(&identified), scenario.timing.step())
            .map_err(of_file)?;
        let written = file.write_all(text.as_bytes()).and_then(|()| file.finish());
        written.map_err(|error| in_file(path, &format!("cannot be written: {error}")))?;
        report += &format!("written to {}\n", path.display());
    }
    Ok(report)
}

/// The name of the scenario found, and the file it goes to, begun: a problem with them shows now, not after the
/// fit.
fn destination<'a>(path: &'a Path, usual: &str) -> Result<(String, &'a Path, WholeFile), Refused> {
    let name = path.file_stem().map_or_else(|| usual.to_owned(), |stem| stem.to_string_lossy().into_owned());
    scenario::check_name(&name)
        .map_err(|what| Refused::Input(format!("--out: becomes the scenario's name: {what}")))?;
    let file = WholeFile::alone(path).map_err(|error| in_file(path, &format!("cannot be written: {error}")))?;
    Ok((name, path, file))
}

/// A log of either kind; a ULog is known by its first bytes.
fn read(path: &Path, rotors: &Rotors, curve: Option<f64>) -> Result<FlightLog, Refused> {
    let bytes = scenario::text::bytes(path, LOG_MAX_BYTES)
        .map_err(|error| in_file(path, &format!("cannot be read: {error}")))?;
    let log = if bytes.starts_with(&MAGIC) {
        ulog::read(&bytes, rotors, curve)
    } else if let Some(what) = foreign::recognised(&bytes) {
        Err(what)
    } else {
        match String::from_utf8(bytes) {
            Ok(text) => FlightLog::from_csv(&text),
            Err(_) => Err(format!("neither a log.csv nor a ULog: {}", foreign::READABLE_LOGS)),
        }
    };
    log.map_err(|what| in_file(path, &what))
}

fn text(path: &Path) -> Result<String, Refused> {
    scenario::text::read(path).map_err(|error| in_file(path, &format!("cannot be read: {error}")))
}

fn in_file(path: &Path, what: &str) -> Refused {
    Refused::Input(format!("{}: {what}", path.display()))
}

fn head(scenario: &Scenario, log: &FlightLog) -> String {
    let source = match log.source {
        Source::Estimator => "the estimator's",
        Source::Sensors => "the sensors'",
        Source::Truth => "the TRUE state, which no real vehicle knows",
        Source::Px4 => {
            "PX4's; supposed: a full motor output is a rotor's greatest thrust, and thrust goes with its square or as \
             the bench's thrust stand has it"
        }
    };
    let (seconds, damage) = (short(log.seconds()), &log.damage);
    format!("{}: {seconds} s flown without a gap, state: {source}{damage}\n\n", scenario.name)
}

fn table(identified: &Quantities, scenario: &Scenario) -> String {
    let vehicle = scenario.configuration.vehicle();
    let inertia = vehicle.inertia.map(f64::from);
    let drag = scenario.reality.drag.map_or([f64::NAN; 3], |drag| drag.linear.into());
    let delay = scenario.delay();
    let rows = [
        ("thrust scale / mass", "1/kg", identified.scale_over_mass, 1.0 / f64::from(vehicle.mass)),
        ("inertia x / thrust scale", "kg m^2", identified.inertia_over_scale[0], inertia.x),
        ("inertia y / thrust scale", "kg m^2", identified.inertia_over_scale[1], inertia.y),
        ("inertia z / thrust scale", "kg m^2", identified.inertia_over_scale[2], inertia.z),
        ("mass", "kg", identified.mass, f64::from(vehicle.mass)),
        ("thrust scale", "", identified.thrust_scale, 1.0),
        ("inertia x", "kg m^2", identified.inertia[0], inertia.x),
        ("inertia y", "kg m^2", identified.inertia[1], inertia.y),
        ("inertia z", "kg m^2", identified.inertia[2], inertia.z),
        ("lag and delay together", "s", identified.whole_delay, scenario.rotor_lag + delay),
        ("rotor lag", "s", identified.lag, scenario.rotor_lag),
        ("delay", "s", identified.delay, delay),
        ("centre of mass x", "m", identified.centre_of_mass[0], 0.0),
        ("centre of mass y", "m", identified.centre_of_mass[1], 0.0),
        ("linear drag x", "kg/s", identified.drag[0], drag[0]),
        ("linear drag y", "kg/s", identified.drag[1], drag[1]),
        ("linear drag z", "kg/s", identified.drag[2], drag[2]),
    ];
    let head = ["", "identified", "uncertainty", "interval", "", "file", ""].map(str::to_owned).to_vec();
    let row = |(name, unit, quantity, file): (&str, &str, Quantity, f64)| {
        let [least, greatest] = quantity.interval.map(short);
        let file = if file.is_nan() { "-".to_owned() } else { short(file) };
        let numbers = [short(quantity.value), short(quantity.uncertainty), least, greatest, file];
        [&[name.to_owned()][..], &numbers, &[unit.to_owned()]].concat()
    };
    aligned(&std::iter::once(head).chain(rows.map(row)).collect::<Vec<_>>())
}

fn remarks(identified: &Quantities, bench: &Bench) -> String {
    let mut text = format!(
        "uncertainty: standard. interval: {} of them to either side, for all true values together (docs/identify.md says how often that held)\n\
         the centre of mass is from the file's; other steady torques count as part of it\n",
        identified.coverage
    );
    if !identified.mass_is_measured {
        text += "the mass was TAKEN FROM THE FILE: only thrust scale over mass and inertia over thrust scale are \
                 observable in flight; weigh it (--bench)\n";
    }
    if let Some(curve) = bench.curve {
        text += &format!("thrust curve a = {}: write it as rotors.thrust_curve\n", short(curve));
    }
    text
}
