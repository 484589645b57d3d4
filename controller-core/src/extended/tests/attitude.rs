//! The attitude law: the potential, and damping that takes what it leaves.

use super::Random;
use crate::extended::attitude::AttitudeLaw;
use crate::extended::parameters::ExtendedParameters;
use crate::extended::tests::example;
use nalgebra::{Quaternion, Vector3};

/// V less its kinetic part, in double precision, at a unit quaternion.
fn potential_energy(p: &ExtendedParameters, q: &Quaternion<f64>) -> f64 {
    let [w, eta, k_t, m_t, eta_t] = [p.w, p.eta, p.k_t, p.m_t, p.eta_t].map(f64::from);
    let h = ((q.w + eta).powi(2) + q.k * q.k).sqrt();
    let r_squared = q.i * q.i + q.j * q.j;
    // dU/d(r^2) = G, by Simpson's rule.
    let g = |s: f64| m_t * k_t / ((m_t * m_t + k_t * k_t * s) * (1.0 - s + eta_t * eta_t)).sqrt();
    let steps = 400;
    let width = r_squared / f64::from(steps);
    let sum: f64 = (0..steps)
        .map(|i| {
            let left = width * f64::from(i);
            (g(left) + 4.0 * g(left + 0.5 * width) + g(left + width)) * width / 6.0
        })
        .sum();
    w * (1.0 + eta - h) + sum
}

#[test]
fn the_torque_is_the_slope_of_its_potential() {
    let p = example::parameters();
    let law = AttitudeLaw::new(&p, &example::vehicle().inertia);
    let mut random = Random(3);
    for _ in 0..2_000 {
        let q = random.attitude();
        let q = if q.w < 0.0 { -q } else { q };
        let torque = law.feedback(&q, &Vector3::zeros()).potential;
        let double = Quaternion::new(f64::from(q.w), f64::from(q.i), f64::from(q.j), f64::from(q.k));
        let step = 1e-5;
        for axis in 0..3 {
            let mut turn = Vector3::zeros();
            turn[axis] = 1.0;
            let energy = |angle: f64| {
                let turned = double * Quaternion::from_parts((0.5 * angle).cos(), turn * (0.5 * angle).sin());
                potential_energy(&p, &turned)
            };
            let slope = (energy(step) - energy(-step)) / (2.0 * step);
            assert!((f64::from(torque[axis]) - slope).abs() < 4e-6, "{q:?} axis {axis}: {torque} and {slope}");
        }
    }
}

#[test]
fn across_the_switch_the_potential_falls() {
    let p = example::parameters();
    let [w, eta, delta] = [p.w, p.eta, p.delta].map(f64::from);
    let square = (1.0 + delta).powi(2);
    let qbar = (square - 1.0) / (square + 1.0);
    let least = 2.0 * w * eta * qbar / (1.0 + 2.0 * eta * qbar + eta * eta).sqrt();
    let mut random = Random(5);
    for _ in 0..1_000 {
        let v = random.vector(1.0).map(f64::from).normalize() * (1.0 - qbar * qbar).sqrt();
        let before = Quaternion::from_parts(-qbar, v);
        let fall = potential_energy(&p, &before) - potential_energy(&p, &-before);
        assert!(fall >= least * (1.0 - 1e-6), "{fall} {least}");
    }
}

/// The greatest lambda in (0, 1] with |P + lambda D| <= M, in double precision: |P| is below M, so the set of those is
/// an interval from 0.
fn greatest_share(potential: &Vector3<f64>, damping: &Vector3<f64>, most: f64) -> f64 {
    let fits = |share: f64| (potential + damping * share).norm() <= most;
    if fits(1.0) {
        return 1.0;
    }
    let (mut least, mut greatest) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (least + greatest);
        if fits(middle) { least = middle } else { greatest = middle }
    }
    least
}

#[test]
fn damping_gets_all_that_the_potential_leaves_and_yaw_keeps_to_levels_of_its_own() {
    let p = example::parameters();
    let law = AttitudeLaw::new(&p, &example::vehicle().inertia);
    let (mut random, mut shortened, mut nearest) = (Random(4), [0, 0], 0.0_f32);
    for _ in 0..100_000 {
        let q = random.attitude();
        let q = if q.w < -0.0198 { -q } else { q };
        let size = 60.0 * random.signed().abs().powi(3);
        let rate = random.vector(size);
        let feedback = law.feedback(&q, &rate);
        let across = |v: &Vector3<f32>| Vector3::new(v.x, v.y, 0.0).map(f64::from);
        let potential = across(&feedback.potential);
        let eased = (1.0 + f64::from((q.i * q.i + q.j * q.j) / (p.r_0 * p.r_0))).powf(0.25);
        let wanted = across(&rate) * (f64::from(p.k_omega_t) / eased);
        let share = greatest_share(&potential, &wanted, f64::from(p.m_all));
        assert!(share > 0.0);
        let expected = wanted * share;
        let error = (across(&feedback.damping) - expected).norm();
        // Rounding of M_all^2 - |P|^2.
        assert!(error < 1e-5 * f64::from(p.m_all), "{q:?} {rate}: {} and {expected}", feedback.damping);
        assert!(feedback.tilt() <= p.m_all * (1.0 + 1e-5));
        if share < 1.0 {
            shortened[usize::from(potential.dot(&wanted) < 0.0)] += 1;
        }
        assert!(feedback.potential.z.abs() <= 0.5 * p.w * p.eta * (1.0 + 1e-5));
        assert!(feedback.damping.z.abs() <= p.m_omega_z);
        nearest = nearest.max(feedback.potential.z.abs() / (0.5 * p.w * p.eta));
    }
    // Both branches, and the level of yaw.
    assert!(shortened.iter().all(|count| *count > 1_000) && nearest > 0.95, "{shortened:?} {nearest}");
}
