use super::*;

#[test]
fn invalid_settings_are_refused_by_name() {
    type Set = fn(&mut EstimatorParameters);
    let cases: [(Set, &str, Reason); 5] = [
        (|p| p.gyro_noise = 0.0, "estimator.gyro_noise", Reason::NotPositive),
        (|p| p.accelerometer_walk = -1.0, "estimator.accelerometer_walk", Reason::Negative),
        (|p| p.time_noise = f32::NAN, "estimator.time_noise", Reason::NotFinite),
        (|p| p.position_noise = 11.0, "estimator.position_noise", Reason::NotBelow(10.0)),
        (|p| p.gravity = -9.81, "vehicle.gravity", Reason::NotPositive),
    ];
    for (set, field, reason) in cases {
        let mut parameters = EstimatorParameters::BMI088;
        set(&mut parameters);
        assert_eq!(Settings::new(&parameters), Err(ParameterError { field, reason }));
    }
    assert!(Settings::new(&EstimatorParameters::BMI088).is_ok());
}

#[test]
fn no_pose_is_believed_to_be_exact() {
    let settings = Settings::new(&EstimatorParameters::BMI088).unwrap();
    assert_eq!(settings.deviations(None), (1e-3, 5.2e-3));
    let (position, attitude) = settings.deviations(Some((0.0, 0.0)));
    assert_eq!((position, attitude), (1e-3, 5.2e-3));
    assert_eq!(settings.deviations(Some((0.02, 1e9))), (0.02, 10.0));
    let exact = EstimatorParameters { position_noise: 1e-6, attitude_noise: 1e-6, ..EstimatorParameters::BMI088 };
    assert_eq!(Settings::new(&exact).unwrap().deviations(None), (DEVIATION_MIN, DEVIATION_MIN));
}
