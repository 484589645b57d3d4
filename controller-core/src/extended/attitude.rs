//! The attitude law with separate levels for tilt and yaw. Section 4 of `docs/extended-law.md`.
//!
//! With the lifted error q = m* Phi(q_hat, R~) = (q_0, q_1, q_2, q_3), r^2 = q_1^2 + q_2^2 and h = sqrt((q_0 + eta)^2 + q_3^2):
//!
//! | here | equation |
//! |---|---|
//! | V | 1/2 omega~^T J omega~ + w (1 + eta - h) + U_t(r), dU_t/dr = 2 r G(r) |
//! | G(r) | M_t k_t / (sqrt(M_t^2 + k_t^2 r^2) sqrt(1 - r^2 + eta_t^2)) |
//! | `potential` | (w / 2h) ((q_0 + eta) q_1 + q_2 q_3, (q_0 + eta) q_2 - q_1 q_3, eta q_3) + G (q_0 q_1 + q_2 q_3, q_0 q_2 - q_1 q_3, 0) |
//! | `damping` | s_omega(omega~): a disc (k_omega_t, M_omega_t) on the first two components, a number (k_omega_z, M_omega_z) on the third |
//! | `torque` | -potential - damping + J R~^T omega_d' - \[J R~^T omega_d\]x R~^T omega_d |
//!
//! Then V' = -omega~ . s_omega(omega~) <= 0 for any J and omega_d, and V falls across the switch to the shadow, where U_t does
//! not change. The potential's torque is at most w r / 2 + G r sqrt(1 - r^2) about the tilt's axes together and w eta / 2 about
//! z. Towards a half turn the tilt's damping may ease: its gain is k_omega_t (1 - ease r^2). Body frame, N m.

use super::parameters::AttitudeParameters;
use super::saturation::Saturation;
use crate::attitude::rotate_back;
use crate::math;
use nalgebra::{Quaternion, Vector3};

/// The torque and the terms it is made of, body frame, N m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttitudeTorque {
    /// omega~, rad/s.
    pub angular_velocity_error: Vector3<f32>,
    /// What the potential pulls with, its sign turned.
    pub potential: Vector3<f32>,
    /// s_omega(omega~).
    pub damping: Vector3<f32>,
    /// tau.
    pub torque: Vector3<f32>,
}

/// The attitude law's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttitudeLaw {
    /// w / 2, N m, and eta.
    half_w: f32,
    eta: f32,
    /// M_t k_t, M_t^2 and k_t^2, N^2 m^2, and eta_t^2.
    tilt_product: f32,
    tilt_level_squared: f32,
    tilt_gain_squared: f32,
    eta_t_squared: f32,
    damping_tilt: Saturation,
    damping_yaw: Saturation,
    ease: f32,
    /// The diagonal of J, kg m^2.
    inertia: Vector3<f32>,
    /// (J_z - J_y, J_x - J_z, J_y - J_x), kg m^2.
    differences: Vector3<f32>,
}

impl AttitudeLaw {
    /// For the diagonal of J, kg m^2.
    #[must_use]
    pub fn new(parameters: &AttitudeParameters, inertia: &Vector3<f32>) -> Self {
        let p = parameters;
        Self {
            half_w: 0.5 * p.w,
            eta: p.eta,
            tilt_product: p.m_t * p.k_t,
            tilt_level_squared: p.m_t * p.m_t,
            tilt_gain_squared: p.k_t * p.k_t,
            eta_t_squared: p.eta_t * p.eta_t,
            damping_tilt: Saturation::new(p.k_omega_t, p.m_omega_t),
            damping_yaw: Saturation::new(p.k_omega_z, p.m_omega_z),
            ease: p.ease,
            inertia: *inertia,
            differences: inertia.zxy() - inertia.yzx(),
        }
    }

    /// Evaluates the law. `error` is the lifted error, of unit length; `angular_velocity` is omega in the body frame; omega_d
    /// and omega_d' are in the axes of the desired body frame.
    #[must_use]
    pub fn torque(
        &self,
        error: &Quaternion<f32>,
        angular_velocity: &Vector3<f32>,
        desired_angular_velocity: &Vector3<f32>,
        desired_angular_acceleration: &Vector3<f32>,
    ) -> AttitudeTorque {
        let rate = rotate_back(error, desired_angular_velocity);
        let acceleration = rotate_back(error, desired_angular_acceleration);
        let feedforward = self.inertia.component_mul(&acceleration)
            + self.differences.component_mul(&rate.yzx()).component_mul(&rate.zxy());
        let angular_velocity_error = angular_velocity - rate;
        let potential = self.potential(error);
        let damping = self.damping(error, &angular_velocity_error);
        let torque = feedforward - potential - damping;
        AttitudeTorque { angular_velocity_error, potential, damping, torque }
    }

    fn potential(&self, error: &Quaternion<f32>) -> Vector3<f32> {
        let (q_0, q_1, q_2, q_3) = (error.w, error.i, error.j, error.k);
        let r_squared = q_1 * q_1 + q_2 * q_2;
        let lifted = q_0 + self.eta;
        let whole = self.half_w / math::sqrt(lifted * lifted + q_3 * q_3);
        // One root for both: sqrt(M_t^2 + k_t^2 r^2) sqrt(1 - r^2 + eta_t^2). 1 - r^2 is q_0^2 + q_3^2, which cannot round below 0.
        let level = self.tilt_level_squared + self.tilt_gain_squared * r_squared;
        let ease = q_0 * q_0 + q_3 * q_3 + self.eta_t_squared;
        let tilt = self.tilt_product / math::sqrt(level * ease);
        let (along, across) = (whole * lifted + tilt * q_0, (whole + tilt) * q_3);
        Vector3::new(along * q_1 + across * q_2, along * q_2 - across * q_1, whole * self.eta * q_3)
    }

    fn damping(&self, error: &Quaternion<f32>, angular_velocity_error: &Vector3<f32>) -> Vector3<f32> {
        let rate = angular_velocity_error;
        let eased = 1.0 - self.ease * (error.i * error.i + error.j * error.j);
        let square = rate.x * rate.x + rate.y * rate.y;
        let tilt = eased * self.damping_tilt.factor(eased * eased * square);
        Vector3::new(rate.x * tilt, rate.y * tilt, rate.z * self.damping_yaw.factor(rate.z * rate.z))
    }
}
