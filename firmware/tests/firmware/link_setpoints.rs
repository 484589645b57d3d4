//! Setpoints in: type masks, frames, checks.

use crate::support::receiver::{Fed, Local, texts};
use crate::support::{patched, v1};
use controller_core::governor::{Motion, Setpoint, Turn};
use core::f32::consts::FRAC_PI_2;
use mavlink::dialects::common::{MavFrame, PositionTargetTypemask as Mask, SET_POSITION_TARGET_LOCAL_NED_DATA};
use nalgebra::Vector3;

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
        (POSITION | YAW, Motion::Position(position), Turn::Angle { angle, rate: 0.0 }),
        (POSITION | YAW | YAW_RATE, Motion::Position(position), Turn::Angle { angle, rate: -0.25 }),
        (VELOCITY | YAW_RATE, Motion::Velocity(velocity), Turn::Rate(-0.25)),
        (VELOCITY, Motion::Velocity(velocity), Turn::Keep),
        (POSITION | VELOCITY, moving(Vector3::zeros()), Turn::Keep),
        (POSITION | VELOCITY | ACCELERATION | YAW, moving(acceleration), Turn::Angle { angle, rate: 0.0 }),
    ] {
        assert_eq!(accepted(&target(only(used))), Some(Setpoint { motion, turn }), "{used:?}");
    }
}

#[test]
fn masks_that_say_nothing_flyable_are_refused_in_words() {
    let x = Mask::POSITION_TARGET_TYPEMASK_X_IGNORE;
    let force = Mask::POSITION_TARGET_TYPEMASK_FORCE_SET;
    for mask in [
        only(Mask::empty()),
        only(YAW),
        only(ACCELERATION),
        only(POSITION | ACCELERATION),
        only(VELOCITY | ACCELERATION),
        only(x),
        only(POSITION).difference(VELOCITY).union(Mask::POSITION_TARGET_TYPEMASK_VZ_IGNORE),
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
    let shared = Local::new();
    let coordinate_frame = MavFrame::MAV_FRAME_BODY_FRD;
    Fed::new(&shared).message(&SET_POSITION_TARGET_LOCAL_NED_DATA { coordinate_frame, ..target(only(POSITION)) }, 0);
    assert!(shared.setpoint.get().is_none());
    assert_eq!(texts(&shared), ["Setpoint refused: use LOCAL_NED"]);
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
