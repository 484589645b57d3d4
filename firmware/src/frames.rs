//! Frames: MAVLink's conventions to the law's and back, used at the edges of the vehicle and nowhere else.
//!
//! | | world | body |
//! |---|---|---|
//! | here | x east, y north, z up (ENU) | x forward, y left, z up (FLU) |
//! | MAVLink | x north, y east, z down (NED) | x forward, y right, z down (FRD) |
//!
//! Turning a vector between the worlds swaps x with y and reverses z; between the bodies it reverses y and z. Both are half
//! turns, so each is its own inverse and one function serves both directions. An attitude R (body to world) becomes
//! W R B, with W and B those two half turns: as quaternions w = (0, 1, 1, 0) / sqrt(2) and b = (0, -1, 0, 0), and w q b
//! has only sums and differences of q's components over sqrt(2).
//!
//! The law itself takes any world with z up; ENU fixes which of its headings MAVLink calls north. A heading psi, counted
//! from x towards y, becomes pi/2 - psi, which is also its own inverse.

use core::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI, TAU};
use nalgebra::{Quaternion, Vector3};

/// A vector of the world: ENU to NED, or NED to ENU.
#[must_use]
pub fn world(v: &Vector3<f32>) -> Vector3<f32> {
    Vector3::new(v.y, v.x, -v.z)
}

/// A vector of the body: FLU to FRD, or FRD to FLU. Angular velocities are vectors like any other here: no mirror is involved.
#[must_use]
pub fn body(v: &Vector3<f32>) -> Vector3<f32> {
    Vector3::new(v.x, -v.y, -v.z)
}

/// An attitude: FLU to ENU becomes FRD to NED, or the other way round. Keeps the length.
#[must_use]
pub fn attitude(q: &Quaternion<f32>) -> Quaternion<f32> {
    Quaternion::new(q.w + q.k, q.i + q.j, q.i - q.j, q.w - q.k) * FRAC_1_SQRT_2
}

/// A heading, rad: counted from x towards y of one world, to the same in the other, within (-pi, pi] for any in [-pi, pi].
#[must_use]
pub fn heading(psi: f32) -> f32 {
    let turned = FRAC_PI_2 - psi;
    if turned > PI { turned - TAU } else { turned }
}

/// A heading's rate, rad/s.
#[must_use]
pub fn heading_rate(rate: f32) -> f32 {
    -rate
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    fn attitudes() -> impl Iterator<Item = UnitQuaternion<f32>> {
        (0..500).map(|k| {
            let k = k as f32;
            UnitQuaternion::from_euler_angles(0.31 * k, 0.17 * k, 0.53 * k)
        })
    }

    #[test]
    fn north_east_and_down_are_where_mavlink_has_them() {
        assert_eq!(world(&Vector3::new(1.0, 2.0, 3.0)), Vector3::new(2.0, 1.0, -3.0));
        assert_eq!(body(&Vector3::new(1.0, 2.0, 3.0)), Vector3::new(1.0, -2.0, -3.0));
    }

    #[test]
    fn vectors_come_back_from_a_round_trip() {
        let v = Vector3::new(0.3, -7.0, 11.0);
        assert_eq!(world(&world(&v)), v);
        assert_eq!(body(&body(&v)), v);
    }

    #[test]
    fn a_vehicle_that_faces_north_has_no_rotation_in_mavlink() {
        let facing_north = UnitQuaternion::from_euler_angles(0.0, 0.0, FRAC_PI_2);
        let q = attitude(&facing_north);
        assert!((q.w.abs() - 1.0).abs() < 1e-6 && q.imag().norm() < 1e-6, "{q}");
    }

    #[test]
    fn a_turned_body_vector_is_the_same_in_both_conventions() {
        let v = Vector3::new(0.4, -0.9, 1.7);
        for q in attitudes() {
            let turned = UnitQuaternion::new_unchecked(attitude(&q)) * body(&v);
            assert!((turned - world(&(q * v))).norm() < 4e-6, "{q}");
        }
    }

    #[test]
    fn an_attitude_comes_back_from_a_round_trip() {
        for q in attitudes() {
            assert!((attitude(&attitude(&q)).coords - q.coords).norm() < 1e-6, "{q}");
        }
    }

    #[test]
    fn a_heading_is_the_yaw_of_the_same_attitude() {
        for k in -31..=31 {
            let psi = 0.1 * k as f32;
            let q = UnitQuaternion::new_unchecked(attitude(&UnitQuaternion::from_euler_angles(0.0, 0.0, psi)));
            let difference = q.euler_angles().2 - heading(psi);
            assert!(difference.sin().abs() < 1e-5 && difference.cos() > 0.0, "{psi} {difference}");
            assert!((-PI..=PI).contains(&heading(psi)));
        }
        assert_eq!(heading_rate(0.5), -0.5);
    }
}
