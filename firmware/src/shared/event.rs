//! Events for the operator. An event is put into words where it is sent or logged, not in the control task it may come
//! from.

use controller_core::allocation::remaining::LostRotor;
use controller_core::error::InputError;
use core::fmt::{self, Write};
use estimation::estimator::{Accepted, Fault, Rejected};
use flight::{Handover, MissionStep, Reason, Refusal, RotorFault, Streamed};

/// The greatest length of a text, bytes: that of a MAVLink STATUSTEXT.
pub const TEXT_MAX: usize = 50;

/// One line, cut to what a STATUSTEXT holds.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Text(heapless::String<TEXT_MAX>);

impl Text {
    /// The words; what does not fit is cut off, and so is the rest of a character that fits in part.
    pub fn new(words: impl fmt::Display) -> Self {
        let mut text = Self::default();
        // An error means that it is full.
        let _ = write!(text, "{words}");
        text
    }

    /// The line.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Write for Text {
    fn write_str(&mut self, words: &str) -> fmt::Result {
        let end = words.floor_char_boundary(TEXT_MAX - self.0.len());
        self.0.push_str(words.get(..end).unwrap_or("")).map_err(|_| fmt::Error)?;
        if end < words.len() { Err(fmt::Error) } else { Ok(()) }
    }
}

/// How much it matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// Information.
    Information,
    /// Something is not as it should be.
    Warning,
    /// The vehicle acts on its own.
    Critical,
}

/// An event for the operator.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// The flight rules changed the mode.
    Mode(Reason),
    /// A request or a setpoint was refused.
    Refused(Refusal),
    /// What became of a pose.
    Pose(Result<Accepted, Rejected>),
    /// The estimate is not what it should be.
    Estimator(Fault),
    /// The law cannot use its input.
    Input(InputError),
    /// For a while now the rotors have delivered this share of the commanded thrust.
    Thrust(f32),
    /// A rotor does not turn as it is commanded to.
    RotorFault(RotorFault),
    /// A rotor is found to fail.
    RotorLost(LostRotor),
    /// How a stream of setpoints is flown.
    Streamed(Streamed),
    /// Who flies, the policy or the law.
    Handover(Handover),
    /// How a mission goes on.
    Mission(MissionStep),
    /// The motors' frames do not go out.
    MotorsLost,
    /// They do again.
    MotorsRegained,
    /// The battery that is to be watched is not measured.
    BatteryMissing,
    /// The vehicle has armed with poses of unknown delay.
    PoseDelayUnknown,
    /// Anything else, in words.
    Words(Severity, Text),
}

impl Event {
    /// A text.
    pub fn new(severity: Severity, words: impl fmt::Display) -> Self {
        Self::Words(severity, Text::new(words))
    }

    /// Transitions by failure are critical; commanded ones, and recoveries, are information.
    pub fn severity(&self) -> Severity {
        match self {
            Self::Mode(reason) if reason.is_own_doing() => Severity::Critical,
            Self::Input(_) | Self::MotorsLost | Self::RotorLost(_) | Self::Mission(MissionStep::Refused(..)) => {
                Severity::Critical
            }
            Self::Handover(Handover::ToLawForGood(_)) => Severity::Critical,
            Self::Mission(_)
            | Self::Mode(_)
            | Self::MotorsRegained
            | Self::Pose(Ok(_))
            | Self::Handover(Handover::ToPolicy)
            | Self::Streamed(Streamed::AsSent) => Severity::Information,
            Self::Refused(_)
            | Self::Pose(Err(_))
            | Self::Estimator(_)
            | Self::Thrust(_)
            | Self::RotorFault(_)
            | Self::Streamed(_)
            | Self::Handover(_)
            | Self::BatteryMissing
            | Self::PoseDelayUnknown => Severity::Warning,
            Self::Words(severity, _) => *severity,
        }
    }
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mode(reason) => reason.fmt(f),
            Self::Refused(refusal) => refusal.fmt(f),
            Self::Pose(Ok(taken)) => taken.fmt(f),
            Self::Pose(Err(rejected)) => rejected.fmt(f),
            Self::Estimator(fault) => fault.fmt(f),
            Self::Input(error) => error.fmt(f),
            Self::Thrust(share) => write!(f, "Thrust x{share:.2}: check battery, mass, THR_CURVE"),
            Self::RotorFault(fault) => fault.fmt(f),
            Self::RotorLost(LostRotor { rotor, left }) => {
                write!(f, "Rotor {} lost: {:.0} % of its thrust left", rotor + 1, 100.0 * left)
            }
            Self::Streamed(streamed) => streamed.fmt(f),
            Self::Handover(handed) => handed.fmt(f),
            Self::Mission(step) => step.fmt(f),
            Self::MotorsLost => f.write_str("motors: a frame did not go out"),
            Self::MotorsRegained => f.write_str("motors: frames go out again"),
            Self::BatteryMissing => f.write_str("Battery: no reading for 1 s, nothing watches it"),
            Self::PoseDelayUnknown => f.write_str("Poses: delay unknown; use TIMESYNC or POSE_DELAY"),
            Self::Words(_, text) => f.write_str(text.as_str()),
        }
    }
}
