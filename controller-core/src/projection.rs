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
//!
//! The tick has the attitude error at hand: u = |u| R_d e3, so u . R e3 = |u| (R~ e3) . e3 with R~ = R_d^T R, and for a
//! quaternion (w, x, y, z) of any length along R~ that is |u| (1 - 2 (x^2 + y^2) / |q|^2).

use crate::state::length_squared;
use nalgebra::Quaternion;

/// T in N for m |u| in N, the attitude error R~ as a quaternion of any length and the floor in N.
#[inline(always)]
#[must_use]
pub fn projected_thrust(magnitude: f32, error: &Quaternion<f32>, floor: f32) -> f32 {
    let lean = 2.0 / length_squared(error) * (error.i * error.i + error.j * error.j);
    let thrust = magnitude - magnitude * lean;
    if thrust < floor { floor } else { thrust }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attitude_reference::DesiredAttitude;
    use crate::heading::Heading;
    use nalgebra::Vector3;

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

    /// R_d^T R for an R_d that points body z along `u`.
    fn error(u: &Vector3<f32>, q: &Quaternion<f32>) -> Quaternion<f32> {
        DesiredAttitude::new(u, &Heading::FORWARD).error(q)
    }

    #[test]
    fn the_perturbation_is_never_larger_than_the_papers() {
        let floor_acceleration = 7.0; // below the least u_z above
        for seed in 0..100_000 {
            let (u, q) = case(seed);
            let axis = crate::mrp::rotation(&q).column(2).into_owned();
            let ours = axis * projected_thrust(u.norm(), &error(&u, &q), floor_acceleration) - u;
            let paper = axis * u.norm() - u;
            assert!(ours.norm() <= paper.norm() * (1.0 + 1e-5) + 1e-5, "{u} {q}");
        }
    }

    #[test]
    fn above_the_floor_it_is_what_the_force_has_along_the_thrust_axis() {
        for seed in 0..100_000 {
            let (u, q) = case(seed);
            let along = crate::mrp::rotation(&q).column(2).dot(&u);
            assert!((projected_thrust(u.norm(), &error(&u, &q), -100.0) - along).abs() < 2e-5, "{u} {q}");
        }
    }

    #[test]
    fn upside_down_it_commands_the_floor() {
        let inverted = Quaternion::new(0.0, 1.0, 0.0, 0.0);
        assert_eq!(projected_thrust(4.9, &inverted, 1.0), 1.0);
    }
}
