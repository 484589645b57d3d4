extern crate std;
use super::*;
use proptest::prelude::*;
use std::f64::consts::TAU;
use std::println;
use std::vec::Vec;

const RATE_HZ: f32 = 1000.0;

/// Of a rotor at so many Hz.
fn speed(frequency: f64) -> Option<f32> {
    Some((TAU * frequency) as f32)
}

/// A sample of a vibration that shows its amplitude in x and y together.
fn turning(frequency: f64, sample: usize) -> Vector3<f32> {
    let (sine, cosine) = (TAU * frequency * sample as f64 / f64::from(RATE_HZ)).sin_cos();
    Vector3::new(cosine as f32, sine as f32, 0.0)
}

/// What is left of a vibration of `frequency` after a second, of rotors at these, Hz.
fn left(frequency: f64, rotors: [f64; ROTOR_COUNT]) -> f32 {
    let mut notches = RotorNotches::new(RATE_HZ);
    (0..2_000)
        .map(|sample| {
            notches.follow(&rotors.map(speed));
            let out = notches.take(&turning(frequency, sample));
            if sample < 1_000 { 0.0 } else { out.xy().norm() }
        })
        .fold(0.0, f32::max)
}

#[test]
fn a_rotors_vibration_is_stopped_and_a_slow_turn_is_not() {
    for frequency in [70.0, 100.0, 150.0, 200.0, 333.0, 400.0] {
        let apart = [frequency, 0.9 * frequency, 1.1 * frequency, 55.0];
        assert!(left(frequency, apart) < 1e-3, "{frequency} Hz");
    }
    // Of 1.01 times the frequency 2 Q 0.01 is left; of a slow turn everything.
    let beside = left(202.0, [200.0, 0.0, 0.0, 0.0]);
    assert!((0.15..0.17).contains(&beside), "beside: {beside}");
    let slow = left(5.0, [80.0; ROTOR_COUNT]);
    assert!((0.99..1.01).contains(&slow), "slow: {slow}");
    // Too slow for a notch, too fast for one, and somewhere between.
    assert_eq!(left(40.0, [40.0; ROTOR_COUNT]), left(40.0, [0.0; ROTOR_COUNT]));
    assert_eq!(left(460.0, [460.0; ROTOR_COUNT]), left(460.0, [0.0; ROTOR_COUNT]));
    let half = left(57.5, [57.5, 0.0, 0.0, 0.0]);
    assert!((0.49..0.51).contains(&half), "half: {half}");
}

#[test]
fn slow_changes_are_late_by_what_is_counted() {
    for rate in [1000.0, 1600.0] {
        let late = |frequency: f64| {
            let mut notches = RotorNotches::new(rate);
            // A ramp of 1 rad/s^2.
            let out = |sample: u32| {
                notches.follow(&[speed(frequency); ROTOR_COUNT]);
                let time = sample as f32 / rate;
                time - notches.take(&Vector3::repeat(time)).x
            };
            (0..2_000).map(out).last().unwrap()
        };
        let most = RotorNotches::delay_max(rate);
        println!("{rate} Hz: {:.2} ms", most * 1e3);
        let found: Vec<f32> = [46.0, 55.0, 65.0, 70.0, 80.0, 100.0, 200.0, 400.0].into_iter().map(late).collect();
        assert!(found.iter().all(|late| *late < most + 2e-5), "{found:?}");
        assert!((found[3] - most).abs() < 2e-5, "{found:?}, counted {most}");
    }
}

