//! `hil`: the vehicle for a flight controller that runs elsewhere, in an emulator or on a board, in lock-step.
//!
//! ```text
//! flight controller -- HIL_ACTUATOR_CONTROLS --> one control period of rotors, body and ground
//!                   <-- ODOMETRY, HIL_SENSOR --
//! ```
//!
//! The vehicle moves only when a command has come, by exactly one period, so however fast or slow the other side runs,
//! the flight is the same, to the last bit. Answers carry the times at which they are true: a command's, and how far
//! the vehicle has moved since. The last HIL_SENSOR of an answer is that of the period's end. The measurements are
//! [`senses`]'. Time is the other side's own: [`pace`] reports how regular its commands are by its clock. A session may
//! be held to a speed, for MAVLink clients in real time ([`relay`]).

pub mod pace;
pub mod port;
pub mod relay;
pub mod senses;
pub mod vehicle;

use crate::output::progress::Progress;
use crate::output::whole_file::WholeFile;
use crate::sessions::pace::Pace as Speed;
use pace::HilPace;
use port::{PortError, SimulatorPort};
use relay::Relay;
use scenario::Scenario;
use scenario::number::Number;
use senses::Senses;
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use vehicle::HilVehicle;

/// How a session is run.
#[derive(Debug, Clone, Default)]
pub struct HilSession {
    /// Vehicle time after which it ends, s; none: when the other side goes.
    pub duration: Option<f64>,
    /// Vehicle time from which poses are withheld, s.
    pub pose_until: Option<f64>,
    /// How many times as fast as the desk's the vehicle's time may pass; none: as fast as both sides go.
    pub speed: Option<f64>,
}

/// Why a session could not be run, or not to its end.
#[derive(Debug)]
pub enum HilError {
    /// The scenario cannot be flown this way.
    Scenario(String),
    /// The connection failed.
    Port(PortError),
    /// The other side sent something impossible, or the motion is no longer finite.
    Flight(String),
    /// The log cannot be written.
    Log(PathBuf, io::Error),
}

impl fmt::Display for HilError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scenario(what) | Self::Flight(what) => f.write_str(what),
            Self::Port(error) => write!(f, "{error}"),
            Self::Log(path, error) => write!(f, "--log {}: cannot be written: {error}", path.display()),
        }
    }
}

/// A session's summary.
#[derive(Debug, Clone)]
pub struct HilSummary {
    /// How regular the commands were.
    pub pace: HilPace,
    /// Where the vehicle ended, m.
    pub position: [f64; 3],
    /// Each touchdown: vehicle time, s, speed, m/s, and tilt, rad.
    pub touchdowns: Vec<(f64, f64, f64)>,
    /// How long it took from the first command on.
    pub took: Duration,
    /// Its end.
    pub end: End,
}

/// The end of a session.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// Its duration was over.
    Over,
    /// The other side went.
    Left,
    /// Interrupted by this signal.
    Interrupted(u8),
}

impl fmt::Display for HilSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.position;
        writeln!(f, "{}, in {:.1} s", self.pace, self.took.as_secs_f64())?;
        for (time, speed, tilt) in &self.touchdowns {
            writeln!(
                f,
                "touched the ground at {time:.2} s with {speed:.3} m/s, leaning {:.1} degrees",
                tilt.to_degrees()
            )?;
        }
        match self.end {
            End::Over => f.write_str("the duration was over")?,
            End::Left => f.write_str("the other side went")?,
            End::Interrupted(signal) => write!(f, "interrupted by signal {signal}")?,
        }
        write!(f, "; vehicle at {x:.4} {y:.4} {z:.4} m")
    }
}

/// Clients that are served meanwhile, and where their vehicle's status is shown.
pub struct Clients<'a> {
    /// Their line to the flight controller.
    pub relay: Relay,
    /// Takes lines to show: a status each second of the desk's time, and the vehicle's texts.
    pub show: &'a mut dyn FnMut(&str),
}

/// By the desk's clock.
const STATUS_PERIOD: Duration = Duration::from_secs(1);

