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
use crate::math::real::Real;
use crate::reference::ReferenceBounds;
use nalgebra::Vector3;

/// Lemma 1's bounds for filters of bandwidth `k_f`, `k_s` fed with a feedback of level `m_p`.
pub fn desired_rates<R: Real>(
    k_f: R,
    k_s: R,
    m_p: R,
    gravity: R,
    bounds: &ReferenceBounds,
    inertia: &Vector3<R>,
) -> DesiredRates<R> {
    let half_l1 = half_l1_norm(k_f, k_s);
    let [both, all] = [2.0, 3.0].map(|axes| R::from(axes).sqrt());
    let jerk = all * 2.0 * k_f * half_l1 * m_p + R::from(bounds.jerk);
    let snap = all * 2.0 * k_f * m_p * (k_f * half_l1 + k_s) + R::from(bounds.snap);
    let vertical = gravity - m_p - R::from(bounds.vertical_acceleration);
    let horizontal = both * m_p + R::from(bounds.horizontal_acceleration);
    let projection = vertical / vertical.hypot(horizontal);
    let [heading_rate, heading_second] = [bounds.heading_rate, bounds.heading_second_derivative].map(R::from);

    let rho_1 = jerk / vertical;
    let rho_2 = snap / vertical + rho_1 * 3.0 * rho_1;
    let upsilon_1 = (rho_1 + heading_rate) / projection;
    let upsilon_2 = (rho_2 + heading_second + rho_1 * 2.0 * heading_rate) / projection + upsilon_1 * 3.0 * upsilon_1;
    let angular_velocity = rho_1.hypot(upsilon_1);
    let angular_acceleration = rho_1 * upsilon_1 + rho_2.hypot(upsilon_2);
    let feedforward_torque = feedforward_torque(inertia, angular_velocity, angular_acceleration);
    DesiredRates { angular_velocity, angular_acceleration, feedforward_torque }
}
