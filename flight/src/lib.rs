//! Flight: which of the law's outputs reach the motors, and when.
//!
//! - [`rules`]: the flight rules, a table of modes and transitions, with their timeouts;
//! - [`reason`]: reasons in words, for every transition; `refusal`: for every refusal;
//! - [`pilot`]: [`Pilot`], which composes rules, governor, law and allocation into one tick;
//! - `permission`: what arming and turning a motor need; `motor`, `bench`: the requests for one motor while no other
//!   turns, and their output;
//! - [`estimation::measurement`]: poses and time stamps; [`Pose::new`] checks a pose;
//! - `estimate`: the [estimator](estimation::estimator)'s state in a tick, and how long it has been healthy;
//! - `lean`: how a vehicle leans by gravity alone, on the bench;
//! - `lift_off`: whether an armed vehicle still stands where it was armed;
//! - `detectors`: whether it follows, has landed, or lies on its back;
//! - `fall`: whether a vehicle whose motors were stopped in the air lies still again;
//! - `fence`: the limits of position;
//! - [`MissionItem`]: missions, a source of setpoints inside the pilot;
//! - [`FlightSettings`]: the operator's settings for failures;
//! - `policy`: a policy aboard, behind a shield;
//! - `trust`: whether a source of poses may still be believed;
//! - `rotor_check`: whether each rotor turns as it is commanded to, by its measured speed;
//! - `thrust_check`: delivered over commanded thrust, checked;
//! - `stream_check`: whether a stream of setpoints is flown as it is sent;
//! - `chain`: from setpoints to thrusts, and why levelling is within the certificate; `braking`, `spool`, `sinking`:
//!   how a reference comes to rest, rotors are brought up, and a vehicle without a pose goes down.
//!
//! An armed vehicle idles until a command to take off or to fly setpoints; then its rotors are brought up to the law's
//! thrusts within a second. A landing ends with the ground found and the motors stopped. A vehicle set down by its
//! setpoint keeps turning its rotors until a command to land.
//!
//! The estimate is flown, never a pose: a wrong pose affects a flight as a missing one does. The estimator refuses it,
//! reports why, and goes on by IMU. The flight goes on with it for [`rules::COASTING_MAX_US`], then levels for
//! [`rules::LEVELLING_MAX_US`], then goes down. Poses that are believed again are flown at once. Where the estimate
//! jumps, because the sender reports a move of its frame or a lost body was found again, the reference jumps with it
//! and brakes from there: the vehicle does not lurch.

#![no_std]
#![deny(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable)
)]

#[cfg(test)]
#[path = "../../controller-core/tests/support/hummingbird.rs"]
mod hummingbird;

/// The time between ticks in tests.
#[cfg(test)]
const PERIOD_US: u64 = 10_000;

mod bench;
mod braking;
mod chain;
mod debounce;
mod detectors;
mod estimate;
mod exchange;
mod fall;
mod fence;
mod lean;
mod lift_off;
mod low_pass;
mod mission;
mod motor;
mod permission;
pub mod pilot;
mod policy;
pub mod reason;
mod refusal;
mod request;
mod rotor_check;
pub mod rules;
mod settings;
mod sinking;
mod spool;
mod stream_check;
mod thrust_check;
mod tilt;
mod trust;

pub use chain::{Flown, Memory};
pub use estimate::SETTLED_AFTER_US;
pub use estimation::measurement::{
    DISTANCE_MAX_M, ImuSample, Pose, PoseError, QUATERNION_LENGTH_TOLERANCE, STAMP_LEAD_MAX_US, Stamped, Velocity,
};
pub use exchange::{Battery, Inputs, Outcome, Output};
pub use lean::Lean;
pub use mission::{ACCEPTANCE_RADIUS_M, Leg, MissionItem, MissionRefusal, MissionStep};
pub use motor::{MotorSetting, MotorTest, Setting, Word};
pub use pilot::Pilot;
pub use policy::{Aboard, Guarded, Handover, NoPolicy, Shielded};
pub use reason::Reason;
pub use refusal::{Grounded, Refusal, Stored};
pub use request::{Request, SETPOINT_AGE_MAX_US};
pub use rotor_check::{RotorDeviation, RotorFault, SPEEDS_STALE_AFTER_US};
pub use rules::{Mode, Transition};
pub use settings::FlightSettings;
pub use stream_check::Streamed;
