//! Setpoints in: type masks, frames, checks.

use crate::support::receiver::{Fed, Local, texts};
use crate::support::{patched, v1};
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use controller_core::state::State;
use core::f32::consts::FRAC_PI_2;
use firmware::shared::Report;
use flight::Mode;
use mavlink::dialects::common::{MavFrame, PositionTargetTypemask as Mask, SET_POSITION_TARGET_LOCAL_NED_DATA};
use nalgebra::{UnitQuaternion, Vector3};

/// The mask that sets all aside but these.
fn only(used: Mask) -> Mask {
    Mask::from_bits_retain(0b1101_1111_1111).difference(used)
}

const POSITION: Mask = Mask::from_bits_retain(0b111);
const VELOCITY: Mask = Mask::from_bits_retain(0b111_000);
const ACCELERATION: Mask = Mask::from_bits_retain(0b1_1100_0000);
const YAW: Mask = Mask::POSITION_TARGET_TYPEMASK_YAW_IGNORE;
const YAW_RATE: Mask = Mask::POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE;

fn target(type_mask: Mask) -> SET_POSITION_TARGET_LOCAL_NED_DATA {
    SET_POSITION_TARGET_LOCAL_NED_DATA {
        x: 1.0,
        y: 2.0,
        z: -3.0,
        vx: 0.1,
        vy: 0.2,
        vz: -0.3,
        afx: 0.01,
        afy: 0.02,
        afz: -0.03,
        yaw: 0.5,
        yaw_rate: 0.25,
        type_mask,
        target_system: 1,
        target_component: 1,
        coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
        ..Default::default()
    }
}

/// What becomes of a setpoint.
fn accepted(message: &SET_POSITION_TARGET_LOCAL_NED_DATA) -> Option<Setpoint> {
    let shared = Local::new();
    Fed::new(&shared).message(message, 5);
    shared.setpoint.take().map(|setpoint| setpoint.value)
}

#[test]
fn the_type_mask_says_what_a_setpoint_is() {
    let position = Vector3::new(2.0, 1.0, 3.0);
    let velocity = Vector3::new(0.2, 0.1, 0.3);
    let acceleration = Vector3::new(0.02, 0.01, 0.03);
    let moving = |acceleration| Motion::PositionVelocityAcceleration { position, velocity, acceleration };
    let angle = FRAC_PI_2 - 0.5;
    for (used, motion, turn) in [
        (POSITION | YAW, Motion::Position(position), HeadingSetpoint::Angle { angle, rate: 0.0 }),
        (POSITION | YAW | YAW_RATE, Motion::Position(position), HeadingSetpoint::Angle { angle, rate: -0.25 }),
        (VELOCITY | YAW_RATE, Motion::Velocity(velocity), HeadingSetpoint::Rate(-0.25)),
        (VELOCITY, Motion::Velocity(velocity), HeadingSetpoint::Keep),
        (POSITION | VELOCITY, moving(Vector3::zeros()), HeadingSetpoint::Keep),
        (POSITION | VELOCITY | ACCELERATION | YAW, moving(acceleration), HeadingSetpoint::Angle { angle, rate: 0.0 }),
    ] {
        assert_eq!(accepted(&target(only(used))), Some(Setpoint { motion, turn }), "{used:?}");
    }
}

#[test]
fn a_mask_may_ask_for_position_on_some_axes_and_velocity_on_the_others() {
    let [north, east, down] = [0b1, 0b10, 0b100].map(Mask::from_bits_retain);
    let [vn, ve, vd] = [0b1_000, 0b10_000, 0b100_000].map(Mask::from_bits_retain);
    for (used, position, velocity) in [
        // Across by velocity at a height; to a place, up or down by velocity.
        (down | vn | ve, [None, None, Some(3.0)], [0.2, 0.1, 0.0]),
        (north | east | vd, [Some(2.0), Some(1.0), None], [0.0, 0.0, 0.3]),
        // North is the law's y.
        (north | ve | vd, [None, Some(1.0), None], [0.2, 0.0, 0.3]),
        // A height that rises, too.
        (down | VELOCITY, [None, None, Some(3.0)], [0.2, 0.1, 0.3]),
    ] {
        let motion = Motion::Mixed { position, velocity: velocity.into() };
        assert_eq!(accepted(&target(only(used))), Some(Setpoint { motion, turn: HeadingSetpoint::Keep }), "{used:?}");
    }
}

