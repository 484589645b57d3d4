//! The `fly` command: a whole flight, its log, its figures, its report.

pub mod default_task;

use crate::flight::claims::{self, Claim};
use crate::flight::extremes::FlightExtremes;
use crate::flight::law_on_vehicle::LawOnVehicle;
use crate::flight::{Flight, FlightError, Tick};
use crate::output::directory_lock::DirectoryLock;
use crate::output::interrupt::Interrupt;
use crate::output::progress::Progress;
use crate::output::whole_file::WholeFile;
use crate::reports::log;
use crate::reports::recording::{Recording, flight};
use crate::reports::report::flight as report_page;
use crate::reports::report::recorder::ReportRecorder as PageRecorder;
use crate::reports::report::track::Track;
use crate::rivals::choice::LawChoice;
use controller_core::error::ParameterError;
use scenario::Scenario;
use scenario::remarks::remarks;
use scenario::verdict::Verdict;
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Ticks between two looks at the clock.
const PROGRESS_PERIOD_TICKS: u64 = 5000;
const RECORDING_FILE: &str = "flight.mcap";

/// Whether they can be written is checked before the flight.
const WRITTEN_AFTER_FLIGHT: [&str; 6] =
    ["fig1.svg", "fig2.svg", "first-seconds.svg", "flight.svg", "report.md", "report.html"];

/// Why a flight left no report.
#[derive(Debug)]
pub enum FlyError {
    /// The flight could not go on.
    Flight(FlightError),
    /// A file or directory could not be written.
    Output(PathBuf, io::Error),
    /// The law refused the scenario.
    Parameter(ParameterError),
    /// The law of this name is undefined for its gains.
    Undefined(&'static str),
    /// Interrupted by this signal.
    Interrupted(u8),
}

impl fmt::Display for FlyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flight(error) => write!(f, "{error}"),
            Self::Output(path, error) => write!(f, "{}: cannot be written: {error}", path.display()),
            Self::Parameter(error) => write!(f, "{error}"),
            Self::Undefined(law) => write!(f, "the law {law} is undefined for its gains"),
            Self::Interrupted(signal) => write!(f, "interrupted by signal {signal}; nothing is written"),
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

/// The outcome of a flight.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Whether its configuration may fly for real, in a sentence.
    pub certification: String,
    /// The claims, with their verdicts.
    pub claims: Vec<Claim>,
}

/// Flies `scenario`, which was read from `text`, under `law`, and writes log.csv, report.html, four figures and
/// report.md into `directory`; and flight.mcap if `mcap`; otherwise an older flight's is removed.
///
/// The files get their names only after the whole flight succeeded and all of them are on the disk; until then nothing
/// of an older flight in the same directory is touched.
///
/// # Errors
/// [`FlyError`]; then no file is left behind.
pub fn fly(
    scenario: &Scenario,
    text: &str,
    law: &LawChoice,
    directory: &Path,
    mcap: bool,
    interrupt: &Interrupt,
) -> Result<Outcome, FlyError> {
    let verdict = Verdict::judge(scenario)?;
    let law_on_vehicle =
        LawOnVehicle::new(law, scenario, verdict.certified()).ok_or(FlyError::Undefined(law.name()))?;
    let mut flight = law_on_vehicle.flight(scenario)?;
    let _lock = DirectoryLock::take(directory).map_err(failed(directory))?;
    for path in WRITTEN_AFTER_FLIGHT.map(|name| directory.join(name)) {
        WholeFile::try_name(&path).map_err(failed(&path))?;
    }
    let mut log = Output::create(directory, "log.csv")?;
    let mut recording = mcap.then(|| Recorder::create(directory, scenario, text)).transpose()?;
    let (flown, page) = log_flight(scenario, &mut flight, &mut log, recording.as_mut(), interrupt)?;

    let outcome = match law {
        LawChoice::Ours => Outcome {
            certification: certification(scenario, &verdict),
            claims: claims::claims(scenario, &verdict, &flown),
        },
        LawChoice::Rival(..) => Outcome {
            certification: format!(
                "under the law {}, of which nothing is proven; the bounds are those of ours",
                law.name()
            ),
            claims: claims::of_rival(scenario, &verdict, &flown),
        },
    };
    let Outcome { certification, claims } = &outcome;
    let over = report_page::Flight { scenario, text, law, verdict: &verdict, certification, claims, flown: &flown };
    let (page, figures) = report_page::page(&over, page);
    let texts = [("report.md", report(scenario, &outcome)), ("report.html", page.html())];
    let mut outputs = vec![log];
    outputs.extend(recording.map(Recorder::finish).transpose()?);
    for (name, text) in figures.into_iter().chain(texts) {
        let mut output = Output::create(directory, name)?;
        output.write(|file| file.write_all(text.as_bytes()))?;
        outputs.push(output);
    }
    for output in &mut outputs {
        output.write(WholeFile::store)?;
    }
    interrupted(interrupt)?;
    outputs.into_iter().try_for_each(|Output { file, path }| file.finish().map_err(failed(&path)))?;
    if !mcap {
        forget(&directory.join(RECORDING_FILE))?;
    }
    Ok(outcome)
}

/// Removes what another flight left, if that is a file.
fn forget(path: &Path) -> Result<(), FlyError> {
    let is_file = std::fs::symlink_metadata(path).is_ok_and(|found| found.is_file());
    if is_file { std::fs::remove_file(path).map_err(failed(path)) } else { Ok(()) }
}

