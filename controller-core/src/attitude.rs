//! The saturated attitude law, Section V of the paper.
//!
//! | paper | here | equation |
//! |---|---|---|
//! | R~ = R_d^T R | `attitude_error`, a quaternion | Section V |
//! | omega~ = omega - R~^T omega_d | `angular_velocity_error` | Section V |
//! | s_theta(theta~) = M_theta k_theta theta~ / sqrt(M_theta^2 + \|k_theta theta~\|^2) | `attitude_feedback` | Section V |
//! | s_omega(omega~) = M_omega k_omega omega~ / sqrt(M_omega^2 + \|k_omega omega~\|^2) | `rate_feedback` | Section V |
//! | tau_c = \[J R~^T omega_d\]x R~^T omega_d - J R~^T omega_d' | minus `feedforward` | Section V |
//! | tau = -(1 + \|theta~\|^2)/4 s_theta - s_omega - tau_c | `torque` | Section V |
//!
//! The paper writes the gain inside the saturations *and* in their argument; it acts once. Body frame, N m.
//!
//! The tick takes its terms from the error's quaternion (Q_0, Q_v) itself, of length N and s = ±1 times along the lift.
//! With D = N + s Q_0, theta~ = s Q_v / D and (1 + |theta~|^2) / 4 = N / (2 D), so
//!
//! (1 + |theta~|^2)/4 s_theta = s (k_theta / 2) N / (D sqrt(D^2 + (k_theta / M_theta)^2 |Q_v|^2)) Q_v:
//!
//! one root and one division. J is diagonal, so (J w) x w has the components (J_y - J_z) w_y w_z and so on around.

use crate::gains::Gains;
use crate::math;
use crate::state::length_squared;
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

/// R(q)^T v for a quaternion q = (w, a) of any length: v - w t + a x t with t = 2 a x v / |q|^2.
#[inline(always)]
pub fn rotate_back(q: &Quaternion<f32>, v: &Vector3<f32>) -> Vector3<f32> {
    let (axis, w) = (q.imag(), q.w);
    let t = (axis * (2.0 / length_squared(q))).cross(v);
    Vector3::new(
        v.x - w * t.x + axis.y * t.z - axis.z * t.y,
        v.y - w * t.y + axis.z * t.x - axis.x * t.z,
        v.z - w * t.z + axis.x * t.y - axis.y * t.x,
    )
}

/// The attitude law's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttitudeLaw {
    /// The diagonal of J, kg m^2.
    inertia: Vector3<f32>,
    /// (J_z - J_y, J_x - J_z, J_y - J_x), kg m^2.
    differences: Vector3<f32>,
    /// k_theta / 2, N m.
    half_gain: f32,
    /// (k_theta / M_theta)^2.
    steepness: f32,
    /// k_omega M_omega.
    rate_product: f32,
    /// M_omega^2.
    rate_level: f32,
    /// k_omega^2.
    rate_gain: f32,
}

impl AttitudeLaw {
    /// For `gains` and the diagonal of J, kg m^2.
    pub fn new(gains: &Gains, inertia: &Vector3<f32>) -> Self {
        let [k_theta, m_theta, k, m] = [gains.k_theta, gains.m_theta, gains.k_omega, gains.m_omega].map(f64::from);
        let steepness = k_theta / m_theta;
        Self {
            inertia: *inertia,
            differences: inertia.zxy() - inertia.yzx(),
            half_gain: 0.5 * gains.k_theta,
            steepness: (steepness * steepness) as f32,
            rate_product: (k * m) as f32,
            rate_level: (m * m) as f32,
            rate_gain: (k * k) as f32,
        }
    }

    /// Evaluates the law. `error` is a quaternion of any length along R~, `sign` times along the lift;
    /// `angular_velocity` is omega in the body frame; omega_d and omega_d' are in the axes of the desired body frame.
    #[inline(always)]
    pub fn command(
        &self,
        error: &Quaternion<f32>,
        sign: f32,
        angular_velocity: &Vector3<f32>,
        desired_angular_velocity: &Vector3<f32>,
        desired_angular_acceleration: &Vector3<f32>,
    ) -> TorqueCommand {
        let rate = rotate_back(error, desired_angular_velocity);
        let acceleration = rotate_back(error, desired_angular_acceleration);
        let angular_velocity_error = angular_velocity - rate;

        let (axis, length) = (error.imag(), math::sqrt(length_squared(error)));
        let d = length + sign * error.w;
        let root = math::sqrt(d * d + self.steepness * axis.norm_squared());
        let attitude_gain = self.half_gain * length * sign / (d * root);
        let squared = self.rate_level + self.rate_gain * angular_velocity_error.norm_squared();
        let rate_feedback = angular_velocity_error * (self.rate_product / math::sqrt(squared));
        let feedforward = self.inertia.component_mul(&acceleration)
            + self.differences.component_mul(&rate.yzx()).component_mul(&rate.zxy());
        TorqueCommand {
            angular_velocity_error,
            attitude_feedback: axis * (2.0 * self.half_gain * sign / root),
            rate_feedback,
            torque: feedforward - axis * attitude_gain - rate_feedback,
        }
    }
}
