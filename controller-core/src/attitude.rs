//! The saturated attitude law, Section V of the paper.
//!
//! | paper | here | equation |
//! |---|---|---|
//! | R~ = R_d^T R | `attitude_error`, a quaternion | Section V |
//! | omega~ = omega - R~^T omega_d | `angular_velocity_error` | Section V |
//! | s_theta(theta~) = M_theta k_theta theta~ / sqrt(M_theta^2 + \|k_theta theta~\|^2) | `attitude_feedback` | Section V |
//! | s_omega(omega~) = M_omega k_omega omega~ / sqrt(M_omega^2 + \|k_omega omega~\|^2) | `rate_feedback` | Section V |
//! | tau_c = \[J R~^T omega_d\]x R~^T omega_d - J R~^T omega_d' | minus the feedforward | Section V |
//! | tau = -(1 + \|theta~\|^2)/4 s_theta - s_omega - tau_c | `torque` | Section V |
//!
//! The paper writes the gain inside the saturations *and* in their argument; it acts once. Body frame, N m.

use crate::gains::Gains;
use crate::math;
use nalgebra::{Quaternion, Vector3};

/// The torque and the terms it is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueCommand {
    /// omega~, rad/s, body frame.
    pub angular_velocity_error: Vector3<f32>,
    /// s_theta(k_theta theta~), N m, shorter than M_theta.
    pub attitude_feedback: Vector3<f32>,
    /// s_omega(k_omega omega~), N m, shorter than M_omega.
    pub rate_feedback: Vector3<f32>,
    /// tau, N m, body frame.
    pub torque: Vector3<f32>,
}

/// The radial saturation s(x) = M x / sqrt(M^2 + |x|^2): unit slope at zero, shorter than `level` everywhere.
#[inline]
#[must_use]
pub fn radial_saturation(x: &Vector3<f32>, level: f32) -> Vector3<f32> {
    x * (level / math::sqrt(level * level + x.norm_squared()))
}

/// R(q)^T v for a unit quaternion.
#[inline(always)]
#[must_use]
pub fn rotate_back(q: &Quaternion<f32>, v: &Vector3<f32>) -> Vector3<f32> {
    let axis = q.imag();
    let twice = axis.cross(v) * 2.0;
    v - twice * q.w + axis.cross(&twice)
}

/// Evaluates the law. `error` is the lifted unit quaternion of R~ and `mrp` its theta~; `angular_velocity` is omega in the
/// body frame; omega_d and omega_d' are in the axes of the desired body frame.
#[inline]
#[must_use]
pub fn torque_command(
    gains: &Gains,
    inertia: &Vector3<f32>,
    error: &Quaternion<f32>,
    mrp: &Vector3<f32>,
    angular_velocity: &Vector3<f32>,
    desired_angular_velocity: &Vector3<f32>,
    desired_angular_acceleration: &Vector3<f32>,
) -> TorqueCommand {
    let rate = rotate_back(error, desired_angular_velocity);
    let acceleration = rotate_back(error, desired_angular_acceleration);
    let angular_velocity_error = angular_velocity - rate;

    let attitude_feedback = radial_saturation(&(mrp * gains.k_theta), gains.m_theta);
    let rate_feedback = radial_saturation(&(angular_velocity_error * gains.k_omega), gains.m_omega);
    let gyroscopic = inertia.component_mul(&rate).cross(&rate);
    let inertial = inertia.component_mul(&acceleration);
    let torque = inertial - gyroscopic - attitude_feedback * (0.25 * (1.0 + mrp.norm_squared())) - rate_feedback;
    TorqueCommand { angular_velocity_error, attitude_feedback, rate_feedback, torque }
}
