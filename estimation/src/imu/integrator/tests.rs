extern crate std;
use super::*;
use nalgebra::UnitQuaternion;
use std::f64::consts::TAU;
use std::vec::Vec;

/// Increments of exact samples at 1 kHz.
fn increments(seconds: f64, mut at: impl FnMut(f64) -> (Vector3<f64>, Vector3<f64>)) -> Vec<Increment> {
    let mut integrator = Integrator::EMPTY;
    let mut all = Vec::new();
    for n in 0..=(seconds * 1e3) as u64 {
        let (rate, force) = at(n as f64 * 1e-3);
        let (rate, force) = (rate.map(|x| x as f32), force.map(|x| x as f32));
        let sample = Sample { time: n * 1_000, rate, force: Some(force), clipped: Clipped::NEITHER };
        if n == 0 {
            integrator.begin(&sample);
        } else {
            all.extend(integrator.take(&sample, 5_000));
        }
    }
    all
}

/// All turns after one another.
fn turned(increments: &[Increment]) -> UnitQuaternion<f64> {
    let turn = |all, one: &Increment| all * UnitQuaternion::from_scaled_axis(one.delta_angle.cast::<f64>());
    increments.iter().fold(UnitQuaternion::identity(), turn)
}

/// A body that cones: q = exp(a (cos wt, sin wt, 0)); its rate from the quaternion's derivative.
fn cone(t: f64) -> (UnitQuaternion<f64>, Vector3<f64>) {
    let (a, w) = (3.0_f64.to_radians(), 50.0 * TAU);
    let at = |t: f64| UnitQuaternion::from_scaled_axis(Vector3::new((w * t).cos(), (w * t).sin(), 0.0) * a);
    let h = 1e-6;
    (at(t), (at(t - h).inverse() * at(t + h)).scaled_axis() / (2.0 * h))
}

#[test]
fn a_cone_turns_less_than_a_degree_a_second_falsely() {
    let all = increments(1.0, |t| (cone(t).1, Vector3::zeros()));
    let truth = cone(0.0).0.inverse() * cone(1.0).0;
    let drift = (truth.inverse() * turned(&all)).angle().to_degrees();
    // The sum of the rates alone: what is left out is phi x alpha.
    let mut plain = Vec::new();
    for chunk in (0..1000_u64).collect::<Vec<_>>().chunks(5) {
        let sum: Vector3<f64> =
            chunk.iter().map(|&n| (cone(n as f64 * 1e-3).1 + cone((n + 1) as f64 * 1e-3).1) * 0.5e-3).sum();
        plain.push(sum);
    }
    let plain = plain.iter().fold(UnitQuaternion::identity(), |q, x| q * UnitQuaternion::from_scaled_axis(*x));
    let plain = (truth.inverse() * plain).angle().to_degrees();
    std::println!("coning: {drift:.2} deg/s; without the product {plain:.2} deg/s");
    assert!(drift < 0.85 && plain > 9.0, "{drift} {plain}");
}

#[test]
fn a_fast_turn_brings_the_force_into_the_frame_at_the_start() {
    // At 20 rad/s about x a force along the body's z swings by 0.1 rad in 5 ms.
    let (rate, force) = (Vector3::new(20.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 15.0));
    let all = increments(0.05, |_| (rate, force));
    assert_eq!(all.len(), 10);
    let angle = 20.0 * 0.005_f64;
    let exact = Vector3::new(0.0, -15.0 * (1.0 - angle.cos()) / 20.0, 15.0 * angle.sin() / 20.0);
    for increment in &all {
        assert!((increment.delta_velocity.cast::<f64>() - exact).norm() < 2e-4, "{increment:?} {exact}");
        assert!((increment.delta_angle.cast::<f64>() - Vector3::new(angle, 0.0, 0.0)).norm() < 1e-6);
        assert_eq!(increment.end - increment.start, 5_000);
    }
}

#[test]
fn a_force_that_is_missing_is_the_last_one() {
    let mut integrator = Integrator::EMPTY;
    let (zero, force) = (Vector3::zeros(), Vector3::new(0.0, 0.0, 9.81_f32));
    let sample = |n: u64, force| Sample { time: n * 1_000, rate: zero, force, clipped: Clipped::NEITHER };
    integrator.begin(&sample(0, Some(force)));
    let all: Vec<Increment> = (1..=5).filter_map(|n| integrator.take(&sample(n, None), 5_000)).collect();
    assert_eq!(all.len(), 1);
    assert!((all[0].delta_velocity - force * 0.005).norm() < 1e-7);
}
