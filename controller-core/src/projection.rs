//! The thrust projection, an option: T = max(m u . R e3, floor). Off, the paper's law T = m |u| flies.
//!
//! T = m |u| pulls at full strength wherever body z points; upside down it pulls the vehicle into the ground. The
//! projection commands what the desired force has along the thrust axis b = R e3, but never less than a floor > 0.
//!
//! Why Theorem 3 still holds when floor <= m (g - M_p - K_a3). The theorem needs the perturbation d = b T / m - u only
//! through a bound that the paper's own d_0 = b |u| - u meets. With c the cosine between b and u:
//!
//! - above the floor, |d|^2 = |u|^2 (1 - c^2) <= 2 |u|^2 (1 - c) = |d_0|^2, because 1 + c <= 2;
//! - at the floor f = floor / m, which acts while |u| c < f: |d_0|^2 - |d|^2 = (|u| - f)(|u| + f - 2 |u| c). Both
//!   factors are not negative, since f <= u_z <= |u| and 2 |u| c < 2 f.
//!
//! So |d| <= |d_0| at every attitude, and T is Lipschitz in the state: the perturbation stays square-integrable, with
//! the same bound. (The theorem's own constants are not those in print: section 12 of `docs/extended-law.md`.) T <= m
//! |u| as well, so the thrust interval becomes [floor, T_max].
//!
//! The tick has the attitude error at hand: u = |u| R_d e3, so u . R e3 = |u| (R~ e3) . e3 with R~ = R_d^T R, and for a
//! quaternion (w, x, y, z) of any length along R~ that is |u| (1 - 2 (x^2 + y^2) / |q|^2).

use crate::state::length_squared;
use nalgebra::Quaternion;

/// T in N for m |u| in N, the attitude error R~ as a quaternion of any length and the floor in N.
#[inline(always)]
pub fn projected_thrust(magnitude: f32, error: &Quaternion<f32>, floor: f32) -> f32 {
    let lean = 2.0 / length_squared(error) * (error.i * error.i + error.j * error.j);
    let thrust = magnitude - magnitude * lean;
    if thrust < floor { floor } else { thrust }
}

#[cfg(test)]
mod tests;
