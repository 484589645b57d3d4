//! Margins: exactly there, and not earlier, an eigenvalue of the written-out loop leaves the unit circle.

use super::common::{IDEAL_TIMING, model, vehicle};
use super::oracle;
use controller_core::gains::GainParameters;
use scenario::sampled_loop::{Axis, Timing};

/// Even numbers in [0, 1) from a fixed seed.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Between `low` and `high`, evenly in the logarithm.
    fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }
}

#[test]
fn stability_ends_at_each_margin_and_holds_short_of_it() {
    let mut random = Random(11);
    let mut checked = [0; 6];
    let mut conditional = 0;
    while checked.iter().any(|count| *count < 100) {
        let timing = Timing {
            period: random.scale(0.001, 0.02),
            rotor_lag: if random.next() < 0.2 { 0.0 } else { random.scale(0.001, 0.05) },
            delay_samples: if random.next() < 0.5 { (3.0 * random.next()).floor() } else { 3.0 * random.next() },
        };
        let frequency = random.scale(1.0, 150.0);
        let inertia = f64::from(vehicle().inertia.x);
        let slow = random.scale(0.3, 10.0);
        let gains = GainParameters {
            k_p: (slow * slow) as f32,
            k_v: (random.scale(0.7, 4.0) * slow) as f32,
            k_f: random.scale(0.5, 300.0) as f32,
            k_s: random.scale(0.5, 300.0) as f32,
            k_theta: (16.0 * inertia * frequency * frequency) as f32,
            k_omega: (2.0 * inertia * frequency * random.scale(0.1, 3.0)) as f32,
            ..GainParameters::TABLE_1
        };
        for (axis, count) in Axis::ALL.into_iter().zip(&mut checked) {
            let Some(margins) = model(gains, timing).report(axis).margins else { continue };
            if *count >= 100 {
                continue;
            }
            *count += 1;
            let with_gain = |factor: f64| oracle::spectral_radius(axis, &gains, timing, factor);
            let with_delay = |extra: f64| {
                let delay_samples = timing.delay_samples + extra / timing.period;
                oracle::spectral_radius(axis, &gains, Timing { delay_samples, ..timing }, 1.0)
            };
            let context = format!("{axis:?} {timing:?} {gains:?} {margins:?}");
            assert!(margins.gain_up > 1.0 && margins.gain_down < 1.0 && margins.delay > 0.0, "{context}");
            // Eigenvalues on the circle are as good as the oracle: 1e-7, see its own comparison.
            if margins.gain_up.is_finite() {
                assert!((with_gain(margins.gain_up) - 1.0).abs() < 1e-7, "up: {context}");
                for part in [0.25, 0.5, 0.75, 0.999] {
                    assert!(with_gain(margins.gain_up.powf(part)) < 1.0, "short of up: {context}");
                }
                assert!(with_gain(margins.gain_up * 1.001) > 1.0, "beyond up: {context}");
            }
            if margins.gain_down > 0.0 {
                conditional += 1;
                assert!((with_gain(margins.gain_down) - 1.0).abs() < 1e-7, "down: {context}");
                for part in [0.25, 0.5, 0.75, 0.999] {
                    assert!(with_gain(margins.gain_down.powf(part)) < 1.0, "short of down: {context}");
                }
                assert!(with_gain(margins.gain_down * 0.999) > 1.0, "beyond down: {context}");
            }
            // Long delay lines make the oracle's matrix large; such margins are checked elsewhere in shorter ones.
            if margins.delay < 30.0 * timing.period {
                assert!((with_delay(margins.delay) - 1.0).abs() < 1e-7, "delay: {context}");
                for part in [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.999] {
                    assert!(with_delay(part * margins.delay) < 1.0, "short of delay, {part}: {context}");
                }
                assert!(with_delay(margins.delay * 1.001) > 1.0, "beyond delay: {context}");
            }
        }
    }
    assert!(conditional > 50, "only {conditional} loops had a lower gain limit");
}

/// The spectral radius with commands that are `extra` s later.
fn delayed(axis: Axis, gains: &GainParameters, timing: Timing, extra: f64) -> f64 {
    let delay_samples = timing.delay_samples + extra / timing.period;
    oracle::spectral_radius(axis, gains, Timing { delay_samples, ..timing }, 1.0)
}

