//! Flight: which of the law's outputs reach the motors, and when.
//!
//! - [`rules`]: the flight rules, a table of modes and transitions, with their time limits;
//! - [`reason`]: reasons in words, for every transition and every refusal;
//! - [`pilot`]: [`Pilot`], which composes rules, governor, law and allocation into one tick;
//! - `permission`: what arming and a motor test need;
//! - `measurement`: IMU samples and poses, and which of them are flown; [`Pose::new`] checks a pose;
//! - [`propagation`]: the attitude between poses, by gyro;
//! - `lift_off`: whether an armed vehicle still stands where it was armed;
//! - `chain`: from setpoints to thrusts, and why levelling is within the certificate.
//!
//! From the first armed tick on thrust is the law's T = m |u|, hover thrust for a vehicle at rest: there is no mode for
//! taking off, a setpoint above does it. Landing is not detected: a vehicle that has come down must be disarmed, and one set
//! down by its setpoint keeps turning its rotors until it is.
//!
//! Until there is an estimator, position, velocity and attitude come from the pose source and body rates from the gyro.
//! Between poses the attitude is carried on by gyro; position and velocity stay what they were, for
//! [`rules::POSE_AGE_MAX`] at most. Poses that come more seldom than that are flown all the same, each for as long, with
//! levelling in between; each begins a braking anew, so setpoints get nowhere then.

mod chain;
#[cfg(test)]
mod example;
mod lift_off;
mod measurement;
mod permission;
pub mod pilot;
pub mod propagation;
pub mod reason;
pub mod rules;

pub use chain::{Flown, Memory};
pub use measurement::{
    BODY_RATE_MAX, DISTANCE_MAX, ImuSample, LENGTH_TOLERANCE, Pose, PoseError, STAMP_LEAD_MAX, Stamped, Velocity,
};
pub use permission::MotorTest;
pub use pilot::Pilot;
pub use reason::{Grounded, Reason, Refusal};
pub use rules::{Mode, Transition};

use crate::allocation::Thrusts;
use crate::error::InputError;
use crate::governor::Setpoint;

/// The time between ticks, us.
pub const PERIOD: u64 = 10_000;

/// What somebody may ask for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Request {
    /// Arm and hold position.
    Arm,
    /// Turn one motor slowly.
    MotorTest(MotorTest),
}

/// What a tick is given. Measurements stay in place until newer ones come; the rest is handed over once.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inputs {
    /// The vehicle's clock, us.
    pub now: u64,
    /// The newest IMU sample.
    pub imu: Option<Stamped<ImuSample>>,
    /// The newest pose.
    pub pose: Option<Stamped<Pose>>,
    /// When the ground station was last heard, us.
    pub ground_station: Option<u64>,
    /// What was asked for since the last tick.
    pub request: Option<Request>,
    /// Whether a disarm command came since the last tick.
    pub disarm: bool,
    /// The newest setpoint since the last tick.
    pub setpoint: Option<Setpoint>,
}

/// What the motors do until the next tick.
#[derive(Debug, Clone, PartialEq)]
pub enum Output {
    /// Every motor stops.
    Stop,
    /// Each rotor's thrust, N, in the rotors' order, within its range.
    Thrusts(Thrusts),
    /// One motor turns, the others stop.
    Test {
        /// Its index in the rotors' order.
        rotor: usize,
        /// Part of the command's range, at most [`rules::MOTOR_TEST_LEVEL_MAX`].
        level: f32,
    },
}

/// What a tick decided.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// For the motors.
    pub output: Output,
    /// The mode of this tick.
    pub mode: Mode,
    /// How it came about, if it is new.
    pub transition: Option<Transition>,
    /// The answer to the request.
    pub answer: Option<Result<(), Refusal>>,
    /// Whether the setpoint was accepted.
    pub setpoint: Option<Result<(), Refusal>>,
    /// What was flown, in an armed mode; or what the law could not use: the thrusts are then the last tick's.
    pub flown: Option<Result<Flown, InputError>>,
}
