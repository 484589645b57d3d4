//! What is measured beside the state: used once, where it can be used, and never beyond a level.

use super::*;
use crate::allocation::remaining::LostRotor;
use crate::extended::measured::Measured;

/// Accelerates along x by 1 m/s^2 for `ticks`, while `measured` says what it likes.
fn pulled(controller: &mut Controller, ticks: u32, mut measured: impl FnMut(u32) -> Measured) -> Averages {
    let mut state = resting(Vector3::zeros());
    for tick in 0..ticks {
        controller.measured(&measured(tick));
        controller.step(&state, &hover()).unwrap();
        state.velocity.x += 0.01;
    }
    controller.memory().averages
}

fn felt(acceleration: Vector3<f32>) -> Measured {
    Measured { acceleration: Some(acceleration), wrench: None, lost: None }
}

fn turned(thrust: f32, torque: Vector3<f32>) -> Measured {
    Measured { acceleration: None, wrench: Some(Wrench { thrust, torque }), lost: None }
}

/// Pulled as velocities say, but for what is quick.
#[test]
fn an_acceleration_that_is_measured_counts_where_it_is_quick() {
    let parameters = ExtendedParameters { drag_across: 0.0, ..example::parameters() };
    let fresh = || controller(&parameters);
    // Half of B is there after ln 2 seconds.
    let half = pulled(&mut fresh(), 70, |_| felt(Vector3::new(1.0, 2.0, 0.0)));
    assert!((half.force.xy() - Vector2::new(1.0, 1.05)).norm() < 0.1, "{}", half.force);
    let lasting = pulled(&mut fresh(), 700, |_| felt(Vector3::new(1.0, 2.0, 0.0)));
    assert!((lasting.force.xy() - Vector2::new(1.0, 0.0)).norm() < 1e-2, "{}", lasting.force);
    let quick = pulled(&mut fresh(), 720, |tick| felt(Vector3::x() * if tick < 700 { 1.0 } else { 3.0 }));
    assert!(quick.force.x > 2.5, "{}", quick.force);
}

#[test]
fn what_cannot_be_used_is_as_if_it_were_absent() {
    let p = example::parameters();
    let craft = Craft::example();
    let absent = pulled(&mut build(&craft, &p), 100, |_| Measured::default());
    for absurd in [f32::NAN, f32::INFINITY, 1e30, 600.0] {
        let along = [Vector3::x(), Vector3::z()].map(|axis| axis * absurd);
        for measured in along.map(felt).into_iter().chain(along.map(|torque| turned(5.0, torque))) {
            assert_eq!(pulled(&mut build(&craft, &p), 100, |_| measured), absent, "{measured:?}");
        }
        assert_eq!(pulled(&mut build(&craft, &p), 100, |_| turned(absurd, Vector3::zeros())), absent);
    }
}

#[test]
fn what_is_measured_serves_one_step_even_a_refused_one() {
    let mut controller = controller(&example::parameters());
    pulled(&mut controller, 20, |_| Measured::default());
    let state = State { velocity: Vector3::x() * 0.2, ..resting(Vector3::zeros()) };
    let mut other = controller.clone();
    controller.measured(&felt(Vector3::y() * 5.0));
    let broken = State { velocity: Vector3::repeat(f32::NAN), ..state };
    assert!(controller.step(&broken, &hover()).is_err());
    assert_eq!(controller, other);
    controller.measured(&felt(Vector3::y() * 5.0));
    controller.step(&state, &hover()).unwrap();
    other.step(&state, &hover()).unwrap();
    assert_ne!(controller, other);
    let before = controller.memory().averages.force.y;
    controller.step(&state, &hover()).unwrap();
    assert!(controller.memory().averages.force.y < before);
}

/// Level, the thrust swinging as it is asked to swing, on rotors that lag three times as much as the law believes:
/// how far the estimated force strays from none.
fn strayed(measures: bool) -> f32 {
    let craft = Craft { actuators: ActuatorParameters { lag: 0.02, delay: 0.0 }, ..Craft::example() };
    let mut controller = build(&craft, &example::parameters());
    let (mut thrust, mut state, mut farthest) = (0.5 * 9.81, resting(Vector3::zeros()), 0.0_f32);
    let mut mean = thrust;
    for tick in 0..1_500 {
        let goal = Reference::resting(Vector3::z() * if tick / 60 % 2 == 0 { 1.0 } else { 0.0 }, Heading::FORWARD);
        if measures {
            controller.measured(&turned(mean, Vector3::zeros()));
        }
        let (wrench, _) = controller.step(&state, &goal).unwrap();
        let commanded = wrench.thrust / controller.thrust_scale();
        mean = 0.0;
        for _ in 0..10 {
            thrust += (commanded - thrust) * (0.001 / 0.06);
            state.velocity.z += (thrust / 0.5 - 9.81) * 0.001;
            state.position.z += state.velocity.z * 0.001;
            mean += thrust / 10.0;
        }
        if tick > 500 {
            farthest = farthest.max(controller.estimates().force.z.abs());
        }
    }
    farthest
}

#[test]
fn speeds_that_are_measured_keep_a_wrong_lag_out_of_the_force() {
    let (without, with) = (strayed(false), strayed(true));
    assert!(with < 0.35 * without, "{with} and {without} m/s^2");
}

/// Rotors that turn too slowly for good: what lasts has to show in the estimates, or the vehicle would sink.
#[test]
fn rotors_that_turn_slowly_for_good_leave_no_error_of_height() {
    let mut controller = build(&Craft::example(), &example::parameters());
    let mut state = resting(Vector3::zeros());
    let mut delivered = 0.5 * 9.81;
    for _ in 0..3_000 {
        controller.measured(&turned(delivered, Vector3::zeros()));
        let (wrench, _) = controller.step(&state, &hover()).unwrap();
        delivered = 0.8 * wrench.thrust / controller.thrust_scale();
        let acceleration = delivered / 0.5 - 9.81;
        state.position.z += 0.01 * (state.velocity.z + 0.005 * acceleration);
        state.velocity.z += 0.01 * acceleration;
    }
    assert!(state.position.z.abs() < 2e-3, "{}", state.position.z);
}

#[test]
fn a_rotor_that_is_said_to_be_lost_is_flown_without_once_the_motion_agrees() {
    let mut controller = controller(&example::parameters());
    let (mut state, period) = (resting(Vector3::zeros()), 0.01);
    let said = |rotor| Measured { lost: Some(LostRotor { rotor, left: 0.0 }), ..Measured::default() };
    for tick in 0..200 {
        controller.measured(&said([1, 9][tick % 2]));
        controller.step(&state, &hover()).unwrap();
    }
    assert!(controller.spinning().is_none());
    // Half of what the second rotor makes is missing.
    let missing = example::rotors().effectiveness()[1] * (0.5 * 0.25 * 0.5 * 9.81);
    let missing = missing.map(|x| x as f32);
    let turned = Vector3::new(missing.y, missing.z, missing.w).component_div(&example::vehicle().inertia);
    for _ in 0..2 {
        state.velocity.z -= missing.x / 0.5 * period;
        state.angular_velocity -= turned * period;
        controller.measured(&said(1));
        controller.step(&state, &hover()).unwrap();
    }
    let law = controller.spinning().unwrap();
    let commands = law.commands();
    assert_eq!((law.lost().rotor, commands[1]), (1, 0.0), "{commands:?}");
    assert!(commands[0] > 0.0 && commands[2] > 0.0, "{commands:?}");
    controller.reset();
    assert!(controller.spinning().is_none());
}
