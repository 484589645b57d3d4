use super::*;
use crate::mrp;

#[test]
fn body_z_points_along_the_command_and_body_x_over_the_heading() {
    let u = Vector3::new(3.0, -2.0, 6.0);
    for (cos, sin) in [(1.0, 0.0), (-0.8, 0.6), (-1.0, 0.0), (0.28, -0.96)] {
        let heading = Heading::new(Vector2::new(cos, sin), 0.0, 0.0).unwrap();
        let desired = attitude_reference(&u, &Vector3::zeros(), &Vector3::zeros(), &heading);
        let r = mrp::rotation(&desired.attitude);
        assert!((r.column(2) - u / 7.0).norm() < 1e-6);
        let x = r.column(0);
        assert!((cos * x[1] - sin * x[0]).abs() < 1e-6 && cos * x[0] + sin * x[1] > 0.0);
        assert!((desired.magnitude - 7.0).abs() < 1e-6);
    }
}

#[test]
fn the_error_is_the_conjugate_of_the_desired_attitude_times_the_attitude() {
    let attitude = Quaternion::new(0.5, -0.1, 0.7, 0.5);
    for (cos, sin) in [(1.0, 0.0), (-0.8, 0.6), (-1.0, 0.0), (0.28, -0.96)] {
        let heading = Heading::new(Vector2::new(cos, sin), 0.0, 0.0).unwrap();
        let desired = DesiredAttitude::new(&Vector3::new(3.0, -2.0, 6.0), &heading);
        let (error, expected) = (desired.error(&attitude), desired.attitude().conjugate() * attitude);
        assert!((error * expected.dot(&error).signum() / error.norm() - expected / expected.norm()).norm() < 1e-6);
    }
}

#[test]
fn a_turning_heading_over_a_level_vehicle_is_pure_yaw() {
    let heading = Heading::new(Vector2::new(0.6, 0.8), 1.5, -0.5).unwrap();
    let still = Vector3::zeros();
    let desired = attitude_reference(&Vector3::new(0.0, 0.0, 9.81), &still, &still, &heading);
    assert!((desired.angular_velocity - Vector3::new(0.0, 0.0, 1.5)).norm() < 1e-6);
    assert!((desired.angular_acceleration - Vector3::new(0.0, 0.0, -0.5)).norm() < 1e-6);
}
