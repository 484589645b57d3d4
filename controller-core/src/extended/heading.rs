//! The heading: yaw takes what tilt and thrust leave. Section 5 of `docs/extended-law.md`.
//!
//! R_d is the paper's frame, which turns with omega_d = omega_rho + w_3 rho; f = R~^T omega_d. q is the lifted error.
//!
//! | here | equation |
//! |---|---|
//! | psi | 2 q_3: the angle about the body's z, from the desired heading, for small ones |
//! | v(psi) | k psi / sqrt(1 + \|psi\| k^2 / (2 A) + (k psi / W_max)^2), k = c_1 / c_2: the rate at which psi comes to zero; it can be braked with A |
//! | y | (R~^T omega_d')_3 - (omega x f)_3 - c_2 (omega_3 - f_3 + v(psi)): the wanted angular acceleration |
//! | `torque` | J_3 y - (J_1 - J_2) omega_1 omega_2, less the bias: what yaw asks for |
//!
//! What it gets is between the ends that tilt and thrust leave ([`super::thrust_range`]). To brake a spin, a rate error
//! above W_max, it has J_3 A before thrust ([`HeadingLaw::braking`]): a spin ends under full thrust as well. A heading
//! that merely lags costs no thrust. The tilt's feedback does not know yaw, so that nothing else depends on what it
//! gets.

use super::parameters::ExtendedParameters;
use crate::error::{ParameterError, Reason, require};
use crate::math;
use nalgebra::Vector3;

/// Checks the gains for ticks `period` seconds apart. In samples, small psi follow
/// z^2 - (2 - h c_2) z + 1 - h c_2 + h^2 c_1, whose roots are inside the unit circle if h c_1 < c_2 and
/// 2 h c_2 < 4 + h^2 c_1. The law requires half of either.
///
/// # Errors
/// Names `gains.c_1` or `gains.c_2`.
pub fn check(parameters: &ExtendedParameters, period: f32) -> Result<(), ParameterError> {
    let ExtendedParameters { c_1, c_2, .. } = *parameters;
    require(c_2 * period <= 1.0, "gains.c_2", Reason::Above(1.0 / period))?;
    let max = 0.5 * c_2 / period;
    require(c_1 <= max, "gains.c_1", Reason::Above(max))
}

/// The part of the torque at hand that a turn is to be braked with.
const BRAKED_SHARE: f32 = 0.7;

/// The heading law's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeadingLaw {
    /// c_2, 1/s.
    damping: f32,
    /// c_1 / c_2, 1/s.
    approach: f32,
    /// k^2 / 2, 1/s^2, and k^2 / W_max^2.
    braking: f32,
    cruising: f32,
    /// 1 / W_max, s.
    per_spin: f32,
    /// A, rad/s^2.
    acceleration: f32,
    inertia: f32,
    /// J_1 - J_2, kg m^2.
    difference: f32,
}

impl HeadingLaw {
    /// For the diagonal of J, kg m^2.
    pub fn new(parameters: &ExtendedParameters, inertia: &Vector3<f32>) -> Self {
        let p = parameters;
        let k = p.c_1 / p.c_2;
        Self {
            damping: p.c_2,
            approach: k,
            braking: 0.5 * k * k,
            acceleration: p.yaw_acceleration,
            per_spin: 1.0 / p.yaw_rate,
            cruising: (k / p.yaw_rate) * (k / p.yaw_rate),
            inertia: inertia.z,
            difference: inertia.x - inertia.y,
        }
    }

    /// The acceleration fed forward, rad/s^2: `rate` is f, `acceleration` (R~^T omega_d')_3, `velocity` omega.
    #[inline(always)]
    pub fn forward(&self, rate: &Vector3<f32>, acceleration: f32, velocity: &Vector3<f32>) -> f32 {
        acceleration - (velocity.x * rate.y - velocity.y * rate.x)
    }

    /// The wanted yaw torque beside the bias, N m: for psi and omega_3 - f_3, both projected, the acceleration fed
    /// forward and omega.
    #[inline(always)]
    pub fn torque(&self, angle: f32, rate_error: f32, forward: f32, velocity: &Vector3<f32>, room: f32) -> f32 {
        let braked = math::max(BRAKED_SHARE * room, self.acceleration * self.inertia);
        let braking = self.braking * self.inertia / braked;
        let slowed = math::sqrt(1.0 + angle.abs() * braking + angle * angle * self.cruising);
        let wanted = forward - self.damping * (rate_error + self.approach * angle / slowed);
        self.inertia * wanted - self.difference * velocity.x * velocity.y
    }

    /// The part of a yaw `torque` that comes before thrust, N m: what brakes omega_3 - f_3 where that is above W_max,
    /// up to a part of J_3 A that is all of it from 2 W_max on.
    #[inline(always)]
    pub fn braking(&self, torque: f32, rate_error: f32) -> f32 {
        let spin = math::clamp(rate_error.abs() * self.per_spin - 1.0, 0.0, 1.0);
        if torque * rate_error < 0.0 { math::saturate(torque, spin * self.inertia * self.acceleration) } else { 0.0 }
    }
}
