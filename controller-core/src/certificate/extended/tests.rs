use super::*;
use crate::allocation::{QuadX, Rotor, Rotors, Spin};
use crate::extended::actuators::ActuatorParameters;
use crate::extended::example;
use crate::extended::parameters::{EstimateParameters, ExtendedParameters};
use crate::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
use nalgebra::Vector3;

/// The example's vehicle under a law with these estimates, without rotors.
fn configured(estimates: EstimateParameters, references: ReferenceBounds) -> (Configuration, ExtendedLaw) {
    let vehicle = example::vehicle();
    let parameters = Extended::new(ExtendedParameters { estimates, ..example::PARAMETERS }, &vehicle).unwrap();
    let limits = LimitParameters { thrust_max: 40.0, torque_max: Vector3::new(1.0, 1.0, 0.4) };
    let limits = Limits::new(limits, &vehicle).unwrap();
    let law = ExtendedLaw { parameters, actuators: ActuatorParameters { lag: 0.0, delay: 0.0 } };
    (Configuration::extended(vehicle, limits, law, references).unwrap(), law)
}

/// The certificate of the same vehicle on `rotors`.
fn on_rotors(estimates: EstimateParameters, rotors: Rotors) -> ExtendedCertificate {
    let (configuration, law) = configured(estimates, example::REFERENCES);
    ExtendedCertificate::new(&configuration.with_rotors(rotors).unwrap(), &law).unwrap()
}

#[test]
fn every_rotor_has_a_row_and_weak_rotors_fail_theirs() {
    let estimates = example::PARAMETERS.estimates;
    let certificate = on_rotors(estimates, example::rotors());
    assert_eq!(certificate.inequalities.len(), WITHOUT_ROTORS + 4);
    assert_eq!(certificate.bounds.rotors.len(), 4);
    // Thrust beyond every rotor's is beyond the certificate: with a sixth of the thrust nothing fits.
    let weak = QuadX { speed_max: 600.0, ..example::QUAD };
    let failing = on_rotors(estimates, Rotors::quad_x(weak).unwrap());
    let rows = failing.inequalities.iter().filter(|row| row.name.starts_with('R'));
    assert_eq!(rows.filter(|row| !row.holds()).count(), 4);
}

/// A body as flat as a plate, J_y = J_x + J_z to the bit, on rotors in line with its axes: no row may be left out where a part of
/// its feed-forward vanishes.
#[test]
fn a_flat_body_has_the_floor_of_one_that_is_nearly_flat() {
    let floor = |height: f32| {
        let inertia = Vector3::new(2.0e-3, height, 2.0e-3);
        let vehicle = Vehicle::new(VehicleParameters { mass: 0.5, inertia, gravity: 9.81 }).unwrap();
        let parameters = Extended::new(example::PARAMETERS, &vehicle).unwrap();
        let limits = LimitParameters { thrust_max: 200.0, torque_max: Vector3::repeat(20.0) };
        let limits = Limits::new(limits, &vehicle).unwrap();
        let law = ExtendedLaw { parameters, actuators: ActuatorParameters { lag: 0.0, delay: 0.0 } };
        let rotor = |x: f32, y: f32, spin| Rotor {
            position: Vector3::new(x, y, 0.0),
            spin,
            thrust_coefficient: 5.57e-6,
            drag_coefficient: 1.36e-7,
            thrust_min: 0.0,
            thrust_max: 400.0,
        };
        let (forth, back) = (rotor(0.25, 0.0, Spin::Clockwise), rotor(-0.25, 0.0, Spin::Clockwise));
        let (left, right) = (rotor(0.0, 0.06, Spin::CounterClockwise), rotor(0.0, -0.06, Spin::CounterClockwise));
        let rotors = Rotors::new(&[forth, left, back, right]).unwrap();
        let references = ReferenceBounds { horizontal_acceleration: 1.0, ..ReferenceBounds::REST };
        let configuration = Configuration::extended(vehicle, limits, law, references).unwrap();
        let configuration = configuration.with_rotors(rotors).unwrap();
        ExtendedCertificate::new(&configuration, &law).unwrap().bounds.floor
    };
    let ([flat, _], [nearly, _]) = (floor(4.0e-3), floor(4.0001e-3));
    assert!((flat - nearly).abs() < 1e-3 * nearly, "{flat} and {nearly}");
}

