//! Flight: which of the law's outputs reach the motors, and when.
//!
//! - [`rules`]: the flight rules, a table of modes and transitions, with their time limits;
//! - [`reason`]: reasons in words, for every transition and every refusal;
//! - [`pilot`]: [`Pilot`], which composes rules, governor, law and allocation into one tick;
//! - `permission`: what arming and a motor test need;
//! - [`crate::measurement`]: poses and time stamps; [`Pose::new`] checks a pose;
//! - `estimate`: what the [estimator](crate::estimator) makes of a tick's increments and poses, and since when all is well;
//! - `lift_off`: whether an armed vehicle still stands where it was armed;
//! - `watch`: whether it follows, has landed, or lies on its back;
//! - `fence`: how far it may go;
//! - [`FlightSettings`]: what an operator may choose about failures;
//! - `thrust_check`: whether the rotors give what they should;
//! - `chain`: from setpoints to thrusts, and why levelling is within the certificate.
//!
//! An armed vehicle idles until it is told to take off or to fly setpoints; then its rotors are brought up to the law's thrusts within a
//! second. A landing ends with the ground found and the motors stopped. A vehicle set down by its setpoint keeps turning its
//! rotors until it is told to land.
//!
//! The estimate is flown, never a pose: what a pose that lies does to a flight is what silence does. The estimator refuses it, says why,
//! and goes on by IMU; the flight goes on with it for [`rules::COASTING_MAX`], then levels for [`rules::LEVELLING_MAX`], then goes down.
//! Poses that are believed again are flown at once. Where the estimate jumps, because the sender says that its frame has moved or
//! because a lost body was found again, the reference jumps with it, and brakes from there: the vehicle does not lurch.

mod chain;
mod estimate;
#[cfg(test)]
mod example;
mod fence;
mod lasting;
mod lift_off;
mod permission;
pub mod pilot;
pub mod reason;
mod request;
pub mod rules;
mod settings;
mod thrust_check;
mod watch;

pub use crate::measurement::{
    DISTANCE_MAX, ImuSample, LENGTH_TOLERANCE, Pose, PoseError, STAMP_LEAD_MAX, Stamped, Velocity,
};
pub use chain::{Flown, Memory};
pub use estimate::SETTLED_AFTER;
pub use permission::MotorTest;
pub use pilot::Pilot;
pub use reason::{Grounded, Reason, Refusal};
pub use request::{Request, SETPOINT_AGE_MAX};
pub use rules::{Mode, Transition};
pub use settings::FlightSettings;

use crate::allocation::Thrusts;
use crate::error::InputError;
use crate::estimator::{EstimatedState, Health, Increment, PoseMeasurement, Rejected, Taken};
use crate::governor::Setpoint;
use nalgebra::Vector3;

/// The time between ticks, us.
pub const PERIOD: u64 = 10_000;

/// What the battery has left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Battery {
    /// Nobody measures it.
    #[default]
    Unknown,
    /// Enough.
    Good,
    /// Time to land.
    Low,
    /// Next to nothing.
    Critical,
}

/// What a tick is given: what has come since the last. Everything is handed over once, but for the ground station's time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inputs<'a> {
    /// The vehicle's clock, us.
    pub now: u64,
    /// What the IMU did, each increment beginning where the last ended: two of 5 ms, where nothing is late.
    pub increments: &'a [Increment],
    /// The poses that came, with the times at which they were true.
    pub poses: &'a [Stamped<PoseMeasurement>],
    /// When the ground station was last heard, us.
    pub ground_station: Option<u64>,
    /// What was asked for since the last tick.
    pub request: Option<Request>,
    /// Whether a disarm command with force came since the last tick: it stops motors in the air as well.
    pub disarm: bool,
    /// Whether the kill switch is on.
    pub killed: bool,
    /// What the battery has left.
    pub battery: Battery,
    /// Whether the last tick came to its end too late.
    pub is_late: bool,
    /// The newest setpoint since the last tick.
    pub setpoint: Option<Setpoint>,
}

/// What the motors do until the next tick.
#[derive(Debug, Clone, PartialEq)]
pub enum Output {
    /// Every motor stops.
    Stop,
    /// Every motor turns as slowly as it reliably does.
    Idle,
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
    /// What arming would be answered, while no motor turns.
    pub ready: Option<Result<(), Refusal>>,
    /// Where it was armed; where it stands, if it is not and there is an estimate, m, world.
    pub home: Option<Vector3<f32>>,
    /// Whether the vehicle has left the ground where it was armed, and has not landed.
    pub is_airborne: bool,
    /// Whether the setpoint was accepted, where setpoints are flown.
    pub setpoint: Option<Result<(), Refusal>>,
    /// The state at this tick, while there is one.
    pub estimated: Option<EstimatedState>,
    /// What it is worth.
    pub health: Health,
    /// What became of this tick's poses: the last refusal, or else what the last was taken for; none where none came, or
    /// where all of them wait for the IMU.
    pub pose: Option<Result<Taken, Rejected>>,
    /// What was flown, in an armed mode; or what the law could not use: the thrusts are then the last tick's.
    pub flown: Option<Result<Flown, InputError>>,
    /// Whether [`Flown::thrust_scale`] has been doubtful for a while, and it is time to say so.
    pub is_thrust_doubtful: bool,
}