/// The delay margin, s, of a loop that loses its stability there and not before.
fn ends_where_it_says(axis: Axis, gains: GainParameters, timing: Timing) -> f64 {
    let margins = model(gains, timing).report(axis).margins.unwrap();
    let with_delay = |extra: f64| delayed(axis, &gains, timing, extra);
    assert!((with_delay(margins.delay) - 1.0).abs() < 1e-7, "{margins:?}");
    for part in [0.1, 0.3, 0.5, 0.7, 0.9, 0.99] {
        assert!(with_delay(part * margins.delay) < 1.0, "{part} of {margins:?}");
    }
    assert!(with_delay(margins.delay * 1.01) > 1.0, "{margins:?}");
    margins.delay
}

/// A lateral loop whose command changes its sign from tick to tick: slow ticks, and a position law so stiff that what
/// it feeds forward jumps. Part of a sample more turns it over, at the Nyquist frequency and nowhere else.
#[test]
fn delay_that_makes_commands_alternate_ends_the_margin() {
    let gains = GainParameters {
        k_p: 868.0,
        k_v: 99.7,
        k_f: 2.6,
        k_s: 2.74,
        k_theta: 9.2,
        k_omega: 0.0376,
        ..GainParameters::TABLE_1
    };
    for delay_samples in [0.0, 0.55, 0.6] {
        let timing = Timing { period: 0.02, delay_samples, ..IDEAL_TIMING };
        ends_where_it_says(Axis::LateralY, gains, timing);
    }
}

/// A vertical loop at 20 Hz whose commands are 1.5 ticks late: a fraction of a tick more makes a crossing that was not
/// there before.
#[test]
fn a_margin_ends_where_more_delay_makes_a_crossing_of_its_own() {
    let gains = GainParameters {
        k_p: 868.05176,
        k_v: 21.862_217,
        k_f: 2.050_610_8,
        k_s: 2.743_467_8,
        ..GainParameters::TABLE_1
    };
    let timing = Timing { period: 0.05, delay_samples: 1.53125, ..IDEAL_TIMING };
    assert!(delayed(Axis::Vertical, &gains, timing, 0.06) > 1.0);
    assert!(ends_where_it_says(Axis::Vertical, gains, timing) < 0.06);
}

#[test]
fn fast_sampling_gives_the_textbook_margins_of_a_damped_spring() {
    // J s^2 + k_omega s + k_theta / 16: |L| = 1 at w, phase left atan(k_omega w / (k_theta / 16)), half a sample held.
    let timing = Timing { period: 1e-4, ..IDEAL_TIMING };
    let margins = model(GainParameters::TABLE_1, timing).report(Axis::Roll).margins.unwrap();
    let (inertia, k_omega, spring) = (2.24e-3_f64, 0.1_f64, 6.25_f64);
    let squared =
        (k_omega.powi(2) + (k_omega.powi(4) + 4.0 * (spring * inertia).powi(2)).sqrt()) / (2.0 * inertia.powi(2));
    let crossover = squared.sqrt();
    assert!((margins.crossover - crossover).abs() < 1e-4 * crossover, "{margins:?} {crossover}");
    let delay = (k_omega * crossover / spring).atan() / crossover - 0.5 * timing.period;
    assert!((margins.delay - delay).abs() < 1e-4 * delay, "{margins:?} {delay}");
    assert_eq!(margins.gain_down, 0.0);
}

/// Ticks so fast that the position loops are slow beside them.
#[test]
fn faster_ticks_do_not_hide_the_margins_of_slow_loops() {
    // An attitude loop that hardly carries the position loop in front of it.
    let gains = GainParameters { k_theta: 1.2, k_omega: 0.02, ..GainParameters::TABLE_1 };
    let at = |period: f64, axis: Axis| model(gains, Timing { period, ..IDEAL_TIMING }).report(axis).margins.unwrap();
    for axis in [Axis::LateralX, Axis::LateralY, Axis::Vertical] {
        let (slow, fast) = (at(1e-3, axis), at(1e-5, axis));
        for (slow, fast) in
            [(slow.gain_down, fast.gain_down), (slow.delay, fast.delay), (slow.crossover, fast.crossover)]
        {
            assert!((fast - slow).abs() <= 0.05 * slow, "{axis:?}: {slow} and {fast}");
        }
    }
    assert!(at(1e-3, Axis::LateralX).gain_down > 0.1, "no lower limit to hide");
}

#[test]
fn an_unstable_loop_has_no_margins() {
    let report = model(GainParameters::TABLE_1, Timing { delay_samples: 1.0, ..IDEAL_TIMING }).report(Axis::Roll);
    assert!(report.spectral_radius > 1.0 && report.margins.is_none());
}
