//! The filters against the specification: lengths, intensities, stationarity at any step, variance, autocorrelation,
//! spectrum.

use super::*;
use std::f64::consts::PI;

fn air(step: f64, seed: u64) -> Turbulence {
    let what = wind::Turbulence { wind_at_20_feet: 10.0, altitude: 30.48, airspeed: 20.0, seed };
    Turbulence::new(&what, &Vector3::new(0.0, 3.0, 0.0), step)
}

/// Components u, v, w, each in the order of time.
fn record(mut air: Turbulence, samples: usize) -> [Vec<f64>; 3] {
    let mut record = [const { Vec::new() }; 3];
    for _ in 0..samples {
        let velocity = air.velocity();
        // The mean wind blows along world y: u is y, v is -x, w is z.
        for (list, value) in record.iter_mut().zip([velocity.y, -velocity.x, velocity.z]) {
            list.push(value);
        }
        air.advance();
    }
    record
}

/// Mean of x_k x_(k + lag).
fn correlation(x: &[f64], lag: usize) -> f64 {
    x.iter().zip(&x[lag..]).map(|(a, b)| a * b).sum::<f64>() / (x.len() - lag) as f64
}

/// sigma, m/s, and T, s, of u (and v) and of w, at 100 feet.
fn specified() -> [(f64, f64); 3] {
    let ground: f64 = 0.177 + 0.000823 * 100.0;
    let horizontal = (1.0 / ground.powf(0.4), 100.0 * 0.3048 / ground.powf(1.2) / 20.0);
    [horizontal, horizontal, (1.0, 30.48 / 20.0)]
}

#[test]
fn variance_and_autocorrelation_are_the_specifications() {
    // 2 million samples of a tenth of w's T: 200,000 independent ones of w, fewer of u and v.
    let step = 0.1524;
    let record = record(air(step, 1), 2_000_000);
    for (index, (x, (sigma, t))) in record.iter().zip(specified()).enumerate() {
        let variance = sigma * sigma;
        for lag in [0, 5, 10, 20, 40, 80] {
            let away = step * lag as f64 / t;
            let shape = if index == 0 { 1.0 } else { 1.0 - 0.5 * away };
            let expected = variance * shape * (-away).exp();
            let found = correlation(x, lag);
            // Five standard deviations of u's estimate, whose samples are the least independent: sqrt(4 T / total
            // time).
            let tolerance = 5.0 * variance * (4.0 * t / (step * x.len() as f64)).sqrt();
            assert!((found - expected).abs() < tolerance, "{index}, lag {lag}: {found} {expected} +- {tolerance}");
        }
    }
    let crossed = record[0].iter().zip(&record[1]).map(|(u, v)| u * v).sum::<f64>() / record[0].len() as f64;
    assert!(crossed.abs() < 0.08, "{crossed}");
}

#[test]
fn the_spectrum_is_the_specifications() {
    // Averaged periodograms of 512 samples: resolved where the spectrum bends, and not yet folded over.
    let (step, length) = (0.1, 512);
    let record = record(air(step, 2), 2000 * length);
    for (index, (x, (sigma, t))) in record.iter().zip(specified()).enumerate() {
        for bin in [8, 16, 32, 64] {
            let omega = 2.0 * PI * f64::from(bin) / (length as f64 * step);
            let power = |block: &[f64]| {
                let phase = |k: usize| omega * step * k as f64;
                // Hann's window: what leaks from the peak at zero would hide the slope.
                let window = |k: usize| (PI * k as f64 / length as f64).sin().powi(2);
                let (re, im) = block.iter().enumerate().fold((0.0, 0.0), |(re, im), (k, x)| {
                    (re + window(k) * x * phase(k).cos(), im + window(k) * x * phase(k).sin())
                });
                // Two-sided, over rad/s: the integral over all omega is the variance.
                (re * re + im * im) * step / (0.375 * length as f64) / (2.0 * PI)
            };
            let found = x.chunks_exact(length).map(power).sum::<f64>() / 2000.0;
            let w = (t * omega).powi(2);
            let shape = if index == 0 { 2.0 / (1.0 + w) } else { (1.0 + 3.0 * w) / (1.0 + w).powi(2) };
            let expected = sigma * sigma * t / (2.0 * PI) * shape;
            // Five standard deviations of 2000 averages are 11 %.
            assert!((found / expected - 1.0).abs() < 0.12, "{index}, {omega} rad/s: {found} {expected}");
        }
    }
}

#[test]
fn a_step_of_any_length_leaves_the_distribution_as_it_was() {
    // Phi Phi' + chol chol' = I, and many short steps make a long one.
    for a in [1e-6, 1e-4, 0.01, 0.3, 0.49, 0.5, 0.51, 2.0, 30.0] {
        let (l_11, l_21, l_22) = noise_of(a);
        let decay = (-a).exp();
        let (p, q) = (((1.0 + a) * decay, a * decay), (-a * decay, (1.0 - a) * decay));
        let first = p.0 * p.0 + p.1 * p.1 + l_11 * l_11;
        let mixed = p.0 * q.0 + p.1 * q.1 + l_11 * l_21;
        let second = q.0 * q.0 + q.1 * q.1 + l_21 * l_21 + l_22 * l_22;
        assert!((first - 1.0).abs() < 1e-14 && mixed.abs() < 1e-14 && (second - 1.0).abs() < 1e-14, "{a}");
    }
    // Of short steps the noise itself is right, not only what rounding leaves of the sum: q_11 = 4/3 a^3.
    let (l_11, _, l_22) = noise_of(1e-5);
    assert!((l_11 * l_11 / (4.0 / 3.0 * 1e-15) - 1.0).abs() < 1e-4 && (l_22 * l_22 / 1e-5 - 1.0).abs() < 1e-4);
}

#[test]
fn it_is_the_same_from_the_same_seed_and_another_from_another() {
    let first = |seed| record(air(0.01, seed), 10);
    assert_eq!(first(3), first(3));
    assert_ne!(first(3), first(4));
}

#[test]
fn it_starts_as_strong_as_it_goes_on() {
    // Over many seeds the first sample has the variance of all others.
    let starts: Vec<Vector3<f64>> = (0..20_000).map(|seed| air(0.001, seed).velocity()).collect();
    for (index, (sigma, _)) in [(1, specified()[0]), (0, specified()[1]), (2, specified()[2])] {
        let variance = starts.iter().map(|v| v[index] * v[index]).sum::<f64>() / starts.len() as f64;
        // Five standard deviations: 5 sqrt(2 / 20,000).
        assert!((variance / (sigma * sigma) - 1.0).abs() < 0.05, "{index}: {variance}");
    }
}
