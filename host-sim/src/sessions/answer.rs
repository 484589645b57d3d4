//! The sensors' answer to a flight controller's command: poses, and the IMU's samples.

use flight::{ImuSample, Stamped};
use nalgebra::{Quaternion, Vector3};

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
    /// The IMU's samples, in the order of their times; the last is of the period's end.
    pub samples: Vec<Stamped<ImuSample>>,
}
