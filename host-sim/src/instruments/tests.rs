//! What the IMU shows of a motion.

use super::*;

/// The last of the samples of a vehicle that is at these velocities, m/s, up, a millisecond after each other, and turns, rad/s.
fn shown(velocities: &[f64], turning: f64) -> ImuSample {
    let mut instruments =
        Instruments::new(&Estimator { imu_noise: 0.0, ..Estimator::default() }, 9.81, Vector3::zeros(), 0);
    let mut state = BodyState {
        position: Vector3::zeros(),
        velocity: Vector3::zeros(),
        attitude: Quaternion::identity(),
        angular_velocity: Vector3::x() * turning,
    };
    let sample = |(velocity, time): (&f64, u64)| {
        state.velocity.z = *velocity;
        instruments.sample(&state, time)
    };
    velocities.iter().zip((SAMPLE..).step_by(1000)).map(sample).last().unwrap()
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
