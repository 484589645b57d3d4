//! How the vehicle booted, what a control tick did, and what the line carried, for telemetry and the log.

use crate::esc::controller::RotorSpeeds;
use crate::hardware::{MOTOR_COUNT, MotorCommand};
use crate::recorder::tick::Tick;
use controller_core::certificate::certified::{Certified, Refused};
use controller_core::reference::Reference;
use controller_core::state::{State, Wrench};
use estimation::estimator::Health;
use estimation::imu::ImuFault;
use flight::{Lean, Mode, Refusal};
use nalgebra::Vector3;

/// What made the chip start, and the board's name.
pub type Started = (&'static str, &'static str);

/// The certificate's verdict on what is to be flown.
pub type Verdict = &'static Result<Certified, Refused>;

/// What has been calibrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Calibrated {
    /// The gyro's bias, since the boot.
    pub gyro: bool,
    /// The accelerometer, ever.
    pub accelerometer: bool,
    /// Its level, ever.
    pub level: bool,
}

/// One control tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// Which state of the flight rules the tick left the vehicle in.
    pub mode: Mode,
    /// Whether an arm command would be granted.
    pub ready: bool,
    /// Why it would be refused, while no motor turns.
    pub refusal: Option<Refusal>,
    /// Whether the vehicle has left the ground.
    pub is_airborne: bool,
    /// Whether it was stopped in the air, and may still fall.
    pub may_fall: bool,
    /// Where the vehicle is and how it moves, as it is estimated; none before the estimate begins, and without an IMU.
    pub state: Option<State>,
    /// How it leans by gravity alone, while the law drives no motor and it rests: nothing that could be flown.
    pub lean: Option<Lean>,
    /// The thrusts with which the law would level it then in hover, each over their mean.
    pub levelling: Option<[f32; MOTOR_COUNT]>,
    /// What the estimate is worth.
    pub health: Health,
    /// What is, or was a moment ago, wrong with gyro or accelerometer.
    pub imu_fault: Option<ImuFault>,
    /// Whether the command of the tick before did not reach the motors.
    pub motors_fail: bool,
    /// Where it was armed, or stands if it is not, m, world.
    pub home: Option<Vector3<f32>>,
    /// What the law follows; none while it does not fly.
    pub reference: Option<Reference>,
    /// The commanded wrench; none while the law does not fly.
    pub wrench: Option<Wrench>,
    /// The motors' commands, 0 to 1, in the rotors' order; 0 where one stops.
    pub motors: [f32; MOTOR_COUNT],
    /// What the rotors are believed to give of it; none while the law does not fly.
    pub thrust_scale: Option<f32>,
    /// How far the mission is.
    pub mission: MissionReport,
    /// Whether a policy is let fly.
    pub flies_policy: bool,
    /// How well the ticks keep time.
    pub timing: Timing,
}

/// A mission's progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MissionReport {
    /// The item that is flown, or will be.
    pub next: u8,
    /// Whether it is flown.
    pub is_flown: bool,
    /// The item that was done last, and how many were, modulo 256.
    pub done: (u8, u8),
}

impl Report {
    /// Of control that has done nothing yet.
    pub const NONE: Self = Self {
        mode: Mode::Boot,
        ready: false,
        refusal: None,
        is_airborne: false,
        may_fall: false,
        state: None,
        lean: None,
        levelling: None,
        health: Health::NONE,
        imu_fault: None,
        motors_fail: false,
        home: None,
        reference: None,
        wrench: None,
        motors: [0.0; MOTOR_COUNT],
        thrust_scale: None,
        mission: MissionReport { next: 0, is_flown: false, done: (0, 0) },
        flies_policy: false,
        timing: Timing { period: 0, worst_duration: 0, worst_jitter: 0, missed: 0, gaps: 0 },
    };
}

impl Report {
    /// For the flight recorder: with the motors' command, the rotors' speeds, and the battery's voltage, V.
    pub fn tick(&self, time: u64, command: MotorCommand, rotor_speeds: RotorSpeeds, voltage: Option<f32>) -> Tick {
        Tick {
            time,
            mode: self.mode,
            is_airborne: self.is_airborne,
            state: self.state,
            reference: self.reference,
            wrench: self.wrench,
            thrust_scale: self.thrust_scale,
            pose_age: self.health.pose_age,
            missed: self.timing.missed,
            command,
            rotor_speeds,
            voltage,
        }
    }
}

/// How well control keeps time, since boot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Timing {
    /// The time between ticks, us.
    pub period: u64,
    /// The longest tick, us.
    pub worst_duration: u32,
    /// The greatest distance of a tick's start from where the period put it, us.
    pub worst_jitter: u32,
    /// Ticks that did not run to their end in time.
    pub missed: u32,
    /// Times that the IMU's increments broke off: it was silent, or control was late by more than they wait for.
    pub gaps: u32,
}

/// What the link received since boot; each count starts again after 2^32.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Traffic {
    /// Frames with the right checksum.
    pub frames: u32,
    /// Bytes that were part of none.
    pub discarded: u32,
    /// Messages that could not be used.
    pub refused: u32,
    /// Commands that the line delivered twice.
    pub repeated: u32,
}
