//! The inputs and the outcome of a tick.

use super::chain::Flown;
use super::lean::Lean;
use super::mission::{MissionItem, MissionStep};
use super::motor::Word;
use super::policy::Handover;
use super::refusal::{Refusal, Stored};
use super::request::Request;
use super::rotor_check::RotorFault;
use super::rules::{Mode, Transition};
use super::stream_check::Streamed;
use controller_core::allocation::Thrusts;
use controller_core::allocation::remaining::LostRotor;
use controller_core::error::InputError;
use controller_core::governor::Setpoint;
use estimation::estimator::{Accepted, EstimatedState, Health, Increment, PoseMeasurement, Rejected};
use estimation::imu::ImuFault;
use estimation::measurement::Stamped;
use nalgebra::Vector3;

/// What the battery has left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Battery {
    /// Not measured, and not to be watched.
    #[default]
    Unknown,
    /// To be watched, and not measured.
    Missing,
    /// Enough.
    Good,
    /// Time to land.
    Low,
    /// Almost empty.
    Critical,
}

/// The inputs of a tick: what has come since the last. Each is passed once, but for the newest body rate and the ground
/// station's time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inputs<'a> {
    /// The vehicle's clock, us.
    pub now: u64,
    /// What the IMU did, each increment beginning where the last ended: one each 5 ms, unless the IMU task is late.
    pub increments: &'a [Increment],
    /// What the IMU has done since the last of them, as far as it has been sampled.
    pub under_way: Option<Increment>,
    /// The newest body rate, low-passed, rad/s, as the sensor has it.
    pub body_rate: Option<Stamped<Vector3<f32>>>,
    /// How fast the rotors turn, rad/s, in their order; none of a rotor whose controller did not answer of late.
    pub rotor_speeds: Option<Stamped<&'a [Option<f32>]>>,
    /// The newest specific force, m/s^2, as the sensor has it.
    pub specific_force: Option<Stamped<Vector3<f32>>>,
    /// The fault of gyro or accelerometer, present or within the last second.
    pub imu_fault: Option<ImuFault>,
    /// The poses that came, with the times at which they were true.
    pub poses: &'a [Stamped<PoseMeasurement>],
    /// The time of the ground station's last heartbeat, us.
    pub ground_station: Option<u64>,
    /// The request that came since the last tick.
    pub request: Option<Request>,
    /// Whether a disarm command with force came since the last tick: it stops motors in the air as well.
    pub disarm: bool,
    /// Whether the kill switch is on.
    pub killed: bool,
    /// Whether a flash write is under way, which may stall the processor.
    pub is_busy: bool,
    /// What an operator had stored, and what cannot be read any more.
    pub lost: Option<Stored>,
    /// Whether the clock's accuracy is unknown: its crystal does not run.
    pub is_clock_doubtful: bool,
    /// Whether the last tick's command did not reach the motors.
    pub motors_fail: bool,
    /// What the battery has left.
    pub battery: Battery,
    /// Whether the last tick came to its end too late.
    pub is_late: bool,
    /// The newest setpoint since the last tick.
    pub setpoint: Option<Setpoint>,
    /// How long before this tick that was true, s.
    pub setpoint_late: f32,
    /// The mission's item that [`mission_item`](super::Pilot::mission_item) names, if there is one of that number.
    pub mission_item: Option<MissionItem>,
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
        /// Part of the command's range, at most [`super::rules::MOTOR_TEST_LEVEL_MAX`].
        level: f32,
    },
    /// One motor's controller gets a word, the others stop.
    Word {
        /// The motor's index in the rotors' order.
        rotor: usize,
        /// The word.
        word: Word,
    },
}

/// The outcome of a tick.
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
    /// Whether its motors were stopped in the air, and it may still fall.
    pub may_fall: bool,
    /// Whether the setpoint was accepted, where setpoints are flown; or why it begins no flight, where one is waited
    /// for.
    pub setpoint: Option<Result<(), Refusal>>,
    /// Whether setpoints are flown, or will be once they come.
    pub setpoints_requested: bool,
    /// The item of the mission that is flown, or will be, and whether it is flown.
    pub mission: (u8, bool),
    /// What the mission did.
    pub mission_step: Option<MissionStep>,
    /// The state at this tick, while there is one.
    pub estimated: Option<EstimatedState>,
    /// How it leans by gravity alone, while the law drives no motor and it rests.
    pub lean: Option<Lean>,
    /// The thrusts with which the law would level it then in hover, each over their mean, in the rotors' order; none
    /// without a certified configuration.
    pub levelling: Option<Thrusts>,
    /// The estimate's health.
    pub health: Health,
    /// The verdict on this tick's poses: the last refusal, or else what the last was taken for; none where none came,
    /// or where all of them wait for the IMU.
    pub pose: Option<Result<Accepted, Rejected>>,
    /// What was flown, in an armed mode; or what the law could not use: the thrusts are then the last tick's.
    pub flown: Option<Result<Flown, InputError>>,
    /// The rotors' thrust over the commanded thrust, in the ticks that report a persistent deviation.
    pub doubtful_thrust: Option<f32>,
    /// A rotor that does not turn as it is commanded to, in the ticks that report it.
    pub rotor_fault: Option<RotorFault>,
    /// The rotor that is found to fail, in the tick in which it is.
    pub lost: Option<LostRotor>,
    /// How a stream of setpoints is flown, in the ticks that report it.
    pub streamed: Option<Streamed>,
    /// Whether a policy is let fly.
    pub flies_policy: bool,
    /// Who flies from now on, in the ticks in which that changes while a policy is let fly.
    pub handover: Option<Handover>,
}
