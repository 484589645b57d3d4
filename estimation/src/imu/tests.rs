extern crate std;
use super::*;
use crate::estimator::Clipped;
use std::vec::Vec;

/// The time between control ticks, us.
const PERIOD: u64 = 10_000;

/// A sensor that jitters around these.
fn at(n: u64) -> (Vector3<f32>, Vector3<f32>) {
    let jitter = (n % 5) as f32 * 1e-4;
    (Vector3::new(0.5, -1.0 + jitter, 2.0), Vector3::new(jitter, 1.0, 9.81))
}

fn conditioner() -> Conditioner {
    Conditioner::new(&ImuParameters::BMI088, &Calibration::NONE, PERIOD).unwrap()
}

/// When what can be read at a time was so, us.
fn seen(time: u64) -> u64 {
    time - ImuParameters::BMI088.late
}

/// Increments and faults of the samples that can be read at these times, us.
fn run(conditioner: &mut Conditioner, times: impl Iterator<Item = u64>) -> (Vec<Increment>, Vec<ImuFault>) {
    let (mut increments, mut faults) = (Vec::new(), Vec::new());
    for time in times {
        let (rate, force) = at(time / 1_000);
        let Conditioned { increment, fault } = conditioner.sample(time, &rate, Some(&force));
        increments.extend(increment);
        faults.extend(fault);
    }
    (increments, faults)
}

#[test]
fn samples_at_1_khz_become_increments_of_5_ms_without_a_gap() {
    let (increments, faults) = run(&mut conditioner(), (5..=1_005).map(|n| n * 1_000));
    assert_eq!((increments.len(), faults.len()), (200, 0));
    for (increment, n) in increments.iter().zip(1..) {
        assert_eq!((increment.start, increment.end), (seen(n * 5_000), seen((n + 1) * 5_000)));
        assert!((increment.delta_angle / 0.005 - at(0).0).norm() < 1e-3);
    }
}

#[test]
fn missing_samples_are_bridged_and_gaps_begin_anew() {
    // Every third sample is missing, then 15 ms of them, then 16.
    let kept = (5..200_u64).filter(|n| n % 3 != 1).map(|n| n * 1_000);
    let later = [198_000 + 15_000, 214_000, 215_000, 231_001, 232_001, 237_001].into_iter();
    let (increments, faults) = run(&mut conditioner(), kept.chain(later));
    assert_eq!(faults, [ImuFault::Gap]);
    let gaps = increments.windows(2).filter(|pair| pair[0].end != pair[1].start).count();
    assert_eq!(gaps, 1);
    assert!(increments.iter().all(|one| one.is_usable(crate::estimator::EXTRAPOLATION_MAX_US)));
    assert_eq!(increments.last().unwrap().start, seen(231_001));
    let turn: Vector3<f32> = increments.iter().map(|increment| increment.delta_angle).sum();
    let covered: f32 = increments.iter().map(Increment::seconds).sum();
    assert!((turn - at(0).0 * covered).norm() < 1e-3 * covered);
}

#[test]
fn samples_that_run_back_or_are_no_numbers_are_left_out() {
    let mut conditioner = conditioner();
    let (_, faults) = run(&mut conditioner, [1_000, 2_000, 2_000, 1_500, 3_000].into_iter());
    assert_eq!(faults, [ImuFault::Clock, ImuFault::Clock]);
    // A fault worse than the clock's is reported first.
    let (rate, force) = at(3);
    (0..20).for_each(|_| _ = conditioner.sample(3_000, &rate, Some(&force)));
    assert_eq!(conditioner.sample(3_000, &rate, Some(&force)).fault, Some(ImuFault::GyroStuck));
    let before = conditioner.clone();
    let broken = conditioner.sample(4_000, &Vector3::repeat(f32::NAN), None);
    assert_eq!(broken, Conditioned { increment: None, fault: Some(ImuFault::NotFinite) });
    assert_eq!(conditioner, before);
}

#[test]
fn the_gyro_goes_on_when_the_accelerometer_is_silent() {
    let mut conditioner = conditioner();
    run(&mut conditioner, (0..10).map(|n| n * 1_000));
    let mut increments = 0;
    for n in 10..30_u64 {
        let sample = conditioner.sample(n * 1_000, &at(n).0, None);
        assert_eq!(sample.fault, Some(ImuFault::AccelerometerSilent));
        increments += u32::from(sample.increment.is_some());
    }
    assert_eq!(increments, 4);
}

#[test]
fn a_vibration_at_the_ticks_rate_does_not_reach_the_law() {
    // 100 Hz and 1 rad/s, taken at 100 Hz: unfiltered it would read as a constant rate of 1 rad/s.
    let mut conditioner = conditioner();
    let (mut worst, mut plain) = (0.0_f32, 0.0_f32);
    for n in 0..2_000_u64 {
        let rate = Vector3::new((n as f32 * 0.2 * core::f32::consts::PI).cos(), (n % 3) as f32 * 1e-4, 0.0);
        conditioner.sample(n * 1_000, &rate, Some(&at(n).1));
        if n % 10 == 0 && n > 100 {
            worst = worst.max(conditioner.newest().unwrap().value.angular_velocity.x.abs());
            plain = plain.max(rate.x.abs());
        }
    }
    assert!(worst < 1e-3 && plain > 0.99, "{worst}, unfiltered {plain}");
}

#[test]
fn parameters_that_make_no_sense_are_refused_by_name() {
    let refused = |parameters: &ImuParameters| Conditioner::new(parameters, &Calibration::NONE, PERIOD).err().unwrap();
    let good = ImuParameters::BMI088;
    assert_eq!(refused(&ImuParameters { rate: 0.0, ..good }).field, "imu.rate");
    assert_eq!(refused(&ImuParameters { gyro_range: f32::NAN, ..good }).field, "imu.gyro_range");
}

