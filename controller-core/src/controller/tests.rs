//! A step leaves no trace where it is refused, and a reset none of what was flown.

use super::*;
use crate::gains::GainParameters;
use crate::heading::Heading;
use crate::reference::Trajectory;
use crate::reference::hover::Hover;
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

#[test]
fn no_usual_input_overflows() {
    let vehicle = Vehicle::new(VehicleParameters {
        mass: USUAL_VEHICLE,
        inertia: Vector3::repeat(USUAL_VEHICLE),
        gravity: USUAL_VEHICLE,
    });
    let gains = GainParameters { k_f: 999.0, k_s: 999.0, m_p: 999.0, ..GainParameters::TABLE_1 };
    let gains = Gains::new(gains, &vehicle.unwrap()).unwrap();
    let mut heavy = Controller::uncertified(vehicle.unwrap(), gains, None, 0.01).unwrap();
    for rates in [1.0, 1e2, 2e4] {
        let (mut controller, state, mut reference) = plunge(1.1 * USUAL_CLIMB, rates);
        let (wrench, diagnostics) = controller.step(&state, &reference).unwrap();
        assert!(wrench.is_finite() && diagnostics.desired_angular_acceleration.amax() < 1e28);
        heavy.restore(Memory::RESET);
        reference.acceleration.z = 1.1 * USUAL_CLIMB + gains.m_p - USUAL_VEHICLE;
        assert!(heavy.step(&state, &reference).unwrap().0.is_finite());
    }
}

#[test]
fn an_input_that_overflows_on_the_way_is_refused_and_leaves_no_trace() {
    let inertia = Vector3::new(2.24e-3, 2.9e-3, 5.3e-3);
    let star = Vehicle::new(VehicleParameters { mass: 3e38, inertia, gravity: 9.81 }).unwrap();
    let gains = Gains::new(GainParameters::TABLE_1, &star).unwrap();
    let mut controller = Controller::uncertified(star, gains, None, 0.01).unwrap();
    let (_, state, reference) = plunge(USUAL_CLIMB, 1.0);
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
