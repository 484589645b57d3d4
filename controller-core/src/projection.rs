//! The thrust projection, an option: T = max(m u . R e3, floor). Off, the paper's law T = m |u| flies.
//!
//! T = m |u| pulls at full strength wherever body z points; upside down it pulls the vehicle into the ground. The
//! projection commands what the desired force has along the thrust axis b = R e3, but never less than a floor > 0.
//!
//! Why Theorem 3 still holds when floor <= m (g - M_p - K_a3). The theorem needs the perturbation d = b T / m - u only
//! through a bound that the paper's own d_0 = b |u| - u meets. With c the cosine between b and u:
//!
//! - above the floor, |d|^2 = |u|^2 (1 - c^2) <= 2 |u|^2 (1 - c) = |d_0|^2, because 1 + c <= 2;
//! - at the floor f = floor / m, which acts while |u| c < f: |d_0|^2 - |d|^2 = (|u| - f)(|u| + f - 2 |u| c). Both factors are
//!   not negative, since f <= u_z <= |u| and 2 |u| c < 2 f.
//!
//! So |d| <= |d_0| at every attitude, and T is Lipschitz in the state: the perturbation stays square-integrable with the
//! paper's constants. T <= m |u| as well, so the thrust interval becomes [floor, T_max].

use crate::state::length_squared;
use nalgebra::{Quaternion, Vector3};

/// T in N for u (world, m/s^2), the vehicle's attitude q (body to world, of any length), its mass in kg and the floor in N.
///
/// R e3 = e3 + 2/|q|^2 (x z + w y, y z - w x, -(x^2 + y^2)).
#[inline(always)]
#[must_use]
pub fn projected_thrust(mass: f32, command: &Vector3<f32>, attitude: &Quaternion<f32>, floor: f32) -> f32 {
    let Quaternion { coords } = attitude;
    let (x, y, z, w) = (coords.x, coords.y, coords.z, coords.w);
    let lean = command.x * (x * z + w * y) + command.y * (y * z - w * x) - command.z * (x * x + y * y);
    let thrust = mass * (command.z + 2.0 / length_squared(attitude) * lean);
    if thrust < floor { floor } else { thrust }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(seed: u32) -> (Vector3<f32>, Quaternion<f32>) {
        let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(1);
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            state as f32 / u32::MAX as f32 * 2.0 - 1.0
        };
        let u = Vector3::new(3.0 * next(), 3.0 * next(), 10.0 + 2.0 * next());
        let q = Quaternion::new(next(), next(), next(), next());
        (u, q / q.norm())
    }

    #[test]
    fn the_perturbation_is_never_larger_than_the_papers() {
        let floor_acceleration = 7.0; // below the least u_z above
        for seed in 0..100_000 {
            let (u, q) = case(seed);
            let axis = crate::mrp::rotation(&q).column(2).into_owned();
            let ours = axis * projected_thrust(1.0, &u, &q, floor_acceleration) - u;
            let paper = axis * u.norm() - u;
            assert!(ours.norm() <= paper.norm() * (1.0 + 1e-5) + 1e-5, "{u} {q}");
        }
    }

    #[test]
    fn upside_down_it_commands_the_floor() {
        let inverted = Quaternion::new(0.0, 1.0, 0.0, 0.0);
        assert_eq!(projected_thrust(0.5, &Vector3::new(0.0, 0.0, 9.81), &inverted, 1.0), 1.0);
    }
}
