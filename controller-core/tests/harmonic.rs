//! The harmonic reference: its phase after a month, its derivatives, and its bounds.

use crate::support::{Random, bounds, demands, derivatives, psi, slope, turn};
use controller_core::error::Reason;
use controller_core::reference::Trajectory;
use controller_core::reference::harmonic::{Harmonic, HarmonicParameters, HeadingParameters};
use core::f64::consts::{PI, SQRT_2, TAU};

const THIRTY_DAYS_US: u64 = 30 * 24 * 3600 * 1_000_000;

/// The contract's scenario file, digit for digit.
#[expect(clippy::approx_constant, reason = "the file's own numbers are what is flown")]
fn paper() -> HarmonicParameters {
    HarmonicParameters {
        center: [-3.0, 1.0, 4.5],
        amplitude: [1.0; 3],
        frequency: [0.41887902; 3],
        phase: [0.0, -1.57079633, 0.0],
        heading: HeadingParameters { offset: 0.0, rate: 0.0, amplitude: 3.14159265, frequency: 0.41887902 },
    }
}

/// Frequencies of both signs; `shared` ones or one for each axis.
fn random(random: &mut Random, shared: bool) -> HarmonicParameters {
    let f = random.magnitude(0.1, 40.0);
    let mut frequency = || random.magnitude(0.1, 40.0) * if random.within(-1.0, 1.0) < 0.0 { -1.0 } else { 1.0 };
    let frequency = if shared { [f, -f, f] } else { [frequency(), frequency(), frequency()] };
    let mut uniform = |size: f64| random.within(-size, size);
    HarmonicParameters {
        center: [uniform(5.0), uniform(5.0), uniform(5.0)],
        // Keeps snap below 2e5 m/s^4 at 40 rad/s.
        amplitude: [uniform(0.1), uniform(0.1), uniform(0.1)],
        frequency,
        phase: [uniform(10.0), uniform(10.0), uniform(10.0)],
        heading: HeadingParameters {
            offset: uniform(10.0),
            rate: uniform(10.0),
            amplitude: uniform(4.0),
            frequency: uniform(20.0),
        },
    }
}

/// rate * time + offset modulo 2 pi, in integers of 2^-70 rad: off by at most 3e-8 rad up to 100 rad/s and 30 days.
fn phase_in_integers(rate: f64, time_us: u64, offset: f64) -> f64 {
    /// 2 pi * 2^70, rounded.
    const TURN: i128 = 7_417_875_925_070_973_790_602;
    let bits = rate.abs().to_bits();
    let mantissa = i128::from(bits & ((1 << 52) - 1) | 1 << 52);
    let exponent = (bits >> 52) as i32 - 1075 + 70;
    let product = mantissa * i128::from(time_us);
    let angle =
        if exponent >= 0 { (product << exponent) / 1_000_000 } else { (product / 1_000_000) >> (-exponent).min(127) };
    let angle = if rate < 0.0 { -angle } else { angle };
    (angle.rem_euclid(TURN) as f64 / TURN as f64 * TAU + offset).rem_euclid(TAU)
}

fn radians(phase: u64) -> f64 {
    phase as f64 / 18_446_744_073_709_551_616.0 * TAU
}

#[test]
fn after_thirty_days_every_phase_is_omega_t_plus_phi_within_1e_5_rad() {
    let mut generator = Random(1);
    let mut worst = [0.0_f64; 3];
    for case in 0..3000 {
        let parameters = if case == 0 { paper() } else { random(&mut generator, false) };
        let harmonic = Harmonic::new(parameters).unwrap();
        let HarmonicParameters { center, amplitude, frequency, phase, heading } = parameters;
        let time = THIRTY_DAYS_US + generator.bits() % 1_000_000_000;
        let reference = harmonic.at(time);
        for axis in 0..3 {
            let expected = phase_in_integers(frequency[axis], time, phase[axis]);
            worst[0] = worst[0].max(turn(radians(harmonic.axis_phases(time)[axis]), expected).abs());
            // What is flown shows it too: rounding of the center, the amplitude and the cosine aside.
            let error = f64::from(reference.position[axis]) - center[axis] - amplitude[axis] * expected.cos();
            assert!(error.abs() < amplitude[axis].abs() * 1e-5 + center[axis].abs() * 1.2e-7 + 1e-7);
        }
        let turned = phase_in_integers(heading.rate, time, heading.offset);
        let swung = phase_in_integers(heading.frequency, time, 0.0);
        worst[1] = worst[1].max(turn(radians(harmonic.turn_phase(time)), turned).abs());
        worst[1] = worst[1].max(turn(radians(harmonic.swing_phase(time)), swung).abs());
        // The swing itself adds 3e-7 of its amplitude, and 1e-6 of it per 1e-6 rad of its phase.
        let error = turn(psi(&reference), turned + heading.amplitude * swung.sin()).abs();
        worst[2] = worst[2].max(error);
    }
    assert!(worst[0] < 1e-5 && worst[1] < 1e-5 && worst[2] < 1e-5, "{worst:?}");
    // And as good as the phase's rounding allows: 4.5e-7 rad from the rate, f64's roundings, and the check's own.
    assert!(worst[0] < 7e-7 && worst[1] < 7e-7, "{worst:?}");
}

