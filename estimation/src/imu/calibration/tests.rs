use super::*;
use nalgebra::UnitQuaternion;

fn rest(force: Vector3<f32>) -> StandstillMeans {
    StandstillMeans { angular_velocity: Vector3::new(0.01, -0.005, 0.002), specific_force: force }
}

#[test]
fn levelling_takes_gravity_to_straight_up_by_a_rotation_that_does_not_turn() {
    for (roll, pitch) in [(0.0_f32, 0.0_f32), (3.0, -2.0), (-4.9, 0.0), (0.0, 4.9)] {
        let tilt = UnitQuaternion::from_scaled_axis(Vector3::new(roll.to_radians(), pitch.to_radians(), 0.0));
        let felt = tilt.inverse_transform_vector(&Vector3::new(0.0, 0.0, 9.81));
        let levelled = Calibration::NONE.levelled(&rest(felt)).unwrap();
        assert!((levelled.force(&felt) - Vector3::new(0.0, 0.0, 9.81)).norm() < 1e-5);
        let level = levelled.level;
        assert!((level * level.transpose() - Matrix3::identity()).norm() < 1e-6);
        assert!((level.m12 - level.m21).abs() < 1e-7, "it turns: {level}");
    }
}

#[test]
fn a_slope_a_sensor_upside_down_and_none_at_all_are_not_level() {
    let sloping = UnitQuaternion::from_scaled_axis(Vector3::new(0.09_f32, 0.0, 0.0)) * Vector3::new(0.0, 0.0, 9.81);
    for force in [sloping, Vector3::new(0.0, 0.0, -9.81), Vector3::zeros(), Vector3::repeat(f32::NAN)] {
        assert_eq!(Calibration::NONE.levelled(&rest(force)), Err(NotLevel));
    }
}

#[test]
fn samples_are_corrected_in_the_order_of_the_equations() {
    let calibration = Calibration {
        offset: Vector3::new(0.1, -0.2, 0.3),
        scale: Vector3::new(1.01, 0.99, 1.02),
        ..Calibration::NONE.with_gyro_bias(&rest(Vector3::z()))
    };
    let force = calibration.force(&Vector3::new(1.1, 1.8, 10.3));
    assert!((force - Vector3::new(1.01, 1.98, 10.2)).norm() < 1e-5, "{force}");
    assert!((calibration.rate(&Vector3::new(1.01, 1.995, 3.002)) - Vector3::new(1.0, 2.0, 3.0)).norm() < 1e-6);
}
