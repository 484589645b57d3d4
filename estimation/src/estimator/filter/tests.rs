use super::*;
use crate::estimator::EstimatorParameters;
use crate::measurement::{Pose, Velocity};

/// At rest at the origin but for a turn about the vertical, rad, and a velocity along x, m/s.
fn pose(turn: f32, speed: f32) -> PoseMeasurement {
    let attitude = UnitQuaternion::from_euler_angles(0.0, 0.0, turn).into_inner();
    let velocity = Velocity::World(Vector3::new(speed, 0.0, 0.0));
    PoseMeasurement::with_velocity(&Pose::new(Vector3::zeros(), velocity, attitude).unwrap())
}

#[test]
fn however_uncertain_an_attitude_half_a_radian_is_no_error_of_estimation() {
    let settings = Settings::new(&EstimatorParameters::BMI088).unwrap();
    let mut filter = Filter::start(0, &pose(0.0, 0.0), &Biases::unknown(&settings), &settings);
    filter.covariance.tt = Matrix3::from_diagonal_element(1.0);
    let gate = |turn: f32| filter.weigh(&pose(turn, 0.0), &settings).and_then(|tested| tested.gate());
    assert_eq!(gate(0.51), Ok(()));
    assert_eq!(gate(0.53), Err(Rejected::Attitude));
    assert_eq!(gate(-0.53), Err(Rejected::Attitude));
}

#[test]
fn a_filter_begins_with_a_velocity_where_velocities_are_believed() {
    let believing = EstimatorParameters { velocity_noise: 0.2, ..EstimatorParameters::BMI088 };
    for (parameters, speed, deviation) in
        [(believing, 3.0, 0.2), (EstimatorParameters::BMI088, 0.0, UNKNOWN_VELOCITY_M_PER_S)]
    {
        let settings = Settings::new(&parameters).unwrap();
        let filter = Filter::start(0, &pose(0.0, 3.0), &Biases::unknown(&settings), &settings);
        assert_eq!(filter.nominal.velocity.x, speed);
        assert!((filter.covariance.vv.m11 / (deviation * deviation) - 1.0).abs() < 1e-6, "{}", filter.covariance.vv);
    }
}

#[test]
fn a_frame_that_turns_takes_velocity_and_body_rate_along() {
    let settings = Settings::new(&EstimatorParameters::BMI088).unwrap();
    let mut filter = Filter::start(0, &pose(0.0, 0.0), &Biases::unknown(&settings), &settings);
    (filter.nominal.velocity, filter.turn_rate) = (Vector3::x(), Vector3::x() * 2.0);
    filter.rebase(&pose(core::f32::consts::FRAC_PI_2, 0.0), &settings);
    assert!((filter.nominal.velocity - Vector3::y()).norm() < 1e-6);
    assert!((filter.turn_rate - Vector3::y() * 2.0).norm() < 1e-6);
    assert_eq!(filter.nominal.attitude, pose(core::f32::consts::FRAC_PI_2, 0.0).attitude());
}