#[test]
fn setpoints_of_the_body_may_mix_height_and_velocity_across_but_not_ahead_and_across() {
    let [ahead, down] = [0b1, 0b100].map(Mask::from_bits_retain);
    let [va, vr, vd] = [0b1_000, 0b10_000, 0b100_000].map(Mask::from_bits_retain);
    let Motion::Mixed { position, velocity } =
        setpoint_of(target(only(down | va | vr)), MavFrame::MAV_FRAME_BODY_FRD).motion
    else {
        panic!()
    };
    // 3 m up from where it is; 0.1 m/s north and 0.2 m/s east.
    assert_eq!(position, [None, None, Some(6.0)]);
    assert!((velocity - Vector3::new(0.2, 0.1, 0.0)).norm() < 1e-6, "{velocity}");
    let shared = Local::new();
    shared.report.put(Report { mode: Mode::Flying, state: Some(leaning_north()), ..Report::NONE }, 0);
    let message = SET_POSITION_TARGET_LOCAL_NED_DATA {
        coordinate_frame: MavFrame::MAV_FRAME_BODY_FRD,
        ..target(only(ahead | vr | vd))
    };
    Fed::new(&shared).message(&message, 0);
    assert!(shared.setpoint.get().is_none());
    assert_eq!(texts(&shared), ["Setpoint refused: type mask not supported"]);
}

#[test]
fn type_masks_that_select_nothing_flyable_are_refused_in_words() {
    let x = Mask::POSITION_TARGET_TYPEMASK_X_IGNORE;
    let force = Mask::POSITION_TARGET_TYPEMASK_FORCE_SET;
    for mask in [
        only(Mask::empty()),
        only(YAW),
        only(ACCELERATION),
        only(POSITION | ACCELERATION),
        only(VELOCITY | ACCELERATION),
        // Nothing on an axis.
        only(x),
        only(POSITION.difference(x) | YAW),
        only(VELOCITY.difference(Mask::POSITION_TARGET_TYPEMASK_VZ_IGNORE)),
        // Acceleration on some axes.
        only(POSITION | VELOCITY | Mask::POSITION_TARGET_TYPEMASK_AX_IGNORE),
        only(POSITION | VELOCITY | ACCELERATION) | force,
    ] {
        let shared = Local::new();
        Fed::new(&shared).message(&target(mask), 0);
        assert!(shared.setpoint.get().is_none(), "{mask:?}");
        assert_eq!(texts(&shared), ["Setpoint refused: type mask not supported"]);
    }
}

#[test]
fn a_setpoint_in_another_frame_is_refused_in_words() {
    // Global, or of a body that does not know where it is.
    for coordinate_frame in [MavFrame::MAV_FRAME_GLOBAL, MavFrame::MAV_FRAME_BODY_FRD] {
        let shared = Local::new();
        let message = SET_POSITION_TARGET_LOCAL_NED_DATA { coordinate_frame, ..target(only(POSITION)) };
        Fed::new(&shared).message(&message, 0);
        assert!(shared.setpoint.get().is_none());
        assert_eq!(texts(&shared), ["Setpoint refused: frame not understood"]);
    }
}

/// Leaning, pointing a quarter turn to the left of world x: north. At (10, 20, 3) in the law's world.
fn leaning_north() -> State {
    let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2);
    let leaning = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.4);
    State {
        position: Vector3::new(10.0, 20.0, 3.0),
        velocity: Vector3::zeros(),
        attitude: (turned * leaning).into_inner(),
        angular_velocity: Vector3::zeros(),
    }
}

