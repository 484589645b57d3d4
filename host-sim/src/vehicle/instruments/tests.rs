//! What the IMU shows of a motion.

use super::*;
use std::f64::consts::{SQRT_2, TAU};

/// Exact instruments with their own filters.
fn noiseless() -> Instruments {
    Instruments::new(&Estimator { imu_noise: 0.0, ..Estimator::default() }, 9.81, Vector3::zeros(), 0)
}

const STILL_BODY: BodyState = BodyState {
    position: Vector3::new(0.0, 0.0, 0.0),
    velocity: Vector3::new(0.0, 0.0, 0.0),
    attitude: Quaternion::from_vector(nalgebra::Vector4::new(0.0, 0.0, 0.0, 1.0)),
    angular_velocity: Vector3::new(0.0, 0.0, 0.0),
};

/// Outputs of gyro and accelerometer, each in its unit, over the last of three seconds with the same input.
fn filtered(feels: impl Fn(f64) -> f64) -> [Vec<f64>; 2] {
    let mut instruments = noiseless();
    let mut shown = [Vec::new(), Vec::new()];
    for n in 1..=3_000_u64 {
        let both = Vector3::x() * feels(n as f64 * 1e-3);
        let sample = instruments.sample_of(&STILL_BODY, n * SAMPLE_PERIOD_US, |_| TrueMotion {
            angular_velocity: both,
            specific_force: both,
        });
        if n > 2_000 {
            shown[0].push(sample.angular_velocity.x.into());
            shown[1].push(sample.specific_force.x.into());
        }
    }
    shown
}

/// The last of the unfiltered samples of a vehicle that is at these velocities, m/s, up, a millisecond after each
/// other, and turns, rad/s.
fn shown(velocities: &[f64], turning: f64) -> ImuSample {
    let mut instruments = noiseless().prompt();
    let mut state = BodyState { angular_velocity: Vector3::x() * turning, ..STILL_BODY };
    let sample = |(velocity, time): (&f64, u64)| {
        state.velocity.z = *velocity;
        instruments.sample(&state, time)
    };
    velocities.iter().zip((SAMPLE_PERIOD_US..).step_by(1000)).map(sample).last().unwrap()
}

#[test]
fn a_force_is_what_the_velocity_gained_and_the_weight() {
    let sample = shown(&[0.0, 0.05], 3.0);
    assert!((sample.specific_force - Vector3::new(0.0, 0.0, 59.81)).norm() < 1e-4, "{sample:?}");
    assert_eq!(sample.angular_velocity, Vector3::new(3.0, 0.0, 0.0));
}

#[test]
fn no_sensor_shows_more_than_its_range() {
    let range = ImuParameters::BMI088;
    for sign in [1.0, -1.0] {
        let sample = shown(&[0.0, sign * 0.5], sign * 100.0);
        assert_eq!(sample.specific_force, Vector3::z() * sign as f32 * range.accelerometer_range);
        assert_eq!(sample.angular_velocity, Vector3::x() * sign as f32 * range.gyro_range);
    }
}

#[test]
fn its_own_filters_let_half_the_power_pass_at_their_bandwidths_and_none_at_half_the_rate() {
    for (sensor, bandwidth) in
        [ImuParameters::BMI088.gyro_bandwidth.into(), ACCELEROMETER_BANDWIDTH_HZ].into_iter().enumerate()
    {
        let strength = |hertz: f64| {
            let samples = &filtered(|seconds| (TAU * hertz * seconds).cos())[sensor];
            (2.0 * samples.iter().map(|shown| shown * shown).sum::<f64>() / samples.len() as f64).sqrt()
        };
        let (half, little) = (strength(bandwidth), strength(499.0));
        assert!((half - 1.0 / SQRT_2).abs() < 1e-3 && little < 1e-3, "{bandwidth} Hz: {half}, {little}");
        assert!((strength(1.0) - 1.0).abs() < 1e-3);
    }
}

#[test]
fn its_own_filters_are_about_as_late_as_the_conditioner_allows_for() {
    // What grows steadily is shown as it was.
    let late = filtered(|seconds| seconds).map(|shown| 3.0 - shown.last().unwrap());
    let counted = ImuParameters::BMI088.late as f64 * 1e-6;
    assert!((late[0] - counted).abs() < 1e-4 && (counted - late[1] - 0.5e-3).abs() < 1e-4, "{late:?} s of {counted} s");
}
