//! The extended law's step as a whole: hovering, refusals, and what it learns between two of them.

use super::*;
use crate::extended::actuators::ActuatorParameters;
use crate::extended::example;
use crate::extended::parameters::ExtendedParameters;
use crate::extended::tests::Random;
use crate::heading::Heading;
use crate::reference::Trajectory;
use crate::reference::hover::Hover;

fn controller(parameters: &ExtendedParameters) -> Controller {
    let vehicle = example::vehicle();
    let parameters = Extended::new(*parameters, &vehicle).unwrap();
    let actuators = ActuatorParameters { lag: 0.0, delay: 0.0 };
    Controller::build(&vehicle, &ExtendedLaw { parameters, actuators }, Some(&example::rotors()), 0.01).unwrap()
}

#[test]
fn hovering_asks_for_the_weight_and_no_torque() {
    let mut controller = controller(&example::PARAMETERS);
    let hover = Hover::new(Vector3::new(1.0, 2.0, 3.0), Heading::FORWARD).unwrap();
    let zero = Vector3::zeros();
    let attitude = Quaternion::new(1.0, 0.0, 0.0, 0.0);
    let state = State { position: Vector3::new(1.0, 2.0, 3.0), velocity: zero, attitude, angular_velocity: zero };
    for _ in 0..500 {
        let (wrench, _) = controller.step(&state, &hover.at(0)).unwrap();
        assert!((wrench.thrust - 0.5 * 9.81).abs() < 1e-4 && wrench.torque.norm() < 1e-6, "{wrench:?}");
    }
    assert!((controller.memory().estimates.scale - 1.0).abs() < 1e-6);
}

#[test]
fn a_refused_input_leaves_no_trace_and_a_reset_none_of_what_was_flown() {
    let mut controller = controller(&example::PARAMETERS);
    let fresh = controller.clone();
    let reference = Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0);
    let mut random = Random(7);
    let mut state = State {
        position: random.vector(5.0),
        velocity: random.vector(3.0),
        attitude: random.attitude(),
        angular_velocity: random.vector(9.0),
    };
    for _ in 0..50 {
        state.velocity += random.vector(0.1);
        controller.step(&state, &reference).unwrap();
    }
    let before = controller.clone();
    let broken = State { velocity: Vector3::new(0.0, f32::NAN, 0.0), ..state };
    assert_eq!(controller.step(&broken, &reference).unwrap_err(), InputError::NotFinite { field: "state.velocity" });
    assert_eq!(controller, before);
    controller.reset();
    assert_eq!(controller, fresh);
}

#[test]
fn a_motion_beyond_all_numbers_is_refused_and_leaves_no_trace() {
    let mut controller = controller(&example::PARAMETERS);
    let mut reference = Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0);
    let (zero, attitude) = (Vector3::zeros(), Quaternion::new(1.0, 0.0, 0.0, 0.0));
    let mut state = State { position: Vector3::new(0.0, 0.0, 1e4), velocity: zero, attitude, angular_velocity: zero };
    // Far too high, and pushed upwards: filter and estimate go to the ends at which u is least.
    for _ in 0..3_000 {
        state.velocity.z += 0.3;
        controller.step(&state, &reference).unwrap();
    }
    let parameters = example::PARAMETERS;
    let fall = parameters.position.m_down + parameters.estimates.force_vertical - example::vehicle().gravity;
    let before = controller.clone();
    reference.acceleration.z = fall;
    assert_eq!(controller.step(&state, &reference).unwrap_err(), InputError::FallsTooFast);
    reference.acceleration.z = fall.next_up();
    reference.jerk = Vector3::repeat(1e6);
    let refused = controller.step(&state, &reference).unwrap_err();
    assert_eq!(refused, InputError::OutOfRange { field: "reference" });
    assert_eq!(controller, before);
}

#[test]
fn held_estimates_stay_as_they_are() {
    let mut controller = controller(&example::PARAMETERS);
    let reference = Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0);
    let zero = Vector3::zeros();
    let attitude = Quaternion::new(1.0, 0.0, 0.0, 0.0);
    let mut state = State { position: zero, velocity: zero, attitude, angular_velocity: zero };
    let mut fly = |controller: &mut Controller, ticks: u32| {
        for _ in 0..ticks {
            state.velocity.x += 0.01;
            controller.step(&state, &reference).unwrap();
        }
        controller.memory().estimates
    };
    let learnt = fly(&mut controller, 50);
    assert!(learnt.force.average.x > 0.5);
    for _ in 0..50 {
        controller.hold_estimates();
        let held = fly(&mut controller, 1);
        assert_eq!((held.force.average, held.torque, held.scale), (learnt.force.average, learnt.torque, learnt.scale));
    }
    // They go on once the wrench that acts is one that was commanded since.
    assert!(fly(&mut controller, 5).force.average.x > learnt.force.average.x);
}

/// One constant acceleration seen in ticks of two lengths in turn: the interval that has passed is the one learnt of, not the one to
/// come.
#[test]
fn what_is_learnt_of_an_interval_is_learnt_with_its_own_length() {
    let estimates = EstimateParameters { drag_across: 0.0, ..example::PARAMETERS.estimates };
    let parameters = ExtendedParameters { estimates, ..example::PARAMETERS };
    let reference = Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0);
    let (zero, attitude) = (Vector3::zeros(), Quaternion::new(1.0, 0.0, 0.0, 0.0));
    let learnt = |periods: [f32; 2]| {
        let mut controller = controller(&parameters);
        let mut state = State { position: zero, velocity: zero, attitude, angular_velocity: zero };
        for tick in 0..400 {
            let period = periods[tick % 2];
            controller.set_period(period).unwrap();
            controller.step(&state, &reference).unwrap();
            state.velocity.x += 0.5 * period;
            state.angular_velocity.z += 0.2 * period;
        }
        controller.memory().estimates
    };
    let (steady, uneven) = (learnt([0.01; 2]), learnt([0.005, 0.015]));
    assert!((uneven.force.average.x - 0.5).abs() < 1e-3, "{}", uneven.force.average.x);
    assert!((uneven.torque.z / steady.torque.z - 1.0).abs() < 0.02, "{} and {}", uneven.torque.z, steady.torque.z);
}