#[test]
fn a_swing_of_many_turns_keeps_its_stated_accuracy() {
    let mut parameters = paper();
    parameters.heading = HeadingParameters { offset: 1.0, rate: 0.5, amplitude: 100.0, frequency: 0.3 };
    let harmonic = Harmonic::new(parameters).unwrap();
    let mut worst: f64 = 0.0;
    for i in 0..10_000_u64 {
        let time = i * 12_345;
        let t = time as f64 * 1e-6;
        worst = worst.max(turn(psi(&harmonic.at(time)), 1.0 + 0.5 * t + 100.0 * (0.3 * t).sin()).abs());
    }
    assert!(worst < 3e-5, "{worst:e}");
}

#[test]
fn the_papers_reference_has_the_papers_bounds() {
    let f: f64 = 0.41887902;
    let found = bounds(&Harmonic::new(paper()).unwrap().bounds());
    let expected = [f * f, f * f, SQRT_2 * f.powi(3), SQRT_2 * f.powi(4), PI * f, (PI * f) * (PI * f)];
    for (found, expected) in found.into_iter().zip(expected) {
        // Nothing below but the file's pi and pi/2, rounded to nine digits.
        assert!(found > expected * (1.0 - 4e-9) && found < expected * (1.0 + 3e-6), "{found} for {expected}");
    }
}

#[test]
fn a_heading_that_only_swings_is_bounded_by_its_larger_extreme() {
    for (b, w) in [(PI, 0.4), (0.5, 2.0), (2.0, 2.0), (1.0, 1.0), (1.0001, 1.0), (0.01, 30.0)] {
        let mut parameters = paper();
        parameters.heading = HeadingParameters { offset: 0.0, rate: 0.0, amplitude: b, frequency: w };
        let found = f64::from(Harmonic::new(parameters).unwrap().bounds().heading_second_derivative);
        let expected = (b * w * w).max(b * b * w * w);
        assert!(found >= expected && found < expected * (1.0 + 3e-6), "{found} for {expected}");
    }
}

#[test]
fn bounds_hold_at_every_instant_and_are_attained() {
    let mut generator = Random(2);
    for case in 0..600 {
        let harmonic = Harmonic::new(random(&mut generator, case % 2 == 0)).unwrap();
        let bounds = bounds(&harmonic.bounds());
        let mut largest = [0.0_f64; 6];
        // Random instants in a month reach all combinations of the phases, however many frequencies there are.
        for _ in 0..20_000 {
            let found = demands(&harmonic.at(generator.bits() % THIRTY_DAYS_US));
            largest.iter_mut().zip(found).for_each(|(largest, found)| *largest = largest.max(found));
        }
        for (i, (bound, largest)) in bounds.into_iter().zip(largest).enumerate() {
            assert!(largest <= bound, "case {case}, bound {i}: {largest} above {bound}");
            assert!(largest > 0.97 * bound, "case {case}, bound {i}: {largest} of {bound}");
        }
    }
}

#[test]
fn axes_that_share_a_frequency_are_bounded_exactly() {
    let mut generator = Random(3);
    for _ in 0..1000 {
        let parameters = random(&mut generator, true);
        let harmonic = Harmonic::new(parameters).unwrap();
        let bounds = bounds(&harmonic.bounds());
        let period_us = TAU / parameters.frequency[0].abs() * 1e6;
        let mut largest = [0.0_f64; 4];
        for i in 0..2000 {
            let found = demands(&harmonic.at((period_us * f64::from(i) / 2000.0) as u64));
            largest.iter_mut().zip(found).for_each(|(largest, found)| *largest = largest.max(found));
        }
        for (bound, largest) in bounds.into_iter().zip(largest) {
            // The sampling misses the peak by at most pi / 2000 rad, 1.3e-6; the bound has its 2e-6.
            assert!(largest <= bound && largest > bound * (1.0 - 5e-6), "{largest} of {bound}");
        }
    }
}