/// Serves one flight controller with the scenario's vehicle until the duration is over, the other side goes, or
/// a signal comes.
///
/// # Errors
/// [`HilError`].
pub fn serve(
    scenario: &Scenario,
    port: &mut SimulatorPort,
    session: &HilSession,
    log: Option<&Path>,
    mut clients: Option<Clients<'_>>,
) -> Result<HilSummary, HilError> {
    let mut vehicle = HilVehicle::new(scenario).map_err(HilError::Scenario)?;
    let mut senses = Senses::new(scenario);
    let unwritable = |error| HilError::Log(log.unwrap_or(Path::new("")).to_owned(), error);
    let mut rows = log.map(Log::create).transpose().map_err(unwritable)?;
    let period = scenario.timing.period();
    let ticks = |seconds: f64| (seconds / period).round() as u64;
    let (end, pose_end) = (session.duration.map(ticks), session.pose_until.map(ticks));
    let mut progress = end.map(|end| Progress::new("flying", end));
    let mut pace = HilPace::new(scenario.timing.period_us);
    let mut touchdowns = Vec::new();
    let mut started = None;
    let mut speed = None;
    let mut shown = Instant::now();
    let end = loop {
        if end.is_some_and(|end| pace.ticks() >= end) {
            break End::Over;
        }
        let controls = match port.receive() {
            Ok(Some(controls)) => controls,
            Ok(None) => break End::Left,
            Err(PortError::Interrupted(signal)) => break End::Interrupted(signal),
            Err(error) => return Err(HilError::Port(error)),
        };
        started.get_or_insert_with(Instant::now);
        let tick = pace.ticks();
        let time = tick as f64 * period;
        pace.take(controls.time);
        let moved = vehicle
            .advance(&controls, senses.instants())
            .map_err(|what| HilError::Flight(format!("at {time} s: {what}")))?;
        if let Some(touchdown) = moved.touchdown {
            touchdowns.push((time, touchdown.speed, touchdown.tilt));
        }
        if let Some(rows) = &mut rows {
            rows.row(time, &moved.state, &controls, moved.thrust).map_err(unwritable)?;
        }
        let mut answer = senses.answer(controls.time, &moved);
        if pose_end.is_some_and(|end| tick >= end) {
            answer.poses.clear();
        }
        if let Some(factor) = session.speed {
            // The answer is of the period's end.
            speed.get_or_insert_with(|| Speed::new(factor)).wait(pace.ticks() * scenario.timing.period_us);
        }
        port.answer(&answer).map_err(HilError::Port)?;
        if let Some(Clients { relay, show }) = &mut clients {
            relay.texts().iter().for_each(|text| show(&format!("{time:9.2} s  \"{text}\"")));
            if shown.elapsed() >= STATUS_PERIOD {
                shown = Instant::now();
                let [x, y, z]: [f64; 3] = moved.state.position.into();
                show(&format!("{time:9.2} s  {:<11}  at {x:8.3} {y:8.3} {z:8.3} m", relay.state()));
            }
        }
        if let Some(progress) = &mut progress {
            progress.show(pace.ticks());
        }
    };
    if let Some(rows) = rows {
        rows.file.finish().map_err(unwritable)?;
    }
    let position = vehicle.state().position;
    let took = started.map_or(Duration::ZERO, |started: Instant| started.elapsed());
    Ok(HilSummary { pace, position: position.into(), touchdowns, took, end })
}

/// A row for each command: the state one period after it, the commands, the thrust at the end, the command's own time.
struct Log {
    file: WholeFile,
}

impl Log {
    const SESSION_HEADER: &'static str =
        "t,px,py,pz,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,thrust,armed,command_1,command_2,command_3,command_4,controller_us";

    fn create(path: &Path) -> io::Result<Self> {
        let mut file = WholeFile::alone(path)?;
        writeln!(file, "{}", Self::SESSION_HEADER)?;
        Ok(Self { file })
    }

    fn row(
        &mut self,
        time: f64,
        s: &scenario::body::BodyState,
        c: &crate::sessions::messages::Controls,
        thrust: f64,
    ) -> io::Result<()> {
        let (p, v, q, w) = (&s.position, &s.velocity, &s.attitude, &s.angular_velocity);
        write!(self.file, "{time:.6}")?;
        for value in [p.x, p.y, p.z, v.x, v.y, v.z, q.w, q.i, q.j, q.k, w.x, w.y, w.z, thrust] {
            write!(self.file, ",{}", Number(value))?;
        }
        write!(self.file, ",{}", u8::from(c.armed))?;
        for command in c.commands {
            write!(self.file, ",{}", Number(command))?;
        }
        writeln!(self.file, ",{}", c.time)
    }
}
