//! The attitude between poses: the last pose's, carried on with the gyro.
//!
//! For a body rate constant over h seconds the rotation is exactly
//!
//! ```text
//! q(t + h) = q(t) * (cos |phi|/2, sin(|phi|/2) phi/|phi|),   phi = h omega
//! ```
//!
//! with omega the mean of the rates at both ends (the trapezoid: over a manoeuvre its errors cancel to second order,
//! where either end alone would leave h/2 times the change of rate). Rounding is normalised away at each step. The
//! gyro's bias is not known here: 0.5 degrees a second, large for a calibrated one, is half a degree in the second that
//! this must last.
//!
//! Every new pose starts afresh at the time it was true, so the age of a pose on arrival is made up for too.

use controller_core::math;
use controller_core::rotation::half_rotation;
use nalgebra::{Quaternion, Vector3};

/// An attitude with the time and the body rate it was true at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PropagatedAttitude {
    attitude: Quaternion<f32>,
    /// rad/s, body.
    angular_velocity: Vector3<f32>,
    /// us.
    time: u64,
}

impl PropagatedAttitude {
    /// Starts from `attitude`, a unit quaternion that was true at `time` (us), with body rates in rad/s.
    pub fn new(attitude: Quaternion<f32>, angular_velocity: Vector3<f32>, time: u64) -> Self {
        Self { attitude, angular_velocity, time }
    }

    /// Carries the attitude on to `time` (us; an earlier one changes nothing but the rate).
    pub fn advance(&mut self, angular_velocity: Vector3<f32>, time: u64) {
        let seconds = time.saturating_sub(self.time) as f32 * 1e-6;
        let half_angle = (self.angular_velocity + angular_velocity) * (0.25 * seconds);
        let attitude = self.attitude * half_rotation(&half_angle);
        self.attitude = attitude * (1.0 / math::sqrt(attitude.norm_squared()));
        self.angular_velocity = angular_velocity;
        self.time = self.time.max(time);
    }

    /// q, body to world, unit.
    pub fn attitude(&self) -> Quaternion<f32> {
        self.attitude
    }
}

#[cfg(test)]
mod tests;
