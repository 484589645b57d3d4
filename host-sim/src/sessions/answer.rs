//! The sensors' answer to a flight controller's command: poses, and the IMU's samples.

use firmware::esc::answer;
use firmware::hardware::MOTOR_COUNT;
use flight::{ImuSample, Stamped};
use nalgebra::{Quaternion, Vector3};

/// The poles of every simulated motor.
const MOTOR_POLES: f32 = 14.0;

/// What a motor that turns at `speed`, rad/s, has its controller answer.
pub fn controller_answer(speed: f64) -> answer::Answer {
    answer::Answer::of_speed(speed as f32, MOTOR_POLES)
}

/// The speed, rad/s, that its answer gives.
pub fn answered_speed(speed: f64) -> f32 {
    answer::Answer::from_bits(controller_answer(speed).to_bits())
        .and_then(|answer| answer.speed(MOTOR_POLES))
        .unwrap_or(0.0)
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPose {
    /// p, m, world.
    pub position: Vector3<f32>,
    /// q, body to world, unit.
    pub attitude: Quaternion<f32>,
    /// v, m/s, and omega, rad/s, body frame; none from a source that knows neither.
    pub motion: Option<(Vector3<f32>, Vector3<f32>)>,
    /// Standard deviations on each axis, m and rad; none for a source that does not state them.
    pub deviations: Option<(f32, f32)>,
}

/// Measurements after a command, with the times at which they were true, us.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Poses that have arrived, in the order of their times.
    pub poses: Vec<Stamped<MeasuredPose>>,
    /// How fast the rotors turn, rad/s, as their controllers answer.
    pub rotor_speeds: Option<Stamped<[f32; MOTOR_COUNT]>>,
    /// The IMU's samples, in the order of their times; the last is of the period's end.
    pub samples: Vec<Stamped<ImuSample>>,
}