#[test]
fn the_laws_body_rates_are_late_by_both_filters_and_a_sample() {
    for (period, filtered) in [(PERIOD, 4.706e-3), (2_000, 2.786e-3)] {
        assert!((ImuParameters::PROMPT.rates_late(period) - filtered).abs() < 1e-6, "{period} us");
        assert!((ImuParameters::BMI088.rates_late(period) - filtered - 1.94e-3).abs() < 1e-6, "{period} us");
    }
    // A second-order Butterworth filter at 116 Hz.
    let own = core::f64::consts::FRAC_1_SQRT_2 / (core::f64::consts::PI * 116.0);
    assert!((own * 1e6 - ImuParameters::BMI088.late as f64).abs() < 1.0, "{own}");
}

#[test]
fn what_is_under_way_begins_with_the_last_increment_and_ends_with_the_newest_sample() {
    let mut conditioner = conditioner();
    for n in 5..40 {
        let (rate, force) = at(n);
        let increment = conditioner.sample(n * 1_000, &rate, Some(&force)).increment;
        let under_way = conditioner.under_way();
        assert!(increment.is_none() || under_way.is_none(), "{under_way:?}");
        if let Some(under_way) = under_way {
            assert_eq!((under_way.start, under_way.end), (seen(n / 5 * 5_000), seen(n * 1_000)));
            let turned = rate * under_way.seconds();
            assert!((under_way.delta_angle - turned).norm() < 1e-5, "{under_way:?}");
        }
    }
}

#[test]
fn the_newest_sample_is_low_passed_and_keeps_its_force_through_silence() {
    let mut conditioner = conditioner();
    assert_eq!(conditioner.newest(), None);
    run(&mut conditioner, (0..100).map(|n| n * 1_000));
    let force = conditioner.newest().unwrap().value.specific_force;
    let jump = Vector3::new(5.0, 0.0, 0.0);
    conditioner.sample(100_000, &(at(100).0 + jump), None);
    let newest = conditioner.newest().unwrap();
    assert_eq!((newest.time, newest.value.specific_force), (seen(100_000), force));
    assert!((1.5..2.5).contains(&newest.value.angular_velocity.x), "{}", newest.value.angular_velocity);
}

#[test]
fn another_sensor_takes_over_within_15_ms_without_a_gap_and_is_judged_by_its_own_range() {
    let mut conditioner = conditioner();
    run(&mut conditioner, (5..=42).map(|n| n * 1_000));
    let small = ImuParameters { accelerometer_range: 100.0, rate: 800.0, ..ImuParameters::BMI088 };
    let turned = Calibration { gyro_bias: Vector3::new(0.0, 0.0, 0.1), ..Calibration::NONE };
    conditioner.take_over(&small, &turned).unwrap();
    let mut increments = Vec::new();
    for n in 0..20_u64 {
        let (rate, force) = at(n);
        let sample = conditioner.sample(52_000 + n * 1_250, &(rate + turned.gyro_bias), Some(&force));
        assert_eq!(sample.fault, None);
        increments.extend(sample.increment);
        let smooth = conditioner.newest().unwrap().value.angular_velocity;
        assert!((smooth - at(0).0).norm() < 2e-3, "{smooth}");
    }
    // The one under way goes on, and the law's rate does not jump.
    assert_eq!(increments[0].start, seen(40_000));
    let shocked = (0..5).map(|n| conditioner.sample(80_000 + n, &at(n).0, Some(&Vector3::repeat(101.0 + n as f32))));
    assert_eq!(shocked.last().unwrap().fault, Some(ImuFault::AccelerometerSaturated));
    assert!(conditioner.take_over(&ImuParameters { rate: 0.0, ..small }, &turned).is_err());
}

#[test]
fn a_shock_beyond_a_range_is_flagged_in_its_increments_and_is_no_fault() {
    let (range, other) = (ImuParameters::BMI088.accelerometer_range, ImuParameters::BMI088.gyro_range);
    // Within an increment, and between two: half of that sample counts for each. Then where the next forces are
    // missing.
    for (shocked, silent, expected) in [(7, 0, 1..2), (10, 0, 1..3), (7, 9, 1..4)] {
        let clipped = |gyro: bool| {
            let mut conditioner = conditioner();
            let mut increments = Vec::new();
            for n in 0..=25_u64 {
                let (mut rate, mut force) = at(n);
                if n == shocked {
                    *(if gyro { &mut rate.y } else { &mut force.z }) = -(if gyro { other } else { range });
                }
                let is_silent = (shocked + 1..=shocked + silent).contains(&n);
                let sample = conditioner.sample((n + 5) * 1_000, &rate, (!is_silent).then_some(&force));
                assert_eq!(sample.fault, is_silent.then_some(ImuFault::AccelerometerSilent));
                increments.extend(sample.increment);
            }
            increments.into_iter().map(|one| one.clipped).collect::<Vec<_>>()
        };
        for (n, (by_gyro, by_force)) in clipped(true).into_iter().zip(clipped(false)).enumerate() {
            assert_eq!(by_force, Clipped { gyro: false, accelerometer: expected.contains(&n) }, "{n} of {shocked}");
            let whirled = if shocked == 10 { 1..3 } else { 1..2 };
            assert_eq!(by_gyro, Clipped { gyro: whirled.contains(&n), accelerometer: false }, "{n} of {shocked}");
        }
    }
}
