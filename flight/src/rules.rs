//! The flight rules: a table of modes and transitions, and every time limit they use.
//!
//! Once a tick, the rows of the present mode are read from top to bottom and the first whose condition holds is taken:
//! at most one transition a tick, and the order of the rows is the order of precedence. [`Condition`] defines the
//! conditions; [`super::pilot`] evaluates them, and carries out a mode. Nothing else changes the mode.
//!
//! - [`mode`](Mode): what the vehicle is doing, with the diagram of the modes;
//! - `condition`: what a transition can depend on;
//! - `table`: the rows.
//!
//! A failure in flight ends in the mildest way that working sensors allow: holding, with an estimate and a link that
//! may come back; landing, with an estimate; descending, with an IMU; stopped motors with neither. Flying again takes a
//! new arm request, with every check made anew.

mod condition;
mod mode;
mod table;

pub use condition::{Condition, Conditions};
pub use mode::Mode;
pub use table::{Row, TABLE};

use super::reason::Reason;
use estimation::estimator::EXTRAPOLATION_MAX_US;

/// How long a flight goes on by IMU alone after the last pose that was believed. Drift grows with the square of the
/// time: it must stay below 10 cm in 500 ms and below 1 m in 2 s, so it is a quarter of a metre or less in this second.
pub const COASTING_MAX_US: u64 = 1_000_000;

/// The maximum age of an IMU sample that is flown: twenty samples missed, and the delay of its own filters. The
/// attitude loop stands no more (docs/sampled-loop.md), and without rates the attitude is unknown.
pub const IMU_AGE_MAX_US: u64 = EXTRAPOLATION_MAX_US;

/// How long a vehicle without a pose only levels: poses may come back. Then it goes down.
pub const LEVELLING_MAX_US: u64 = 1_000_000;

/// How long it may go down by the IMU alone, levelling included: 20 m at the minimum speed.
pub const DESCENDING_MAX_US: u64 = 30_000_000;

/// How long a landing may brake across before it goes down.
pub const BRAKING_MAX_US: u64 = 5_000_000;

/// How long a landing may take: this many times the time from its maximum height (at most the fence's) at its speed,
/// and [`LANDING_TIMEOUT_EXTRA_S`]. After that its poses do not lead to the ground.
pub const LANDING_TIMEOUT_FACTOR: f32 = 2.0;
/// See [`LANDING_TIMEOUT_FACTOR`].
pub const LANDING_TIMEOUT_EXTRA_S: f32 = 12.0;

/// How long the ground station may be silent. It sends heartbeats once a second: two may be lost in a row, and half
/// a second is for their jitter.
pub const GROUND_STATION_TIMEOUT_US: u64 = 2_500_000;

/// How long an armed vehicle may idle on the ground, or fly setpoints that do not lift it.
pub const IDLING_MAX_US: u64 = 10_000_000;

/// How long a request for setpoints is kept while disarmed: a client requests them and arms within a second or two.
/// An operator who arms later may not know of the request.
pub const SETPOINTS_REQUEST_MAX_US: u64 = 5_000_000;

/// How long a battery must be low before the vehicle lands: it sags under a burst of thrust.
pub const BATTERY_DEBOUNCE_US: u64 = 3_000_000;

/// How long the vehicle may be far from its reference: a recovery takes seconds, wind that is too strong does not
/// end.
pub const TRACKING_DEBOUNCE_US: u64 = 5_000_000;

/// How long the rotors may deliver less than the command. In a certified flight they never do.
pub const SATURATION_DEBOUNCE_US: u64 = 1_000_000;

/// How long a vehicle without a rotor must have been on its way before a reference at rest counts as arrived.
pub const ARRIVING_MIN_US: u64 = 1_000_000;

/// How long control may be late with every tick.
pub const OVERRUN_DEBOUNCE_US: u64 = 100_000;

/// The maximum level of a motor test, as a part of the command's range: turns a rotor, lifts nothing.
pub const MOTOR_TEST_LEVEL_MAX: f32 = 0.15;

/// Of a motor test.
pub const MOTOR_TEST_MAX_US: u64 = 2_000_000;

/// How long the last thrusts are held without new ones, where the law or the allocation refuses its input tick
/// after tick. Inputs are checked before the law sees them, so a refusal is a defect; this outlasts a passing one.
pub const REFUSAL_MAX_US: u64 = 50_000;

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

/// The table's transition in `mode` under `conditions`; none where the mode stays.
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
