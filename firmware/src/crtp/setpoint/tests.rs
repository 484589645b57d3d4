use super::*;
use controller_core::state::State;
use nalgebra::Quaternion;
use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

/// A vehicle that points along y.
fn here() -> Here {
    let attitude = Quaternion::new(FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2);
    let still = Vector3::zeros();
    Here::at(&State { position: still, velocity: still, attitude, angular_velocity: still }).unwrap()
}

fn read(port: u8, channel: u8, parts: &[&[u8]]) -> Result<Streamed, SetpointRefusal> {
    streamed(&Packet::new(port, channel).with(&parts.concat()), Some(&here()))
}

fn floats<const COUNT: usize>(numbers: [f32; COUNT]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

fn close(one: &Setpoint, other: &Setpoint) -> bool {
    let parts = |motion: &Motion| match *motion {
        Motion::Position(position) => (0, [position, Vector3::zeros(), Vector3::zeros()]),
        Motion::Velocity(velocity) => (1, [velocity, Vector3::zeros(), Vector3::zeros()]),
        Motion::PositionVelocityAcceleration { position, velocity, acceleration } => {
            (2, [position, velocity, acceleration])
        }
        Motion::Mixed { position, velocity } => {
            (3, [Vector3::from(position.map(|place| place.unwrap_or(1e9))), velocity, Vector3::zeros()])
        }
    };
    let turn = |turn: &HeadingSetpoint| match *turn {
        HeadingSetpoint::Keep => (0, 0.0, 0.0),
        HeadingSetpoint::Angle { angle, rate } => (1, angle, rate),
        HeadingSetpoint::Rate(rate) => (2, 0.0, rate),
    };
    let ((kind, vectors), (other_kind, others)) = (parts(&one.motion), parts(&other.motion));
    let ((way, angle, rate), (other_way, other_angle, other_rate)) = (turn(&one.turn), turn(&other.turn));
    (kind, way) == (other_kind, other_way)
        && vectors.iter().zip(others).all(|(vector, other)| (vector - other).norm() < 2e-3)
        && (angle - other_angle).abs() < 2e-3
        && (rate - other_rate).abs() < 2e-3
}

fn flown(kind: u8, rest: &[u8]) -> Setpoint {
    match read(ports::SETPOINT, 0, &[&[kind], rest]) {
        Ok(Streamed::Setpoint(setpoint)) => setpoint,
        other => panic!("{kind}: {other:?}"),
    }
}

#[test]
fn each_kind_is_flown_as_its_numbers_say() {
    let rate = HeadingSetpoint::Rate(FRAC_PI_2);
    let other = HeadingSetpoint::Rate(-FRAC_PI_2);
    let world = Motion::Velocity(Vector3::new(1.0, 2.0, 3.0));
    // Ahead is y, to the left is -x. Half a metre per second ahead, a quarter to the right.
    let lean = Vector3::new(0.25, 0.5, 0.0);
    let at_height = Motion::Mixed { position: [None, None, Some(0.7)], velocity: lean };
    let climbing = Motion::Velocity(lean + Vector3::z() * 0.7);
    let place = Motion::Position(Vector3::new(1.0, 2.0, 3.0));
    let turned = HeadingSetpoint::Angle { angle: FRAC_PI_2, rate: 0.0 };
    for (kind, rest, motion, turn) in [
        (1, floats([1.0, 2.0, 3.0, 90.0]), world, other),
        (8, floats([1.0, 2.0, 3.0, 90.0]), world, rate),
        (2, floats([7.5, -15.0, 90.0, 0.7]), at_height, other),
        (9, floats([7.5, -15.0, 90.0, 0.7]), at_height, rate),
        (4, floats([7.5, -15.0, 90.0, 0.7]), climbing, rate),
        (5, floats([0.5, -0.25, 90.0, 0.7]), at_height, other),
        (10, floats([0.5, -0.25, 90.0, 0.7]), at_height, rate),
        (7, floats([1.0, 2.0, 3.0, 90.0]), place, turned),
    ] {
        let found = flown(kind, &rest);
        assert!(close(&found, &Setpoint { motion, turn }), "{kind}: {found:?}");
    }
}

#[test]
fn a_full_state_is_a_moving_point_with_the_heading_of_its_x_axis() {
    let numbers: Vec<u8> =
        [1000_i16, -2000, 500, 100, 0, -100, 10, 20, 30].iter().flat_map(|number| number.to_le_bytes()).collect();
    let attitude = crate::crtp::quaternion::packed(&Quaternion::new(FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2));
    let rates: Vec<u8> = [5_i16, 6, 250].iter().flat_map(|number| number.to_le_bytes()).collect();
    let found = flown(6, &[&numbers[..], &attitude.to_le_bytes(), &rates].concat());
    let motion = Motion::PositionVelocityAcceleration {
        position: Vector3::new(1.0, -2.0, 0.5),
        velocity: Vector3::new(0.1, 0.0, -0.1),
        acceleration: Vector3::new(0.01, 0.02, 0.03),
    };
    let turn = HeadingSetpoint::Angle { angle: FRAC_PI_2, rate: 0.25 };
    assert!(close(&found, &Setpoint { motion, turn }), "{found:?}");
}

#[test]
fn sticks_lean_and_climb_and_a_hand_off_them_is_no_setpoint() {
    let sticks = |roll: f32, pitch: f32, rate: f32, thrust: u16| {
        read(ports::COMMANDER, 0, &[&floats([roll, pitch, rate]), &thrust.to_le_bytes()])
    };
    let Ok(Streamed::Setpoint(found)) = sticks(7.5, -15.0, 90.0, 49_151) else { panic!() };
    let motion = Motion::Velocity(Vector3::new(0.25, 0.5, 0.5));
    assert!(close(&found, &Setpoint { motion, turn: HeadingSetpoint::Rate(-FRAC_PI_2) }), "{found:?}");
    assert_eq!(sticks(0.0, 0.0, 0.0, 0), Ok(Streamed::Nothing));
    let manual = |is_rate: u8| {
        read(ports::SETPOINT, 0, &[&[11], &floats([0.0, 0.0, 90.0]), &32_767_u16.to_le_bytes(), &[is_rate]])
    };
    assert!(
        matches!(manual(0), Ok(Streamed::Setpoint(Setpoint { turn: HeadingSetpoint::Rate(rate), .. })) if rate > 1.0)
    );
    assert_eq!(manual(1), Err(SetpointRefusal::Rates));
}

#[test]
fn stops_and_ends_are_told_apart_and_the_rest_is_refused() {
    assert_eq!(read(ports::SETPOINT, 0, &[&[0]]), Ok(Streamed::Stop));
    assert_eq!(read(ports::SETPOINT, 1, &[&[0, 0, 0, 0, 0]]), Ok(Streamed::End));
    for kind in [3, 12, 255] {
        assert_eq!(read(ports::SETPOINT, 0, &[&[kind], &[0; 20]]), Err(SetpointRefusal::Kind));
    }
    assert_eq!(read(ports::SETPOINT, 0, &[]), Err(SetpointRefusal::Short));
    assert_eq!(read(ports::SETPOINT, 2, &[&[0]]), Err(SetpointRefusal::Kind));
    assert_eq!(read(ports::SETPOINT, 0, &[&[8], &floats([0.0, 0.0, 0.0])]), Err(SetpointRefusal::Short));
    let infinite = floats([0.0, f32::INFINITY, 0.0, 0.0]);
    assert_eq!(read(ports::SETPOINT, 0, &[&[8], &infinite]), Err(SetpointRefusal::NotFinite));
    let hover = Packet::new(ports::SETPOINT, 0).with(&[10]).with(&floats([0.1, 0.0, 0.0, 1.0]));
    assert_eq!(streamed(&hover, None), Err(SetpointRefusal::NotHere));
}
