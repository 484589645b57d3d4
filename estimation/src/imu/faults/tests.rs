use super::*;
use crate::imu::low_pass::LowPass;

const RANGES: Ranges = Ranges { gyro: 34.9, accelerometer: 235.0, leap: 40.0 };

/// Samples that jitter, as a sensor that works does.
fn noisy(n: u32) -> (Vector3<f32>, Vector3<f32>) {
    let jitter = (n % 7) as f32 * 1e-3;
    (Vector3::new(jitter, 0.1 - jitter, 0.2), Vector3::new(jitter, 0.0, 9.81 + jitter))
}

#[test]
fn a_sensor_that_works_has_no_fault() {
    let mut watch = FaultMonitor::new(RANGES);
    for n in 0..1_000 {
        let (rate, force) = noisy(n);
        assert_eq!(watch.check(&rate, Some(&force)), None);
    }
}

#[test]
fn a_stuck_sensor_is_one_after_20_ms_and_works_again_at_once() {
    for (gyro, fault) in [(true, ImuFault::GyroStuck), (false, ImuFault::AccelerometerStuck)] {
        let mut watch = FaultMonitor::new(RANGES);
        let stuck = noisy(3);
        for n in 0..100 {
            let (rate, force) = noisy(n);
            let seen = if gyro { (stuck.0, force) } else { (rate, stuck.1) };
            let expected = (n >= u32::from(STUCK_AFTER_SAMPLES)).then_some(fault);
            assert_eq!(watch.check(&seen.0, Some(&seen.1)), expected, "{n}");
        }
        let (rate, force) = noisy(4);
        assert_eq!(watch.check(&rate, Some(&force)), None);
    }
}

#[test]
fn full_scale_is_a_fault_when_it_lasts() {
    let mut watch = FaultMonitor::new(RANGES);
    for n in 0..20 {
        let (mut rate, mut force) = noisy(n);
        rate.y = -34.9;
        let expected = (n + 1 >= u32::from(SATURATED_AFTER_SAMPLES)).then_some(ImuFault::GyroSaturated);
        assert_eq!(watch.check(&rate, Some(&force)), expected, "{n}");
        (rate.y, force.z) = (0.0, 0.0);
    }
    let mut watch = FaultMonitor::new(RANGES);
    for n in 0..20 {
        let (rate, mut force) = noisy(n);
        force.z = 235.0;
        let expected = (n + 1 >= u32::from(SATURATED_AFTER_SAMPLES)).then_some(ImuFault::AccelerometerSaturated);
        assert_eq!(watch.check(&rate, Some(&force)), expected, "{n}");
    }
}

#[test]
fn missing_and_non_finite_values_are_reported() {
    let mut watch = FaultMonitor::new(RANGES);
    let (rate, force) = noisy(1);
    assert_eq!(watch.check(&rate, None), Some(ImuFault::AccelerometerSilent));
    assert_eq!(watch.check(&rate.map(|_| f32::NAN), Some(&force)), Some(ImuFault::NotFinite));
    assert_eq!(watch.check(&rate, Some(&(force * f32::INFINITY))), Some(ImuFault::NotFinite));
    assert_eq!(watch.check(&rate, Some(&force)), None);
}

#[test]
fn a_shock_shows_as_a_leap_behind_the_sensors_own_filter_and_vibration_does_not() {
    // What 145 Hz leave of a millisecond at full scale, and of one at three fifths of it.
    for (felt, is_clipped) in [(235.0, true), (0.6 * 235.0, false)] {
        let mut own = LowPass::new(145.0, 500.0, 1000.0);
        let mut watch = FaultMonitor::new(RANGES);
        let mut clipped = 0;
        for n in 0..50 {
            let (rate, force) = noisy(n);
            let shown = own.take(&(force + Vector3::z() * if n == 20 { felt } else { 0.0 }));
            assert_eq!(watch.check(&rate, Some(&shown)), None);
            assert!(shown.norm() < 100.0);
            clipped += u32::from(watch.clipped().accelerometer);
        }
        assert_eq!(clipped > 0, is_clipped, "{felt} m/s^2");
    }
    let mut watch = FaultMonitor::new(RANGES);
    for n in 0..1_000 {
        let (rate, force) = noisy(n);
        let shaken = force + Vector3::x() * (60.0 * (n as f32 * 0.15 * core::f32::consts::PI).sin());
        assert_eq!(watch.check(&rate, Some(&shaken)), None);
        assert_eq!(watch.clipped(), Clipped::NEITHER, "{n}");
    }
}
