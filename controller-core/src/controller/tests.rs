//! A step leaves no trace where it is refused, and a reset none of what was flown.

use super::*;
use crate::gains::GainParameters;
use crate::heading::Heading;
use crate::reference::Trajectory;
use crate::reference::hover::Hover;
use crate::reference::{DERIVATIVE_RANGE, examine, passes_at_a_glance};
use crate::vehicle::VehicleParameters;

fn controller() -> Controller {
    let inertia = Vector3::new(2.24e-3, 2.9e-3, 5.3e-3);
    let vehicle = Vehicle::new(VehicleParameters { mass: 0.46, inertia, gravity: 9.81 }).unwrap();
    let gains = Gains::new(GainParameters::TABLE_1, &vehicle).unwrap();
    Controller::uncertified(vehicle, gains, None, 0.01).unwrap()
}

#[test]
fn a_reset_controller_is_as_good_as_new() {
    let away = State {
        position: Vector3::new(5.0, -3.0, 1.0),
        velocity: Vector3::new(0.0, 2.0, 0.0),
        attitude: Quaternion::new(-0.6, 0.0, 0.8, 0.0),
        angular_velocity: Vector3::new(1.0, 0.0, -4.0),
    };
    let reference = Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0);
    let mut used = controller();
    let first = used.step(&away, &reference).unwrap();
    for _ in 0..50 {
        used.step(&away, &reference).unwrap();
    }
    assert_ne!(used.memory(), Memory::RESET);
    used.reset();
    assert_eq!(used.memory(), Memory::RESET);
    assert_eq!(used.step(&away, &reference).unwrap(), first);
}

/// Table I's vehicle all but falling with its reference: how far p_d'' + g is above M_p, and how large the rest is.
fn plunge(climb: f32, rates: f32) -> (Controller, State, Reference) {
    let mut controller = controller();
    let m_p = controller.gains.m_p;
    let filtered = Vector3::new(m_p, -m_p, -m_p);
    controller.restore(Memory { filter: FilterState { filtered, intermediate: -filtered }, lift: None });
    let half = core::f32::consts::FRAC_1_SQRT_2;
    let attitude = Quaternion::new(half, -half, 0.0, 0.0);
    let turning = Vector3::new(-rates, rates, rates);
    let state = State { position: turning, velocity: -turning, attitude, angular_velocity: turning };
    let reference = Reference {
        position: -turning,
        velocity: turning,
        acceleration: Vector3::new(-rates, rates, m_p - controller.vehicle.gravity + climb),
        jerk: turning,
        snap: -turning,
        heading: Heading::new(nalgebra::Vector2::new(-half, half), rates, -rates).unwrap(),
    };
    (controller, state, reference)
}

/// One number of state and reference at a time, at the end of its range and beyond, and each end of the fall.
#[test]
fn what_passes_at_a_glance_passes_the_examination() {
    let controller = controller();
    let (_, still, at_rest) = plunge(0.1, 0.0);
    let fall = controller.steepest_fall;
    let sizes = [0.0, 1.0, 0.99 * DERIVATIVE_RANGE, DERIVATIVE_RANGE, 1.01 * DERIVATIVE_RANGE, 1e30];
    let strange = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX];
    let (mut glances, mut examined) = (0, 0);
    for size in sizes.into_iter().flat_map(|size| [size, -size]).chain(strange) {
        for place in 0..28 {
            let (mut state, mut reference) = (still, at_rest);
            let (mut turn, vector) = (1.0, [place % 3, 0]);
            match place / 3 {
                0 => state.position[vector[0]] = size,
                1 => state.velocity[vector[0]] = size,
                2 => state.angular_velocity[vector[0]] = size,
                3 => reference.position[vector[0]] = size,
                4 => reference.velocity[vector[0]] = size,
                5 => reference.acceleration[vector[0]] = size,
                6 => reference.jerk[vector[0]] = size,
                7 => reference.snap[vector[0]] = size,
                8 => turn = size,
                _ => reference.acceleration.z = if size > 0.0 { fall.next_up() } else { fall },
            }
            state.attitude *= turn;
            if passes_at_a_glance(&state, &reference, controller.steepest_fall) {
                glances += 1;
                assert_eq!(examine(&state, &reference, controller.steepest_fall), Ok(()), "{size} at {place}");
            } else {
                examined += 1;
            }
        }
    }
    assert!(glances > 100 && examined > 100, "{glances} {examined}");
}

#[test]
fn an_input_that_overflows_on_the_way_is_refused_and_leaves_no_trace() {
    let inertia = Vector3::new(2.24e-3, 2.9e-3, 5.3e-3);
    let star = Vehicle::new(VehicleParameters { mass: 3e38, inertia, gravity: 9.81 }).unwrap();
    let gains = Gains::new(GainParameters::TABLE_1, &star).unwrap();
    let mut controller = Controller::uncertified(star, gains, None, 0.01).unwrap();
    let (_, state, reference) = plunge(0.1, 1.0);
    let before = controller.clone();
    let refused = controller.step(&state, &reference);
    assert_eq!(refused.unwrap_err(), InputError::OutOfRange { field: "reference" });
    assert_eq!(controller, before);
}

#[test]
fn a_refused_period_leaves_the_controller_as_it_was() {
    let mut controller = controller();
    let before = controller.clone();
    for period in [0.0, -0.01, 0.11, f32::NAN, f32::INFINITY] {
        assert_eq!(controller.set_period(period).unwrap_err().field, "control.period");
    }
    assert_eq!(controller, before);
}