/// The rows about `references` alone, of a law that knows a drag of `drag`, 1/s.
fn feasible(references: ReferenceBounds, drag: f32) -> [Inequality; 5] {
    let estimates = EstimateParameters { drag_across: drag, ..example::PARAMETERS.estimates };
    let (configuration, law) = configured(estimates, references);
    feasibility(&configuration, &law.parameters)
}

#[test]
fn a_reference_is_feasible_with_its_drag_or_not_at_all() {
    let (dragged, drag) = (feasible(example::REFERENCES, 0.5), 0.5);
    let with_drag = ReferenceBounds {
        horizontal_acceleration: 2.4675 + drag * 3.0,
        jerk: 3.876 + drag * 2.4675,
        snap: 6.089 + drag * 3.876,
        ..example::REFERENCES
    };
    for (row, other) in dragged.iter().zip(feasible(with_drag, 0.0)) {
        assert!((row.required - other.required).abs() < 1e-5 && row.available == other.available, "{}", row.name);
    }
    let [_, thrust, rate, acceleration, _] = dragged;
    let expected = 0.5 * (9.81 + math::hypot(2.4675 + 0.5 * 3.0, 0.1755));
    assert!((thrust.required - expected).abs() < 1e-3 * expected, "{}", thrust.required);
    assert!(thrust.holds() && thrust.available == 40.0);
    // No faster than the heading itself only where rho stays upright.
    assert!(rate.required > 1.316 && acceleration.required > 1.7318);
    let fast = ReferenceBounds { horizontal_acceleration: 75.0, ..example::REFERENCES };
    assert!(!feasible(fast, 0.0)[1].holds());
}

#[test]
fn the_only_equilibrium_is_the_target_by_the_documents_rows() {
    let attitude = AttitudeParameters { delta: 0.5, ..example::PARAMETERS.attitude };
    let [switch, tilt] = equilibrium(&attitude);
    let is = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-6, "{found}, not {expected}");
    // qbar = (1.5^2 - 1) / (1.5^2 + 1).
    let qbar = 1.25 / 3.25_f64;
    is(switch.required, qbar);
    is(switch.available, 0.1);
    is(tilt.required, 2.0 * qbar * 0.1);
    is(tilt.available, 0.6 * 0.5 * (1.0 - qbar * qbar).sqrt());
}

#[test]
fn a_reference_that_sinks_leaves_less_to_fall_with_and_more_to_carry() {
    let sinking = ReferenceBounds { vertical_acceleration: 5.0, ..example::REFERENCES };
    let [vertical, thrust, .., fall] = feasible(sinking, 0.0);
    assert!(vertical.required == 5.0 && fall.required == 2.0 && (fall.available - 4.81).abs() < 1e-5, "{fall}");
    let expected = 0.5 * (9.81 + math::hypot(2.4675, 5.0));
    assert!((thrust.required / expected - 1.0).abs() < 1e-3, "{thrust}");
}

/// What the rotors are asked for under a law that counts on these scales, each of them turning at least at 300 rad/s.
fn asked(scale_least: f32, scale_greatest: f32) -> bounds::ExtendedBounds {
    let estimates = EstimateParameters { scale_least, scale_greatest, ..example::PARAMETERS.estimates };
    let turning = QuadX { speed_min: 300.0, ..example::QUAD };
    on_rotors(estimates, Rotors::quad_x(turning).unwrap()).bounds
}

#[test]
fn rotors_that_may_give_less_are_asked_for_more_and_never_for_less_than_they_give() {
    let (exact, weak, strong) = (asked(1.0, 1.0), asked(0.8, 1.0), asked(1.0, 1.3));
    let least = 5.57e-6 * 300.0 * 300.0;
    for (rotor, (weak, strong)) in exact.rotors.iter().zip(weak.rotors.iter().zip(&strong.rotors)) {
        assert!((weak.greatest / rotor.greatest - 1.25).abs() < 1e-6, "{weak:?} and {rotor:?}");
        for of in [rotor, weak, strong] {
            assert!(of.least <= least && of.least > 0.999 * least, "{of:?}");
        }
    }
    // The floor lifts each rotor's least thrust by the scale at its most.
    assert!(strong.floor[0] - exact.floor[0] > 4.0 * 0.29 * least, "{:?} and {:?}", strong.floor, exact.floor);
}
