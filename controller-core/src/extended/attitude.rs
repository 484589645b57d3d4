//! The attitude law with separate levels for tilt and yaw. Section 6 of `docs/extended-law.md`.
//!
//! With the lifted error q = m* Phi(q_hat, R~) = (q_0, q_1, q_2, q_3), r^2 = q_1^2 + q_2^2 and
//! h = sqrt((q_0 + eta)^2 + q_3^2):
//!
//! | here | equation |
//! |---|---|
//! | V | 1/2 omega~^T J omega~ + w (1 + eta - h) + U_t(r), dU_t/dr = 2 r G(r) |
//! | G(r) | M_t k_t / (sqrt(M_t^2 + k_t^2 r^2) sqrt(1 - r^2 + eta_t^2)) |
//! | `potential` | (w / 2h) ((q_0 + eta) q_1 + q_2 q_3, (q_0 + eta) q_2 - q_1 q_3, eta q_3) + G (q_0 q_1 + q_2 q_3, q_0 q_2 - q_1 q_3, 0) |
//! | `damping` = lambda D | D = k_omega_t omega~_12 / (1 + (r / r_0)^2)^(1/4), lambda below; a number (k_omega_z, M_omega_z) about z |
//! | lambda | the greatest in (0, 1] with \|P + lambda D\| <= M_all, P the potential's part about the tilt's axes |
//! | `torque` | -potential - damping + J R~^T omega_d' - \[J R~^T omega_d\]x R~^T omega_d |
//!
//! Then V' = -omega~ . damping <= 0 for any J and omega_d, and V falls across the switch to the shadow, where U_t does
//! not change. With room = M_all^2 - |P|^2, which the certificate keeps positive,
//!
//! ```text
//! lambda = 1 if |D|^2 + 2 P.D <= room,
//! else room / (sqrt((P.D)^2 + |D|^2 room) + P.D), or the conjugate of that fraction where P.D < 0.
//! ```
//!
//! **Actuators that are late.** With the lag and the delay together T and the angular impulse I that commands of the
//! past will still deliver, the law is evaluated for the errors projected over T ([`Late`]),
//!
//! q_p = q (1, T omega~ / 2),   omega_p = omega~ + J^-1 (I + T tau_b) - T R~^T omega_d':
//!
//! with a first-order lag and small motions omega_p' is the commanded acceleration and the projected angle's rate is
//! omega_p, as if the actuators were ideal. The paper's z_1 and z_2 do the same for its filters. Every bound holds for
//! any errors, so also for projected ones. Torques in the body frame, N m.

use super::parameters::ExtendedParameters;
use super::saturation::Saturation;
use crate::math;
use core::hint::cold_path;
use nalgebra::{Quaternion, Vector2, Vector3};

/// The feedback and the terms it is made of, body frame, N m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttitudeFeedback {
    /// The potential's torque with its sign turned.
    pub potential: Vector3<f32>,
    /// The damping, with lambda.
    pub damping: Vector3<f32>,
}

impl AttitudeFeedback {
    /// |P + lambda D|, N m: at most M_all.
    #[must_use]
    pub fn tilt(&self) -> f32 {
        math::sqrt((self.potential.xy() + self.damping.xy()).norm_squared())
    }
}

/// The part of past commands that has not acted yet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Late {
    /// T, s: lag and delay together.
    pub time: f32,
    /// I + T tau_b, N m s, body frame.
    pub impulse: Vector3<f32>,
    /// R~^T omega_d' of the last tick, rad/s^2.
    pub wanted: Vector3<f32>,
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
    /// k_omega_t, N m s, and 1 / r_0^2.
    tilt_damping: f32,
    easing: f32,
    damping_yaw: Saturation,
    /// M_all^2, N^2 m^2.
    feedback_squared: f32,
    /// The diagonal of J, kg m^2.
    inertia: Vector3<f32>,
    /// (J_z - J_y, J_x - J_z, J_y - J_x), kg m^2.
    differences: Vector3<f32>,
    per_inertia: Vector3<f32>,
}