/// The setpoint of a message in a frame, for a vehicle that leans and points north.
fn setpoint_of(message: SET_POSITION_TARGET_LOCAL_NED_DATA, coordinate_frame: MavFrame) -> Setpoint {
    let shared = Local::new();
    shared.report.put(Report { mode: Mode::Flying, state: Some(leaning_north()), ..Report::NONE }, 0);
    Fed::new(&shared).message(&SET_POSITION_TARGET_LOCAL_NED_DATA { coordinate_frame, ..message }, 0);
    shared.setpoint.get().unwrap().value
}

#[test]
#[expect(deprecated, reason = "frames that clients still use")]
fn setpoints_of_the_body_are_ahead_right_and_down_however_it_leans() {
    let ahead = SET_POSITION_TARGET_LOCAL_NED_DATA { x: 5.0, y: 1.0, z: -2.0, ..target(only(POSITION)) };
    for frame in [MavFrame::MAV_FRAME_BODY_NED, MavFrame::MAV_FRAME_BODY_OFFSET_NED, MavFrame::MAV_FRAME_BODY_FRD] {
        let Motion::Position(position) = setpoint_of(ahead.clone(), frame).motion else { panic!() };
        // 5 m north, 1 m east, 2 m up from where it is.
        assert!((position - Vector3::new(11.0, 25.0, 5.0)).norm() < 1e-4, "{position}");
    }
    let Motion::Position(position) = setpoint_of(ahead, MavFrame::MAV_FRAME_LOCAL_OFFSET_NED).motion else { panic!() };
    assert!((position - Vector3::new(11.0, 25.0, 5.0)).norm() < 1e-4, "{position}");
    let moving = SET_POSITION_TARGET_LOCAL_NED_DATA { vx: 0.0, vy: 1.0, vz: 0.5, ..target(only(VELOCITY)) };
    let Motion::Velocity(velocity) = setpoint_of(moving, MavFrame::MAV_FRAME_BODY_NED).motion else { panic!() };
    assert!((velocity - Vector3::new(1.0, 0.0, -0.5)).norm() < 1e-4, "{velocity}");
    // A yaw of the body's is from where it points; to the right, east, where the law's heading is zero.
    let turning = SET_POSITION_TARGET_LOCAL_NED_DATA { yaw: FRAC_PI_2, ..target(only(VELOCITY.union(YAW))) };
    let HeadingSetpoint::Angle { angle, .. } = setpoint_of(turning, MavFrame::MAV_FRAME_BODY_NED).turn else {
        panic!()
    };
    assert!(angle.abs() < 1e-4, "{angle}");
}

#[test]
fn a_setpoint_for_another_vehicle_is_not_ours() {
    for (target_system, target_component, ours) in
        [(0, 0, true), (1, 0, true), (0, 1, true), (2, 1, false), (1, 2, false)]
    {
        let message = SET_POSITION_TARGET_LOCAL_NED_DATA { target_system, target_component, ..target(only(POSITION)) };
        assert_eq!(accepted(&message).is_some(), ours, "{target_system}/{target_component}");
    }
}

#[test]
fn a_setpoints_fields_must_be_finite_where_they_are_used() {
    let all = POSITION | VELOCITY | ACCELERATION | YAW | YAW_RATE;
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for field in 0..11 {
            let shared = Local::new();
            Fed::new(&shared).bytes(&patched(&target(only(all)), 4 + 4 * field, value), 0);
            assert!(shared.setpoint.get().is_none(), "field {field}");
            assert_eq!(texts(&shared), ["Setpoint refused: a field is not finite"]);
            // Set aside, it does not matter: clients write NaN there.
            let used = if field < 3 { VELOCITY } else { POSITION };
            let shared = Local::new();
            Fed::new(&shared).bytes(&patched(&target(only(used)), 4 + 4 * field, value), 0);
            assert!(shared.setpoint.get().is_some(), "field {field}");
        }
    }
}

#[test]
fn version_1_setpoints_are_as_good() {
    let shared = Local::new();
    Fed::new(&shared).bytes(&v1(1, &target(only(POSITION))), 0);
    assert!(shared.setpoint.get().is_some());
}
