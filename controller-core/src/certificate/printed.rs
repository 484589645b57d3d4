//! Lemma 1 and Assumption 1 as printed, with x_f(0) = 0.
//!
//! | paper | equation |
//! |---|---|
//! | U_u' = 2 sqrt(3) k_f U_l M_p + K_j, U_u'' = 2 sqrt(3) k_f M_p (k_f U_l + k_s) + K_s | Lemma 1 |
//! | U_rho' = U_u' / (g - M_p - K_a3), U_rho'' = U_u'' / (g - M_p - K_a3) + 3 U_rho'^2 | Lemma 1 |
//! | U_v' = (U_rho' + K_nu') / L, U_v'' = (U_rho'' + K_nu'' + 2 U_rho' K_nu') / L + 3 U_v'^2 | Lemma 1 |
//! | U_omega = sqrt(U_rho'^2 + U_v'^2), U_omega' = U_rho' U_v' + sqrt(U_rho''^2 + U_v''^2) | Lemma 1 |
//! | L = z / sqrt(z^2 + h^2), z = g - M_p - K_a3, h = sqrt(2) M_p + K_a12 | Lemma 1 |
//!
//! Assumption 1's starred bounds are the same with M_p = 0: the reference alone.

use super::reachable::half_l1_norm;
use super::sharp::{DesiredRates, feedforward_torque};
use crate::math;
use crate::reference::ReferenceBounds;
use nalgebra::Vector3;

/// Lemma 1's bounds for filters of bandwidth `k_f`, `k_s` fed with a feedback of level `m_p`.
#[must_use]
pub fn desired_rates(
    k_f: f64,
    k_s: f64,
    m_p: f64,
    gravity: f64,
    bounds: &ReferenceBounds,
    inertia: &Vector3<f64>,
) -> DesiredRates {
    let half_l1 = half_l1_norm(k_f, k_s);
    let jerk = 2.0 * math::SQRT_3 * k_f * half_l1 * m_p + f64::from(bounds.jerk);
    let snap = 2.0 * math::SQRT_3 * k_f * m_p * (k_f * half_l1 + k_s) + f64::from(bounds.snap);
    let vertical = gravity - m_p - f64::from(bounds.vertical_acceleration);
    let horizontal = core::f64::consts::SQRT_2 * m_p + f64::from(bounds.horizontal_acceleration);
    let projection = vertical / math::hypot(vertical, horizontal);
    let (heading_rate, heading_second) = (f64::from(bounds.heading_rate), f64::from(bounds.heading_second_derivative));

    let rho_1 = jerk / vertical;
    let rho_2 = snap / vertical + 3.0 * rho_1 * rho_1;
    let upsilon_1 = (rho_1 + heading_rate) / projection;
    let upsilon_2 = (rho_2 + heading_second + 2.0 * rho_1 * heading_rate) / projection + 3.0 * upsilon_1 * upsilon_1;
    let angular_velocity = math::hypot(rho_1, upsilon_1);
    let angular_acceleration = rho_1 * upsilon_1 + math::hypot(rho_2, upsilon_2);
    let feedforward_torque = feedforward_torque(inertia, angular_velocity, angular_acceleration);
    DesiredRates { angular_velocity, angular_acceleration, feedforward_torque }
}
