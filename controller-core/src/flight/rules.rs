//! The flight rules: a table of modes and transitions, and every time limit they use.
//!
//! Once a tick, the rows of the present mode are read from top to bottom and the first whose condition holds is taken: at
//! most one transition a tick, and the order of the rows is the order of precedence. What the conditions mean is said at
//! [`Condition`]; [`super::pilot`] works them out, and carries out what a mode means. Nothing else changes the mode.
//!
//! Whatever stops the motors leads to [`Mode::Disarmed`] and leaves no memory: flying again takes a new arm request, with
//! every check made anew.

use super::reason::Reason;
use crate::estimator::EXTRAPOLATION_MAX;

/// How long a flight goes on by IMU alone after the last pose that was believed, us. Drift grows with the square of the time: it must
/// stay below 10 cm in 500 ms and below 1 m in 2 s, so it is a quarter of a metre or less in this second.
pub const COASTING_MAX: u64 = 1_000_000;

/// The greatest age of what the IMU said that is flown, us: twenty samples missed, two control ticks. The attitude loop
/// stands one or two ticks of delay, not more (docs/sampled-loop.md), and without rates nothing tells where up is.
pub const IMU_AGE_MAX: u64 = EXTRAPOLATION_MAX;

/// How long a flight may be levelled without a pose that is believed, us.
pub const LEVELLING_MAX: u64 = 1_000_000;

/// How long the ground station may be silent, us. It sends heartbeats once a second: two may be lost in a row, and half a
/// second is for their jitter.
pub const GROUND_STATION_SILENCE_MAX: u64 = 2_500_000;

/// The greatest level of a motor test, as a part of the command's range: turns a rotor, lifts nothing.
pub const MOTOR_TEST_LEVEL_MAX: f32 = 0.15;

/// The longest motor test, us.
pub const MOTOR_TEST_MAX: u64 = 2_000_000;

/// Ticks in a row without new thrusts (the law or the allocation refused their input) that the last thrusts are held for.
/// Inputs are checked before the law sees them, so a refusal is a defect; 50 ms outlast a passing one.
pub const REFUSALS_MAX: u32 = 5;

/// The states of the flight rules.
///
/// ```text
/// +----------+  motor test permitted               +-----------+
/// |          | ----------------------------------> |           |
/// | Disarmed |                                     | MotorTest |
/// |          | <---------------------------------- |           |
/// +----------+  disarm, any request, time over     +-----------+
///   |      ^
///   |      |  in Flying, Holding and Levelling: disarm, IMU stale, thrusts refused;
///   |      +----------------------------------  in Levelling besides: levelling over
///   |
///   | arming permitted
///   v
/// +----------+  ground station silent              +-----------+
/// |          | ----------------------------------> |           |
/// |  Flying  |                                     |  Holding  |
/// |          | <---------------------------------- |           |
/// +----------+  ground station heard               +-----------+
///   |      ^                                              |
///   | esti-| pose                                         | estimate lost
///   | mate | regained                                     |
///   v lost |                                              |
/// +-----------+                                           |
/// | Levelling | <-----------------------------------------+
/// +-----------+
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Mode {
    /// Motors stopped. The mode at boot, and after every stop.
    Disarmed,
    /// Motors stopped but for one, turning slowly.
    MotorTest,
    /// The law flies the governor's reference; setpoints are accepted.
    Flying,
    /// The ground station is lost: the reference is brought to rest and held there; setpoints are refused.
    Holding,
    /// The estimate is lost: level at hover thrust, by the IMU's attitude alone.
    Levelling,
}

impl Mode {
    /// Every mode.
    pub const ALL: [Self; 5] = [Self::Disarmed, Self::MotorTest, Self::Flying, Self::Holding, Self::Levelling];

    /// Whether the law drives the motors.
    #[must_use]
    pub fn is_armed(self) -> bool {
        matches!(self, Self::Flying | Self::Holding | Self::Levelling)
    }
}

/// What a transition can depend on, as known in one tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Condition {
    /// A disarm command arrived.
    DisarmCommanded,
    /// Arming was requested, and everything it needs is there.
    ArmingPermitted,
    /// A motor test was requested, and may be run.
    MotorTestPermitted,
    /// Anything was requested.
    Requested,
    /// The motor test has had its time.
    MotorTestOver,
    /// The IMU's last increment is older than [`IMU_AGE_MAX`], or the estimator has lost its state.
    ImuStale,
    /// [`REFUSALS_MAX`] ticks in a row brought no new thrusts.
    ThrustsRefused,
    /// No pose has been believed for [`COASTING_MAX`], or the estimate is too uncertain.
    EstimateLost,
    /// Poses are believed again, and the governor has started from the estimate.
    PoseRegained,
    /// Levelling has lasted [`LEVELLING_MAX`].
    LevellingOver,
    /// Nothing was heard from the ground station for [`GROUND_STATION_SILENCE_MAX`].
    GroundStationSilent,
    /// Something was.
    GroundStationHeard,
}

