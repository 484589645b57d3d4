//! Flight: which of the law's outputs reach the motors, and when.

use nalgebra::{Quaternion, Vector3};

/// A value and when it was true, microseconds of the vehicle's clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stamped<T> {
    /// What.
    pub value: T,
    /// When, us.
    pub time: u64,
}

impl<T> Stamped<T> {
    /// How old it is at `now`, us; zero for a time to come.
    #[must_use]
    pub fn age(&self, now: u64) -> u64 {
        now.saturating_sub(self.time)
    }
}

/// What the inertial measurement unit says, body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImuSample {
    /// omega, rad/s.
    pub angular_velocity: Vector3<f32>,
    /// Specific force (acceleration less gravity), m/s^2: +g along z at rest.
    pub specific_force: Vector3<f32>,
}

/// What the pose source says: until an estimator exists, attitude and velocity come from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// p, m, world.
    pub position: Vector3<f32>,
    /// v, m/s, world.
    pub velocity: Vector3<f32>,
    /// q, body to world, unit.
    pub attitude: Quaternion<f32>,
}
