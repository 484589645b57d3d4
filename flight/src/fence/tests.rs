use super::*;
use controller_core::governor::HeadingSetpoint;
use nalgebra::UnitQuaternion;

#[test]
fn it_is_a_cylinder_about_home_without_a_floor() {
    let mut fence = Fence::new(&FlightSettings { fence_radius: 5.0, fence_height: 3.0, ..FlightSettings::DEFAULT });
    fence.place(&Vector3::new(10.0, 0.0, 1.0));
    for (x, y, z, inside) in [
        (10.0, 0.0, 1.0, true),
        (13.0, 4.0, 4.0, true),
        (13.0, 4.1, 1.0, false),
        (10.0, 0.0, 4.1, false),
        (10.0, 0.0, -9.0, true),
        (f32::NAN, 0.0, 1.0, false),
        (10.0, 0.0, f32::NAN, false),
    ] {
        let position = Vector3::new(x, y, z);
        assert_eq!(fence.contains(&position), inside, "{position}");
        let setpoint = Setpoint { motion: Motion::Position(position), turn: HeadingSetpoint::Keep };
        assert_eq!(fence.allows(&setpoint), inside);
    }
    assert!(fence.allows(&Setpoint { motion: Motion::Velocity(Vector3::repeat(9.0)), turn: HeadingSetpoint::Keep }));
    for (position, inside) in [
        ([None, None, Some(4.0)], true),
        ([None, None, Some(4.1)], false),
        ([Some(13.0), Some(4.0), None], true),
        ([Some(13.0), Some(4.1), None], false),
        ([Some(15.1), None, None], false),
    ] {
        let motion = Motion::Mixed { position, velocity: Vector3::repeat(9.0) };
        assert_eq!(fence.allows(&Setpoint { motion, turn: HeadingSetpoint::Keep }), inside, "{position:?}");
    }
}

fn state(position: [f32; 3], roll: f32, pitch: f32, yaw: f32) -> State {
    State {
        position: position.into(),
        velocity: Vector3::zeros(),
        attitude: UnitQuaternion::from_euler_angles(roll, pitch, yaw).into_inner(),
        angular_velocity: Vector3::zeros(),
    }
}

#[test]
fn it_goes_along_with_a_frame_that_moves_and_turns() {
    let mut fence = Fence::new(&FlightSettings::DEFAULT);
    fence.place(&Vector3::new(1.0, 2.0, 0.5));
    // Three metres ahead of home and two up; then the frame is turned by a quarter to the right and shifted.
    fence.displace(
        &state([4.0, 2.0, 2.5], 0.1, 0.2, 0.3),
        &state([10.0, -7.0, 3.0], 0.1, 0.2, 0.3 + core::f32::consts::FRAC_PI_2),
    );
    assert!((fence.home() - Vector3::new(10.0, -10.0, 1.0)).norm() < 1e-4, "{}", fence.home());
}
