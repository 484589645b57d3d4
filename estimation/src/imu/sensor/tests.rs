extern crate std;
use super::*;
use crate::imu::{Calibration, Conditioner};
use nalgebra::Vector3;
use std::f64::consts::{SQRT_2, TAU};
use std::println;
use std::vec::Vec;

/// Rates of control, Hz, one of each kind of low-pass and those in between.
const CONTROL_RATES_HZ: [u64; 8] = [50, 80, 100, 125, 200, 250, 500, 1000];

/// How much of a vibration of `frequency`, Hz, and 1 rad/s the law sees at its ticks, at most: through the sensor's own
/// filter, its samples and the conditioner.
fn seen(sensor: &ImuParameters, frequency: f64, control_rate: u64) -> f64 {
    let period = 1_000_000 / control_rate;
    let own = 1.0 / (1.0 + (frequency / f64::from(sensor.gyro_bandwidth)).powi(4)).sqrt();
    let mut conditioner = Conditioner::new(sensor, &Calibration::NONE, period).unwrap();
    let (settled, end) = (300_000, 1_300_000);
    let (mut tick, mut most) = (settled, 0.0_f64);
    let rate = f64::from(sensor.rate);
    for n in 0.. {
        let time = n as f64 / rate;
        let now = (time * 1e6) as u64;
        if now > tick {
            // The body rates about x and y are a quarter of a turn apart: together they show the amplitude.
            let seen = conditioner.newest().unwrap().value.angular_velocity;
            most = most.max(f64::from(seen.xy().norm()));
            tick += period;
        }
        if now > end {
            return most;
        }
        let (sine, cosine) = (TAU * frequency * time).sin_cos();
        let vibration = Vector3::new((own * cosine) as f32, (own * sine) as f32, (n % 3) as f32 * 1e-4);
        conditioner.sample(now + 10_000, &vibration, Some(&Vector3::new((n % 3) as f32 * 1e-4, 0.0, 9.81)));
    }
    most
}

#[test]
fn no_sensor_passes_much_more_of_a_vibration_on_than_a_bmi088() {
    // Below this share of a vibration no sensor shows any.
    const NOTHING_SHARE: f64 = 0.01;
    for control_rate in CONTROL_RATES_HZ {
        let mut worst = [0.0_f64; ImuParameters::DRIVEN.len()];
        for frequency in (40..=500).step_by(5).map(f64::from) {
            let tested = seen(&ImuParameters::BMI088, frequency, control_rate);
            for (worst, (name, sensor)) in worst.iter_mut().zip(&ImuParameters::DRIVEN) {
                let passed = seen(sensor, frequency, control_rate);
                *worst = worst.max(passed / tested.max(NOTHING_SHARE));
                let most = f64::from(GAIN_MAX_SHARE) * tested.max(NOTHING_SHARE);
                assert!(passed <= most, "{name} at {control_rate} Hz: {passed:.3} of {frequency} Hz, not {tested:.3}");
            }
        }
        println!("{control_rate:4} Hz: at most {worst:.2?} of what a BMI088 passes on");
    }
}

#[test]
fn at_100_hz_a_vibration_is_seen_as_the_table_says() {
    println!("vibration  alias at 100 Hz  {:?}", ImuParameters::DRIVEN.map(|(name, _)| name));
    for (frequency, expected) in [
        (70.0, [0.29, 0.27, 0.30, 0.30]),
        (100.0, [0.0; 4]),
        (130.0, [0.09, 0.07, 0.10, 0.10]),
        (200.0, [0.09, 0.06, 0.10, 0.10]),
        (250.0, [0.07, 0.04, 0.08, 0.07]),
        (400.0, [0.03, 0.02, 0.03, 0.03]),
    ] {
        let passed = ImuParameters::DRIVEN.map(|(_, sensor)| seen(&sensor, frequency, 100));
        let alias = (frequency / 100.0 - (frequency / 100.0).round()).abs() * 100.0;
        println!("{frequency:6.0} Hz  {alias:12.0} Hz  {passed:.3?}");
        for (passed, expected) in passed.into_iter().zip(expected) {
            assert!((passed - expected).abs() < 0.01, "{frequency} Hz: {passed}, not {expected}");
        }
    }
}

#[test]
fn a_sensor_is_late_by_its_filter_and_by_what_follows_that() {
    for (name, sensor) in ImuParameters::DRIVEN {
        let filter = SQRT_2 / (TAU * f64::from(sensor.gyro_bandwidth)) * 1e6;
        let behind = if name.starts_with("ICM") { 125.0 } else { 0.0 };
        assert!((filter + behind - sensor.late as f64).abs() < 1.0, "{name}: {filter}");
    }
}

#[test]
fn no_sensors_body_rates_are_later_than_a_bmi088s_by_0_15_ms() {
    for control_rate in CONTROL_RATES_HZ {
        let late: Vec<f32> =
            ImuParameters::DRIVEN.iter().map(|(_, sensor)| sensor.rates_late(1_000_000 / control_rate) * 1e3).collect();
        println!("{control_rate:4} Hz: {late:.2?} ms");
        assert!(late.iter().all(|one| (one - late[0]).abs() < 0.15), "{control_rate} Hz: {late:?}");
    }
}