#[test]
fn a_speed_that_appears_jumps_or_is_lost_makes_no_jump_of_the_body_rate() {
    let rate = Vector3::new(3.0, -2.0, 1.0);
    let mut notches = RotorNotches::new(RATE_HZ);
    let (mut worst, mut before) = (0.0_f32, rate);
    for sample in 0..3_000 {
        match sample {
            // Nobody has told any; all appear; one is lost; silence.
            0..500 | 2_500.. => {}
            500..1_500 => notches.follow(&[speed(100.0); ROTOR_COUNT]),
            _ => notches.follow(&[speed(100.0), None, Some(f32::NAN), speed(1e9)]),
        }
        let out = notches.take(&rate);
        worst = worst.max((out - before).norm());
        before = out;
        assert!((out - rate).norm() < 1e-4 * rate.norm(), "sample {sample}: {out}");
    }
    assert!(worst < 1e-4 * rate.norm());
    // From one frequency to another at once, which no rotor does: a tenth of the body rate, and soon over.
    let mut off = (0.0_f32, 0.0_f32);
    for sample in 0..2_000 {
        notches.follow(&[speed(if sample < 1_000 { 80.0 } else { 240.0 }); ROTOR_COUNT]);
        let error = (notches.take(&rate) - rate).norm() / rate.norm();
        off.0 = off.0.max(error);
        off.1 = if sample > 1_200 { off.1.max(error) } else { 0.0 };
    }
    println!("a leap of all speeds from 80 to 240 Hz: {:.3} of the body rate, {:.5} 200 ms later", off.0, off.1);
    assert!(off.0 < 0.2 && off.1 < 1e-3, "{off:?}");
}

#[test]
fn speeds_that_nobody_renews_are_forgotten() {
    let mut notches = RotorNotches::new(RATE_HZ);
    (0..200).for_each(|sample| {
        notches.follow(&[speed(100.0); ROTOR_COUNT]);
        notches.take(&turning(100.0, sample));
    });
    // The time-out, then the time to fade.
    let passed = |notches: &mut RotorNotches, sample| notches.take(&turning(100.0, sample)).xy().norm();
    let mut out: Vec<f32> = (200..300).map(|sample| passed(&mut notches, sample)).collect();
    assert!(out[45] < 0.1 && out[99] == 1.0, "{out:?}");
    out = (300..400).map(|sample| passed(&mut notches, sample)).collect();
    assert!(out.iter().all(|out| (out - 1.0).abs() < 1e-6));
}

#[test]
fn a_rotor_that_speeds_up_stays_stopped() {
    // From 80 to 240 Hz within half a second, told every 10 ms.
    let mut notches = RotorNotches::new(RATE_HZ);
    let (mut phase, mut worst) = (0.0_f64, 0.0_f32);
    for sample in 0..1_500_u32 {
        let frequency = 80.0 + 160.0 * f64::from(sample.saturating_sub(500).min(500)) / 500.0;
        if sample % 10 == 0 {
            notches.follow(&[speed(frequency), None, None, None]);
        }
        phase += TAU * frequency * 1e-3;
        let out = notches.take(&Vector3::new(phase.cos() as f32, phase.sin() as f32, 0.0)).xy().norm();
        if sample > 100 {
            worst = worst.max(out);
        }
    }
    println!("a rotor that speeds up by 320 Hz/s: {worst:.2} of its vibration at most");
    assert!(worst < 0.6, "{worst}");
}

proptest! {
    /// A speed for each rotor and sample, anything among them, and any vibration: what comes out stays bounded.
    #[test]
    fn whatever_the_speeds_do_the_output_is_bounded(
        told in prop::collection::vec(
            prop::array::uniform4(prop_oneof![
                2 => (0.0_f32..4_000.0).prop_map(Some),
                1 => Just(None),
                1 => any::<f32>().prop_map(Some),
            ]),
            1..60,
        ),
        hold in 1_usize..40,
        frequency in 0.0_f64..500.0,
        phases in prop::collection::vec(-1.0_f32..1.0, 64),
    ) {
        let mut notches = RotorNotches::new(RATE_HZ);
        let mut most = 0.0_f32;
        for sample in 0..4_000 {
            if sample % hold == 0 {
                notches.follow(&told[sample / hold % told.len()]);
            }
            let noise = phases[sample % phases.len()];
            let value = if sample % 1_000 < 500 { turning(frequency, sample) } else { Vector3::repeat(noise) };
            most = most.max(notches.take(&value).norm());
        }
        // In four filters, one behind the other: less than twice what went in.
        prop_assert!(most < 4.0, "{most}");
    }
}