impl AttitudeLaw {
    /// For the diagonal of J, kg m^2.
    #[must_use]
    pub fn new(parameters: &ExtendedParameters, inertia: &Vector3<f32>) -> Self {
        let p = parameters;
        Self {
            half_w: 0.5 * p.w,
            eta: p.eta,
            tilt_product: p.m_t * p.k_t,
            tilt_level_squared: p.m_t * p.m_t,
            tilt_gain_squared: p.k_t * p.k_t,
            eta_t_squared: p.eta_t * p.eta_t,
            tilt_damping: p.k_omega_t,
            easing: 1.0 / (p.r_0 * p.r_0),
            damping_yaw: Saturation::new(p.k_omega_z, p.m_omega_z),
            feedback_squared: p.m_all * p.m_all,
            per_inertia: inertia.map(|moment| 1.0 / moment),
            inertia: *inertia,
            differences: inertia.zxy() - inertia.yzx(),
        }
    }

    /// The errors as they will be once `late` has arrived: q_p, of any length, and omega_p.
    #[must_use]
    pub fn projected(
        &self,
        error: &Quaternion<f32>,
        rate_error: &Vector3<f32>,
        late: &Late,
    ) -> (Quaternion<f32>, Vector3<f32>) {
        let Late { time, impulse, wanted } = late;
        let half = rate_error * (0.5 * time);
        let (w, v) = (error.w, error.imag());
        let turned = v + half * w + v.cross(&half);
        let quaternion = Quaternion::new(w - v.dot(&half), turned.x, turned.y, turned.z);
        (quaternion, rate_error + self.per_inertia.component_mul(impulse) - wanted * *time)
    }

    /// P and the damping, for the lifted error, of unit length, and omega~.
    #[must_use]
    #[inline(always)] // see position.rs
    pub fn feedback(&self, error: &Quaternion<f32>, rate_error: &Vector3<f32>) -> AttitudeFeedback {
        let potential = self.potential(error);
        let r_squared = error.i * error.i + error.j * error.j;
        let eased = 1.0 + r_squared * self.easing;
        let wanted = rate_error.xy() * (self.tilt_damping / math::sqrt(math::sqrt(eased)));
        let about = self.damping_yaw.factor(rate_error.z * rate_error.z) * rate_error.z;
        let tilt = wanted * self.share(&potential, &wanted);
        AttitudeFeedback { potential, damping: Vector3::new(tilt.x, tilt.y, about) }
    }

    /// lambda.
    fn share(&self, potential: &Vector3<f32>, damping: &Vector2<f32>) -> f32 {
        let room = self.feedback_squared - potential.xy().norm_squared();
        let (along, square) = (potential.xy().dot(damping), damping.norm_squared());
        if square + 2.0 * along <= room {
            return 1.0;
        }
        cold_path();
        let room = math::greater(room, 0.0);
        let root = math::sqrt(along * along + square * room);
        if along > 0.0 { room / (root + along) } else { (root - along) / square }
    }

    /// tau: J R~^T omega_d' - \[J R~^T omega_d\]x R~^T omega_d less the feedback. `rate` and `acceleration` are R~^T
    /// omega_d and R~^T omega_d'.
    #[must_use]
    pub fn torque(
        &self,
        feedback: &AttitudeFeedback,
        rate: &Vector3<f32>,
        acceleration: &Vector3<f32>,
    ) -> Vector3<f32> {
        self.inertia.component_mul(acceleration)
            + self.differences.component_mul(&rate.yzx()).component_mul(&rate.zxy())
            - feedback.potential
            - feedback.damping
    }

    fn potential(&self, error: &Quaternion<f32>) -> Vector3<f32> {
        let (q_0, q_1, q_2, q_3) = (error.w, error.i, error.j, error.k);
        let r_squared = q_1 * q_1 + q_2 * q_2;
        let lifted = q_0 + self.eta;
        let whole = self.half_w / math::sqrt(lifted * lifted + q_3 * q_3);
        // One root for both: sqrt(M_t^2 + k_t^2 r^2) sqrt(1 - r^2 + eta_t^2). 1 - r^2 is q_0^2 + q_3^2, which cannot
        // round below 0.
        let level = self.tilt_level_squared + self.tilt_gain_squared * r_squared;
        let ease = q_0 * q_0 + q_3 * q_3 + self.eta_t_squared;
        let tilt = self.tilt_product / math::sqrt(level * ease);
        let (along, across) = (whole * lifted + tilt * q_0, (whole + tilt) * q_3);
        Vector3::new(along * q_1 + across * q_2, along * q_2 - across * q_1, whole * self.eta * q_3)
    }
}
