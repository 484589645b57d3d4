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
