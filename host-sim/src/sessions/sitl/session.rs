//! The options of a `sitl` session, and its end.

use super::faults::Fault;
use super::simulated_hardware::PoseSource;
use crate::sessions::ports::Ports;
use firmware::link::signing::Key;
use flight::Mode;
use std::fmt;
use std::net::SocketAddr;
use std::path::PathBuf;

/// How a session is run.
#[derive(Debug, Clone)]
pub struct SitlSession {
    /// The scenario's name in errors: its file.
    pub file: String,
    /// Where the clients are.
    pub ports: Ports,
    /// Where clients find it that speak CRTP.
    pub crtp: Option<SocketAddr>,
    /// How many times as fast as the desk's the vehicle's time passes.
    pub speed: f64,
    /// Vehicle time after which it ends, s; none: at a signal.
    pub duration: Option<f64>,
    /// Where its poses come from.
    pub poses: PoseSource,
    /// Whether a person lays hands on it, told by standard input: see [`super::hands`].
    pub has_hands: bool,
    /// To be injected.
    pub faults: Vec<Fault>,
    /// Where parameters are kept.
    pub parameters: Option<PathBuf>,
    /// The key that signs frames.
    pub signing_key: Option<Key>,
    /// The port to which its true pose goes.
    pub truth: Option<u16>,
    /// Where it is recorded as MCAP, and the scenario file's text, which goes with it.
    pub recording: Option<(PathBuf, String)>,
    /// Where its raw gyro goes as ULog.
    pub gyro: Option<PathBuf>,
}

/// Why a session could not be run, or not to its end.
#[derive(Debug)]
pub enum SitlError {
    /// The scenario, a file or a port cannot be used, or a file not be written: why, in a line.
    Input(String),
    /// The vehicle's motion is not finite any more, at this time, s.
    Diverged(f64),
}

impl fmt::Display for SitlError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(what) => f.write_str(what),
            Self::Diverged(time) => write!(f, "at {time} s: the motion is not finite"),
        }
    }
}

/// How a session ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SitlSummary {
    /// Vehicle time, s.
    pub time: f64,
    /// The vehicle's mode; none before its first tick.
    pub mode: Option<Mode>,
    /// Where it really was, m.
    pub position: [f64; 3],
    /// Control ticks that were late.
    pub missed: u32,
    /// The signal that ended it, if one did.
    pub signal: Option<u8>,
}

impl fmt::Display for SitlSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.position;
        let why = if self.signal.is_some() { "interrupted" } else { "the duration was over" };
        let mode = self.mode.map_or("silent", Mode::text);
        write!(f, "{why} after {:.1} s; {mode}, at {x:.3} {y:.3} {z:.3} m; {} ticks missed", self.time, self.missed)
    }
}
