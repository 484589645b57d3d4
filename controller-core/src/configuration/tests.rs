use super::*;
use crate::allocation::{QuadX, Rotor};
use crate::certificate::tests::paper;
use crate::extended::{actuators::ActuatorParameters, parameters::Extended, tests::example};
use nalgebra::Vector3;

/// Rotors on arms of 0.17 m, for 0.5 kg or so; their least thrust and their greatest, all together, N.
fn rotors(min: f32, max: f32) -> Rotors {
    let coefficient = 5.57e-6;
    let speed = |thrust: f32| (0.25 * thrust / coefficient).sqrt();
    let quad = QuadX {
        arm: 0.17,
        thrust_coefficient: coefficient,
        drag_coefficient: 1.36e-7,
        speed_min: speed(min),
        speed_max: speed(max),
    };
    Rotors::quad_x(quad).unwrap()
}

#[test]
fn rotors_that_cannot_hover_or_cannot_but_climb_are_refused() {
    let hover = 0.46 * 9.81;
    assert!(paper().with_rotors(rotors(0.99 * hover, 1.01 * hover)).is_ok());
    for (min, max, reason) in
        [(0.0, 0.99 * hover, Reason::NotAbove(hover)), (1.01 * hover, 3.0 * hover, Reason::NotBelow(hover))]
    {
        let error = paper().with_rotors(rotors(min, max)).unwrap_err();
        assert_eq!(error, ParameterError { field: "rotors.speed", reason });
    }
}

#[test]
fn a_floor_is_at_most_the_laws_own_least_thrust() {
    let min = paper().min_thrust();
    assert_eq!(paper().with_thrust_floor(min).unwrap().thrust_floor(), Some(min));
    let refused = |floor: f32| paper().with_thrust_floor(floor).unwrap_err();
    let field = "control.thrust_floor";
    assert_eq!(refused(min.next_up()), ParameterError { field, reason: Reason::Above(min) });
    assert_eq!(refused(0.0), ParameterError { field, reason: Reason::NotPositive });
}

#[test]
fn the_extended_law_refuses_a_rotor_that_thrust_does_not_lift() {
    let vehicle = example::vehicle();
    let law = ExtendedLaw {
        parameters: Extended::new(example::parameters(), &vehicle).unwrap(),
        actuators: ActuatorParameters { lag: 0.0, delay: 0.0 },
    };
    let limits = *paper().limits();
    let configuration = Configuration::extended(vehicle, limits, law, ReferenceBounds::REST).unwrap();
    let centred = example::rotors();
    assert!(configuration.clone().with_rotors(centred.clone()).is_ok());
    // The centre of mass behind all four: without torque those at the back push down.
    let moved: heapless::Vec<Rotor, 4> =
        centred.iter().map(|rotor| Rotor { position: rotor.position + Vector3::x() * 0.2, ..*rotor }).collect();
    let moved = Rotors::new(&moved).unwrap();
    let error = configuration.with_rotors(moved.clone()).unwrap_err();
    assert_eq!(error, ParameterError { field: "rotors.position", reason: Reason::DoesNotSpan });
    // The paper's law does not lean on thrust alone.
    assert!(paper().with_rotors(moved).is_ok());
}