impl Condition {
    /// Every condition.
    pub const ALL: [Self; 12] = [
        Self::DisarmCommanded,
        Self::ArmingPermitted,
        Self::MotorTestPermitted,
        Self::Requested,
        Self::MotorTestOver,
        Self::ImuStale,
        Self::ThrustsRefused,
        Self::EstimateLost,
        Self::PoseRegained,
        Self::LevellingOver,
        Self::GroundStationSilent,
        Self::GroundStationHeard,
    ];
}

/// The conditions that hold in one tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Conditions(u16);

impl Conditions {
    /// None of them.
    pub const NONE: Self = Self(0);

    /// These and, if `holds`, one more.
    #[must_use]
    pub const fn with(self, condition: Condition, holds: bool) -> Self {
        Self(self.0 | (holds as u16) << condition as u16)
    }

    /// Whether `condition` is one of them.
    #[must_use]
    pub const fn contain(self, condition: Condition) -> bool {
        self.0 >> condition as u16 & 1 == 1
    }
}

/// One row: in this mode, if this holds, go there, for this reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Row {
    /// The mode it applies in.
    pub from: Mode,
    /// What takes it.
    pub condition: Condition,
    /// The mode it leads to; the same one for a row that only forbids those below it.
    pub to: Mode,
    /// Why, in words.
    pub reason: Reason,
}

const fn row(from: Mode, condition: Condition, to: Mode, reason: Reason) -> Row {
    Row { from, condition, to, reason }
}

/// The rules. Within a mode, an upper row goes before a lower one.
#[rustfmt::skip]
pub const TABLE: [Row; 21] = {
    use Condition::*;
    use Mode::*;
    [
        //  in         if                   go to      because
        row(Disarmed,  DisarmCommanded,     Disarmed,  Reason::DisarmCommanded),
        row(Disarmed,  ArmingPermitted,     Flying,    Reason::ArmCommanded),
        row(Disarmed,  MotorTestPermitted,  MotorTest, Reason::MotorTestRequested),

        row(MotorTest, DisarmCommanded,     Disarmed,  Reason::DisarmCommanded),
        row(MotorTest, Requested,           Disarmed,  Reason::MotorTestInterrupted),
        row(MotorTest, MotorTestOver,       Disarmed,  Reason::MotorTestOver),

        row(Flying,    DisarmCommanded,     Disarmed,  Reason::DisarmCommanded),
        row(Flying,    ImuStale,            Disarmed,  Reason::ImuLost),
        row(Flying,    ThrustsRefused,      Disarmed,  Reason::ThrustsRefused),
        row(Flying,    EstimateLost,        Levelling, Reason::PoseLost),
        row(Flying,    GroundStationSilent, Holding,   Reason::GroundStationLost),

        row(Holding,   DisarmCommanded,     Disarmed,  Reason::DisarmCommanded),
        row(Holding,   ImuStale,            Disarmed,  Reason::ImuLost),
        row(Holding,   ThrustsRefused,      Disarmed,  Reason::ThrustsRefused),
        row(Holding,   EstimateLost,        Levelling, Reason::PoseLost),
        row(Holding,   GroundStationHeard,  Flying,    Reason::GroundStationRegained),

        row(Levelling, DisarmCommanded,     Disarmed,  Reason::DisarmCommanded),
        row(Levelling, ImuStale,            Disarmed,  Reason::ImuLost),
        row(Levelling, ThrustsRefused,      Disarmed,  Reason::ThrustsRefused),
        row(Levelling, PoseRegained,        Flying,    Reason::PoseRegained),
        row(Levelling, LevellingOver,       Disarmed,  Reason::PoseLostForLong),
    ]
};

/// A change of mode, and why.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Transition {
    /// The mode before.
    pub from: Mode,
    /// The mode from this tick on.
    pub to: Mode,
    /// Why.
    pub reason: Reason,
}

/// What the table says in `mode` under `conditions`: a transition, or none where the mode stays.
#[must_use]
pub fn transition(mode: Mode, conditions: Conditions) -> Option<Transition> {
    TABLE
        .iter()
        .find(|row| row.from == mode && conditions.contain(row.condition))
        .filter(|row| row.to != row.from)
        .map(|row| Transition { from: row.from, to: row.to, reason: row.reason })
}

#[cfg(test)]
mod tests;
