//! The `fly` command: a whole flight, its log, its figures, its report.

use crate::claims::{self, Claim};
use crate::flight::{Flight, FlightError};
use crate::flown::Flown;
use crate::log::{self, WholeFile};
use crate::plots;
use crate::plots::canvas::PlotError;
use crate::plots::record::Record;
use crate::progress::Progress;
use controller_core::certificate::configuration::Certified;
use controller_core::error::ParameterError;
use scenario::Scenario;
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Ticks between two looks at the clock.
const TICKS_PER_SHOW: u64 = 5000;

/// Why a flight left no report.
#[derive(Debug)]
pub enum FlyError {
    /// The flight could not go on.
    Flight(FlightError),
    /// A file or directory could not be written.
    Output(PathBuf, io::Error),
    /// The law refused the scenario.
    Parameter(ParameterError),
    /// A figure could not be drawn.
    Plot(PlotError),
}

impl fmt::Display for FlyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flight(error) => write!(f, "{error}"),
            Self::Output(path, error) => write!(f, "{}: cannot be written: {error}", path.display()),
            Self::Parameter(error) => write!(f, "{error}"),
            Self::Plot(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for FlyError {}

impl From<FlightError> for FlyError {
    fn from(error: FlightError) -> Self {
        Self::Flight(error)
    }
}

impl From<ParameterError> for FlyError {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}

impl From<PlotError> for FlyError {
    fn from(error: PlotError) -> Self {
        Self::Plot(error)
    }
}

/// Flies `scenario` and writes log.csv, four figures and report.md into `directory`.
///
/// The files get their names only after the whole flight and all drawings succeeded; until then nothing of an older flight
/// in the same directory is touched.
///
/// # Errors
/// [`FlyError`]; then no file is left behind.
pub fn fly(scenario: &Scenario, directory: &Path) -> Result<Vec<Claim>, FlyError> {
    let mut flight = Flight::new(scenario)?;
    let ticks = scenario.timing.ticks;
    let mut flown = Flown::new(scenario);
    let mut record = Record::new(ticks);
    let mut progress = Progress::new("flying", ticks);

    let log_path = directory.join("log.csv");
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |error| FlyError::Output(path, error)
    };
    std::fs::create_dir_all(directory).map_err(failed(directory))?;
    let mut log = WholeFile::create(&log_path).map_err(failed(&log_path))?;
    writeln!(log, "{}", log::HEADER).map_err(failed(&log_path))?;
    for done in 0..ticks {
        let tick = flight.tick()?;
        log::write_row(&mut log, &tick).map_err(failed(&log_path))?;
        flown.observe(&tick);
        record.observe(&tick);
        if done % TICKS_PER_SHOW == 0 {
            progress.show(done);
        }
    }
    drop(progress);

    let claims = claims::claims(scenario, &flown);
    let samples = record.samples();
    let texts = [
        ("fig1.svg", plots::figure_1(scenario, &samples)?),
        ("fig2.svg", plots::figure_2(scenario, &samples)?),
        ("first-seconds.svg", plots::first_seconds(scenario, &samples)?),
        ("flight.svg", plots::path::picture(&samples)?),
        ("report.md", report(scenario, &claims)),
    ];
    log.finish().map_err(failed(&log_path))?;
    for (name, text) in texts {
        let path = directory.join(name);
        WholeFile::write(&path, &text).map_err(failed(&path))?;
    }
    Ok(claims)
}

/// Whether the configuration is one that may fly for real, in a sentence.
#[must_use]
pub fn certification(scenario: &Scenario) -> &'static str {
    match Certified::new(scenario.configuration.clone()) {
        Ok(_) => "certified: its limits are proven for every reference within this one's bounds",
        Err(_) => "not certified: what was flown here proves nothing about other flights",
    }
}

fn report(scenario: &Scenario, claims: &[Claim]) -> String {
    let timing = &scenario.timing;
    let verdict = if claims::all_hold(claims) { "Every claim holds." } else { "Not every claim holds." };
    format!(
        "# {}\n\n{verdict} {} s at {} Hz, plant step {} s; configuration {}.\n\n{}\n\
         ![Position, yaw and their errors](fig1.svg)\n\n\
         ![Thrust, moments, filters and saturated feedback](fig2.svg)\n\n\
         ![The first seconds](first-seconds.svg)\n\n![The path](flight.svg)\n\nEvery control tick is a row of [log.csv](log.csv).\n",
        scenario.name,
        timing.duration(),
        1e6 / timing.period_us as f64,
        timing.step(),
        certification(scenario),
        claims::markdown(claims),
    )
}