/// Flies all ticks and logs them.
fn log_flight(
    scenario: &Scenario,
    flight: &mut Flight,
    log: &mut Output,
    mut recording: Option<&mut Recorder>,
    interrupt: &Interrupt,
) -> Result<(FlightExtremes, PageRecorder), FlyError> {
    let ticks = scenario.timing.ticks;
    let rotors = scenario.configuration.rotors().map_or(0, |rotors| rotors.len());
    let estimates = scenario.configuration.paper().is_none();
    let (mut flown, mut page) = (FlightExtremes::new(scenario), report_page::recorder(scenario));
    let mut progress = Progress::new("flying", ticks);
    let reality = log::reality_header(&scenario.reality);
    log.write(|file| writeln!(file, "{}{reality}", log::header(rotors, estimates)))?;
    for done in 0..ticks {
        interrupted(interrupt)?;
        let tick = flight.tick()?;
        log.write(|file| log::write_row(file, &tick))?;
        if let Some(recording) = &mut recording {
            recording.take(&tick)?;
        }
        flown.observe(&tick);
        page.observe(&tick);
        if done % PROGRESS_PERIOD_TICKS == 0 {
            progress.show(done);
        }
    }
    Ok((flown, page))
}

/// What the report would keep of the flight of `scenario` under our law; nothing is written.
///
/// # Errors
/// [`FlyError::Flight`], [`FlyError::Interrupted`].
pub fn watched(scenario: &Scenario, interrupt: &Interrupt) -> Result<Track, FlyError> {
    let (mut flight, mut page) = (Flight::new(scenario)?, report_page::recorder(scenario));
    let mut progress = Progress::new("flying", scenario.timing.ticks);
    for done in 0..scenario.timing.ticks {
        interrupted(interrupt)?;
        page.observe(&flight.tick()?);
        if done % PROGRESS_PERIOD_TICKS == 0 {
            progress.show(done);
        }
    }
    Ok(page.finish(&scenario.name))
}

fn interrupted(interrupt: &Interrupt) -> Result<(), FlyError> {
    interrupt.signal().map_or(Ok(()), |signal| Err(FlyError::Interrupted(signal)))
}

/// One file of a flight, and what its errors call it.
struct Output {
    file: WholeFile,
    path: PathBuf,
}

impl Output {
    fn create(directory: &Path, name: &str) -> Result<Self, FlyError> {
        let path = directory.join(name);
        Ok(Self { file: WholeFile::create(&path).map_err(failed(&path))?, path })
    }

    fn write(&mut self, write: impl FnOnce(&mut WholeFile) -> io::Result<()>) -> Result<(), FlyError> {
        write(&mut self.file).map_err(failed(&self.path))
    }
}

/// flight.mcap, while it is written.
struct Recorder {
    recording: Recording<WholeFile>,
    path: PathBuf,
}

impl Recorder {
    fn create(directory: &Path, scenario: &Scenario, text: &str) -> Result<Self, FlyError> {
        let Output { file, path } = Output::create(directory, RECORDING_FILE)?;
        let recording = Recording::begin(file, scenario, text, flight::FLIGHT_TOPICS).map_err(failed(&path))?;
        Ok(Self { recording, path })
    }

    fn take(&mut self, tick: &Tick) -> Result<(), FlyError> {
        self.recording.take(tick).map_err(failed(&self.path))
    }

    fn finish(self) -> Result<Output, FlyError> {
        let file = self.recording.finish().map_err(failed(&self.path))?;
        Ok(Output { file, path: self.path })
    }
}

fn failed(path: &Path) -> impl FnOnce(io::Error) -> FlyError {
    |error| FlyError::Output(path.to_owned(), error)
}

/// Whether the configuration is one that may fly for real, in a sentence.
fn certification(scenario: &Scenario, verdict: &Verdict) -> String {
    let remarks = remarks(scenario, verdict.certificate().holds());
    let remarks: String = remarks.iter().map(|remark| format!("; {remark}")).collect();
    let sentence = match verdict.refusal() {
        None => "certified".to_owned(),
        Some(refusal) => {
            format!("not certified: {refusal}; what was flown here proves nothing about other flights")
        }
    };
    sentence + &remarks
}

fn report(scenario: &Scenario, outcome: &Outcome) -> String {
    let timing = &scenario.timing;
    let beyond = match scenario.reality.sections().as_slice() {
        [] => String::new(),
        sections => {
            format!(" Flown beyond the model, with [{}], of which no certificate knows.", sections.join("], ["))
        }
    };
    let verdict = if claims::all_hold(&outcome.claims) { "Every claim holds." } else { "Not every claim holds." };
    format!(
        "# {}\n\n{verdict} {} s at {} Hz, plant step {} s; configuration {}.{beyond}\n\n{}\n\
         ![Position, yaw and their errors](fig1.svg)\n\n\
         ![Thrust, moments, filters and saturated feedback](fig2.svg)\n\n\
         ![The first seconds](first-seconds.svg)\n\n![The path](flight.svg)\n\nEvery control tick is a row of [log.csv](log.csv).\n",
        scenario.name,
        timing.duration(),
        1e6 / timing.period_us as f64,
        timing.step(),
        outcome.certification,
        claims::markdown(&outcome.claims),
    )
}