#[test]
fn each_derivative_is_the_slope_of_the_one_below() {
    let mut generator = Random(4);
    for _ in 0..300 {
        let mut parameters = random(&mut generator, false);
        parameters.center = [0.0; 3];
        let harmonic = Harmonic::new(parameters).unwrap();
        let time = 1_000_000_000 + generator.bits() % 1_000_000_000;
        for axis in 0..3 {
            let omega = parameters.frequency[axis].abs();
            let step_us = (0.1 / omega * 1e6) as u64;
            for order in 0..4 {
                let value = |order: usize, time: u64| derivatives(&harmonic.at(time))[order][axis];
                let error = value(order + 1, time) - slope(|time| value(order, time), time, step_us);
                let scale = parameters.amplitude[axis].abs() * omega.powi(order as i32 + 1);
                // Truncation 0.1^4 / 30 = 3.4e-6; four values with 3e-7 each, weighted 18 / 1.2: 4.5e-6.
                assert!(error.abs() < 1e-5 * scale, "order {order}: {error:e} of {scale}");
            }
        }
        let w = parameters.heading.frequency.abs().max(1.0);
        let step_us = (0.1 / w * 1e6) as u64;
        let rate = slope(|t| turn(psi(&harmonic.at(t)), psi(&harmonic.at(time))), time, step_us);
        let acceleration = slope(|t| f64::from(harmonic.at(t).heading.rate()), time, step_us);
        let heading = harmonic.at(time).heading;
        let scale = parameters.heading.rate.abs() + (parameters.heading.amplitude.abs() + 1.0) * w;
        assert!((f64::from(heading.rate()) - rate).abs() < 3e-5 * scale);
        assert!((f64::from(heading.acceleration()) - acceleration).abs() < 3e-5 * scale * w);
    }
}

#[test]
fn a_number_that_cannot_be_flown_is_refused_by_name() {
    type Change = fn(&mut HarmonicParameters, f64);
    let fields: [(&str, Change); 16] = [
        ("reference.center[0]", |p, x| p.center[0] = x),
        ("reference.center[1]", |p, x| p.center[1] = x),
        ("reference.center[2]", |p, x| p.center[2] = x),
        ("reference.amplitude[0]", |p, x| p.amplitude[0] = x),
        ("reference.amplitude[1]", |p, x| p.amplitude[1] = x),
        ("reference.amplitude[2]", |p, x| p.amplitude[2] = x),
        ("reference.frequency[0]", |p, x| p.frequency[0] = x),
        ("reference.frequency[1]", |p, x| p.frequency[1] = x),
        ("reference.frequency[2]", |p, x| p.frequency[2] = x),
        ("reference.phase[0]", |p, x| p.phase[0] = x),
        ("reference.phase[1]", |p, x| p.phase[1] = x),
        ("reference.phase[2]", |p, x| p.phase[2] = x),
        ("reference.heading.offset", |p, x| p.heading.offset = x),
        ("reference.heading.rate", |p, x| p.heading.rate = x),
        ("reference.heading.amplitude", |p, x| p.heading.amplitude = x),
        ("reference.heading.frequency", |p, x| p.heading.frequency = x),
    ];
    for (field, change) in fields {
        for value in [f64::NAN, f64::INFINITY, 1e300] {
            let mut parameters = paper();
            change(&mut parameters, value);
            match Harmonic::new(parameters) {
                Err(error) => assert_eq!(error.field, field),
                // An angle of any size is an angle.
                Ok(_) => assert!(value == 1e300 && (field.contains("phase") || field.contains("offset")), "{field}"),
            }
        }
    }
}

#[test]
fn a_motion_too_violent_for_the_law_is_refused_and_one_just_below_is_not() {
    let mut parameters = paper();
    parameters.frequency[1] = 100.0;
    parameters.amplitude[1] = -0.0051;
    let error = Harmonic::new(parameters).unwrap_err();
    assert_eq!((error.field, error.reason), ("reference.amplitude[1]", Reason::NotBelow(0.005)));
    parameters.amplitude[1] = -0.0049;
    assert!(Harmonic::new(parameters).unwrap().bounds().snap < 1e6);

    parameters.heading.frequency = 1000.0;
    parameters.heading.amplitude = 0.41;
    let error = Harmonic::new(parameters).unwrap_err();
    assert_eq!((error.field, error.reason), ("reference.heading.amplitude", Reason::NotBelow(0.4)));
}

#[test]
fn an_axis_without_motion_stands_still() {
    let mut parameters = paper();
    parameters.frequency = [0.0, 1.0, 2.0];
    parameters.amplitude = [1.0, 0.0, 0.0];
    parameters.heading = HeadingParameters { offset: 0.0, rate: 0.0, amplitude: 1.0, frequency: 0.0 };
    let harmonic = Harmonic::new(parameters).unwrap();
    assert_eq!(bounds(&harmonic.bounds()), [0.0; 6]);
    assert_eq!(demands(&harmonic.at(12_345_678)), [0.0; 6]);
}
