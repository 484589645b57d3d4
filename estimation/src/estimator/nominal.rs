//! The nominal state and its motion: where the filter believes the vehicle to be, without doubt about it.
//!
//! Over an increment of h seconds with the turn phi and the change of velocity d (body frame at its start, biases taken
//! off):
//!
//! ```text
//! v+ = v + R d - g h e3        p+ = p + h (v + v+) / 2        q+ = q * exp(phi / 2)
//! ```
//!
//! d was brought into the frame at the start by a gyro with its bias, which counts half: d loses h/2 b_g x d too. The
//! turn is exact for the increment's phi; the position takes the acceleration as constant over the increment, an error
//! of jerk h^3 / 12, 1e-8 m for 1 m/s^3 and 5 ms. World frame z up, body to world, SI units.
//!
//! Attitude errors are 3-vectors, four modified Rodrigues parameters: a rotation by angle t about the unit axis n is 4
//! tan(t / 4) n, which is t n to third order, has a rational exponential and logarithm, and no singularity below a full
//! turn. They act from the left, in world axes: q_true = exp(theta) * q.

use super::history::{Clipped, Increment};
use controller_core::math;
use controller_core::rotation::half_rotation;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// p, v, q, b_g and b_a.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nominal {
    /// p, m, world.
    pub position: Vector3<f32>,
    /// v, m/s, world.
    pub velocity: Vector3<f32>,
    /// q, body to world, unit.
    pub attitude: Quaternion<f32>,
    /// b_g, rad/s, body.
    pub gyro_bias: Vector3<f32>,
    /// b_a, m/s^2, body.
    pub accelerometer_bias: Vector3<f32>,
}

/// What an increment did to the nominal state, as the covariance needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct IncrementEffect {
    /// R half-way through, to first order in the turn.
    pub rotation: Matrix3<f32>,
    /// R d, m/s, world.
    pub velocity_change: Vector3<f32>,
    /// R phi / h, rad/s, world.
    pub turn_rate: Vector3<f32>,
    /// h, s.
    pub seconds: f32,
    /// Which sensors were at full scale.
    pub clipped: Clipped,
}

impl Nominal {
    /// Carries the state through `increment`, under `gravity`, m/s^2.
    pub(super) fn advance(&mut self, increment: &Increment, gravity: f32) -> IncrementEffect {
        let seconds = increment.seconds();
        let rotation = UnitQuaternion::new_unchecked(self.attitude).to_rotation_matrix().into_inner();
        let bias_turn = self.gyro_bias * seconds;
        let turn = increment.delta_angle - bias_turn;
        let bent = bias_turn.cross(&increment.delta_velocity) * 0.5;
        let velocity_change = rotation * (increment.delta_velocity - bent - self.accelerometer_bias * seconds);
        let mut velocity = self.velocity + velocity_change;
        velocity.z -= gravity * seconds;
        self.position += (self.velocity + velocity) * (0.5 * seconds);
        self.velocity = velocity;
        self.attitude = unit(&(self.attitude * half_rotation(&(turn * 0.5))));
        let turn_rate = if seconds > 0.0 { rotation * turn / seconds } else { Vector3::zeros() };
        let rotation = rotation + rotation * (turn * 0.5).cross_matrix();
        IncrementEffect { rotation, velocity_change, turn_rate, seconds, clipped: increment.clipped }
    }
}

/// `q` made a unit quaternion; it is close to one.
pub(super) fn unit(q: &Quaternion<f32>) -> Quaternion<f32> {
    q * (1.0 / math::sqrt(q.norm_squared()))
}

/// exp(theta): the rotation whose error vector is `theta`.
pub(super) fn rotation(theta: &Vector3<f32>) -> Quaternion<f32> {
    let square = theta.norm_squared() * (1.0 / 16.0);
    let scale = 1.0 / (1.0 + square);
    Quaternion::from_parts((1.0 - square) * scale, theta * (0.5 * scale))
}

/// The error vector that turns `from` into `to`: theta with exp(theta) * from = to, the shorter way round.
pub(super) fn difference(to: &Quaternion<f32>, from: &Quaternion<f32>) -> Vector3<f32> {
    let q = to * from.conjugate();
    let scale = 4.0 / (1.0 + q.w.abs());
    q.imag() * if q.w < 0.0 { -scale } else { scale }
}

#[cfg(test)]
mod tests;
