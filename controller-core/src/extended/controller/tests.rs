//! The extended law's step as a whole: hovering, refusals, what it learns between two of them, what no state makes it
//! exceed.

extern crate std;
mod demand;
mod measured;

use super::*;
use crate::allocation::MinimumNorm;
use crate::certificate::extended::ExtendedCertificate;
use crate::extended::actuators::ActuatorParameters;
use crate::extended::defaults::NOTHING_GIVEN;
use crate::extended::fallback::{PROGRESS_WINDOW_S, Slowed};
use crate::extended::parameters::ExtendedParameters;
use crate::extended::tests::Random;
use crate::extended::tests::example::{self, Craft};
use crate::heading::Heading;
use crate::reference::hover::Hover;
use crate::reference::{ReferenceBounds, Trajectory};
use crate::vehicle::LimitParameters;
use nalgebra::Vector2;

fn build(craft: &Craft, parameters: &ExtendedParameters) -> Controller {
    let (law, rotors) = (craft.law(parameters), Some(&craft.rotors));
    Controller::build(&craft.vehicle, &craft.limits, &law, rotors, craft.period).unwrap()
}

/// The Hummingbird on rotors that follow at once.
fn controller(parameters: &ExtendedParameters) -> Controller {
    let actuators = ActuatorParameters { lag: 0.0, delay: 0.0 };
    build(&Craft { actuators, ..Craft::example() }, parameters)
}

fn hover() -> Reference {
    Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0)
}

fn resting(position: Vector3<f32>) -> State {
    let (zero, attitude) = (Vector3::zeros(), Quaternion::new(1.0, 0.0, 0.0, 0.0));
    State { position, velocity: zero, attitude, angular_velocity: zero }
}

#[test]
fn hovering_commands_the_weight_and_no_torque() {
    let mut controller = build(&Craft::example(), &example::parameters());
    let hover = Hover::new(Vector3::new(1.0, 2.0, 3.0), Heading::FORWARD).unwrap();
    for _ in 0..500 {
        let (wrench, _) = controller.step(&resting(Vector3::new(1.0, 2.0, 3.0)), &hover.at(0)).unwrap();
        assert!((wrench.thrust - 0.5 * 9.81).abs() < 1e-4 && wrench.torque.norm() < 1e-6, "{wrench:?}");
    }
    assert!((controller.thrust_scale() - 1.0).abs() < 1e-6);
}

#[test]
fn rotors_that_deliver_more_than_commanded_show_no_force_once_their_scale_is_known() {
    let mut controller = build(&Craft::example(), &example::parameters());
    controller.memory.averages.scale.scale = 1.1;
    controller.restart();
    for _ in 0..300 {
        let (wrench, _) = controller.step(&resting(Vector3::zeros()), &hover()).unwrap();
        assert!((wrench.thrust - 0.5 * 9.81).abs() < 1e-4, "{wrench:?}");
    }
    assert!(controller.estimates().force.norm() < 1e-4 && controller.thrust_scale() == 1.1);
}

/// On rotors of thrust scale `truth`, level, under a constant `force` along the vertical: the state after a start 2 m
/// too high, while the scale's error never grows.
fn risen(controller: &mut Controller, truth: f32, force: f32, ticks: u32) -> State {
    let (mut state, h) = (resting(Vector3::new(0.0, 0.0, 2.0)), 0.01);
    for tick in 0..ticks {
        let before = (controller.thrust_scale() - truth).abs();
        let (wrench, _) = controller.step(&state, &hover()).unwrap();
        let after = (controller.thrust_scale() - truth).abs();
        // Rounding of velocities over a tick, where thrust hardly varies.
        assert!(after <= before + 1e-6, "tick {tick}: {after} after {before}");
        let acceleration = truth * wrench.thrust / controller.thrust_scale() / 0.5 - 9.81 + force;
        state.position.z += h * (state.velocity.z + 0.5 * h * acceleration);
        state.velocity.z += h * acceleration;
    }
    state
}

#[test]
fn from_the_first_tick_on_the_thrust_scale_never_gets_worse() {
    for (truth, force) in [(1.1, 0.0), (1.1, -1.0), (0.95, 1.0), (1.0, -2.0)] {
        let mut controller = controller(&example::parameters());
        risen(&mut controller, truth, force, 1_500);
        let left = (controller.thrust_scale() - truth).abs();
        assert!(left < 0.9 * (1.0 - truth).abs() + 1e-5, "{truth} {force}: {left}");
    }
}

#[test]
fn a_restart_keeps_what_thrust_lacks_and_forgets_the_force_across() {
    let mut controller = controller(&example::parameters());
    let state = risen(&mut controller, 1.0, -2.0, 1_500);
    controller.memory.averages.force.x = 1.0;
    controller.memory.averages.torque.y = 0.01;
    let (wrench, _) = controller.step(&state, &hover()).unwrap();
    let before = controller.estimates();
    assert!((before.force.z + 2.0).abs() < 0.01 && before.force.x > 0.5 && before.torque.y > 0.005, "{before:?}");
    controller.restart();
    let vertical = Vector3::new(0.0, 0.0, before.force.z);
    assert_eq!(controller.estimates(), Estimates { force: vertical, ..before });
    assert_eq!(controller.memory.filters, Filters::at(-vertical));
    // So the thrust goes on as it was; and nothing is learnt from before the restart.
    let (again, _) = controller.step(&state, &hover()).unwrap();
    assert!((again.thrust / wrench.thrust - 1.0).abs() < 1e-3, "{again:?} {wrench:?}");
    // What is beyond the level is not kept.
    let far = Vector3::new(0.0, 0.0, -1e3);
    controller.memory.averages.force = far;
    controller.restart();
    assert_eq!(controller.memory.averages.force, controller.learning.force.estimate(&far));
}

fn anywhere(random: &mut Random) -> State {
    State {
        position: random.vector(5.0),
        velocity: random.vector(3.0),
        attitude: random.attitude(),
        angular_velocity: random.vector(9.0),
    }
}

#[test]
fn a_refused_input_leaves_no_trace_and_a_reset_none_of_what_was_flown() {
    let mut controller = build(&Craft::example(), &example::parameters());
    let fresh = controller.clone();
    let mut random = Random(7);
    let mut state = anywhere(&mut random);
    for _ in 0..50 {
        state.velocity += random.vector(0.1);
        controller.step(&state, &hover()).unwrap();
    }
    let before = controller.clone();
    let broken = State { velocity: Vector3::new(0.0, f32::NAN, 0.0), ..state };
    assert_eq!(controller.step(&broken, &hover()).unwrap_err(), InputError::NotFinite { field: "state.velocity" });
    assert_eq!(controller, before);
    controller.reset();
    assert_eq!(controller, fresh);
}

#[test]
fn a_motion_beyond_all_numbers_is_refused_and_leaves_no_trace() {
    let p = example::parameters();
    let mut controller = controller(&p);
    let mut reference = hover();
    let mut state = resting(Vector3::new(0.0, 0.0, 1e4));
    // Far too high: the filter goes to the end at which u is least.
    for _ in 0..3_000 {
        state.velocity.z += 0.3;
        controller.step(&state, &reference).unwrap();
    }
    let fall = p.a_down - example::vehicle().gravity;
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
fn a_state_that_jumps_teaches_nothing() {
    let mut controller = controller(&example::parameters());
    let mut state = resting(Vector3::zeros());
    for _ in 0..50 {
        state.velocity.x += 0.01;
        controller.step(&state, &hover()).unwrap();
    }
    let learnt = controller.memory().averages;
    assert!(learnt.force.x > 0.5);
    for absurd in
        [State { velocity: Vector3::repeat(1e10), ..state }, State { angular_velocity: Vector3::repeat(1e8), ..state }]
    {
        for state in [absurd, state] {
            controller.step(&state, &hover()).unwrap();
            assert_eq!(controller.memory().averages, learnt);
        }
    }
}

#[test]
fn held_estimates_stay_as_they_are() {
    let mut controller = controller(&example::parameters());
    let mut state = resting(Vector3::zeros());
    let mut fly = |controller: &mut Controller, ticks: u32| {
        for _ in 0..ticks {
            state.velocity.x += 0.01;
            controller.step(&state, &hover()).unwrap();
        }
        controller.memory().averages
    };
    let learnt = fly(&mut controller, 50);
    assert!(learnt.force.x > 0.5);
    for _ in 0..50 {
        controller.hold_estimates();
        assert_eq!(fly(&mut controller, 1), learnt);
    }
    // They go on once the wrench that acts is one that was commanded since.
    assert!(fly(&mut controller, 5).force.x > learnt.force.x);
}

/// One constant acceleration seen in ticks of two lengths in turn: the interval that has passed is the one learnt of,
/// not the one to come.
#[test]
fn what_is_learnt_of_an_interval_is_learnt_with_its_own_length() {
    let parameters = ExtendedParameters { drag_across: 0.0, ..example::parameters() };
    let learnt = |periods: [f32; 2]| {
        let mut controller = controller(&parameters);
        let mut state = resting(Vector3::zeros());
        for tick in 0..400 {
            let period = periods[tick % 2];
            controller.set_period(period).unwrap();
            controller.step(&state, &hover()).unwrap();
            state.velocity.x += 0.5 * period;
            state.angular_velocity.z += 0.2 * period;
        }
        controller.memory().averages
    };
    let (steady, uneven) = (learnt([0.01; 2]), learnt([0.005, 0.015]));
    assert!((uneven.force.x - 0.5).abs() < 1e-3, "{}", uneven.force.x);
    assert!((uneven.torque.z / steady.torque.z - 1.0).abs() < 0.02, "{} and {}", uneven.torque.z, steady.torque.z);
}

/// The law's commands for `craft` with every constant by its formula, along states that jump, checked against the
/// bounds and the rotors; whether the craft is certified at rest, without which no bound holds.
fn kept_to_its_limits(craft: &Craft, ticks: u32, random: &mut Random, demands: bool) -> bool {
    let p = craft.constants(&NOTHING_GIVEN);
    let configuration = craft.configuration(&p, ReferenceBounds::REST);
    let certificate = ExtendedCertificate::new(&configuration, &craft.law(&p)).unwrap();
    if !certificate.inequalities.iter().all(|row| row.holds()) {
        return false;
    }
    let bounds = certificate.bounds;
    let mut controller = build(craft, &p);
    let rotors = MinimumNorm::new(&craft.rotors);
    let mut state = anywhere(random);
    for tick in 0..ticks {
        match random.below(60) {
            // Anywhere at once, or pushed, or turned.
            0 => state = anywhere(random),
            1 => state.position = random.vector(100.0),
            2 => state.angular_velocity = random.vector(40.0),
            _ => {
                state.velocity += random.vector(0.3);
                state.angular_velocity += random.vector(0.5);
            }
        }
        let (wrench, diagnostics) = match demands.then(|| random.below(3)) {
            None | Some(0) => controller.step(&state, &hover()),
            Some(1) => controller.step_within(&state, &hover(), &FeedbackLimits::each(random.between(0.3, 20.0))),
            Some(_) => controller.step_on_demand(&state, &hover(), &demand::any(random)),
        }
        .unwrap();
        let scale = controller.thrust_scale();
        let Wrench { thrust, torque } = wrench;
        if let Some(law) = controller.spinning() {
            // States that jump look like a rotor that fails: then limits and ranges alone hold.
            let limits = &craft.limits;
            let within = torque.zip_map(&limits.torque_max, |torque, limit| limit - torque.abs());
            assert!(thrust <= limits.thrust_max && within.min() >= 0.0, "{craft:?} {tick}: {wrench:?}");
            for (index, (command, rotor)) in law.commands().iter().zip(craft.rotors.iter()).enumerate() {
                let is_gone = index == law.lost().rotor && law.lost().left == 0.0;
                let min = if is_gone { 0.0 } else { rotor.thrust_min };
                assert!((min..=rotor.thrust_max).contains(command), "{craft:?} {tick}: {command}");
            }
            if random.below(20) == 0 {
                controller.reset();
            }
            continue;
        }
        assert!(f64::from(thrust) >= bounds.thrust.min && f64::from(thrust) <= bounds.thrust.max);
        let excess = torque.abs().map(f64::from) - bounds.torque;
        assert!(excess.max() <= 0.0, "{craft:?} {tick}: {torque} of {}", bounds.torque);
        let asked = Wrench { thrust: thrust / scale, torque: torque / scale };
        assert!(!rotors.allocate(&asked).unwrap().clipped, "{craft:?} {tick}: {asked:?} {diagnostics:?}");
    }
    true
}

#[test]
fn no_sequence_of_states_exceeds_the_limits_or_the_rotors() {
    let mut random = Random(81);
    for number in 0..60 {
        let craft = if number == 0 { Craft::example() } else { Craft::random(&mut random) };
        assert!(kept_to_its_limits(&craft, 1_500, &mut random, false), "{craft:?}");
    }
}

/// Torques that the rotors could give raise the thrust floor above a low T_max: then T_max would push a rotor below its
/// least.
#[test]
fn no_rotor_goes_below_its_least_where_the_thrust_limit_is_low() {
    let mut random = Random(83);
    let limited = |craft: Craft, thrust_max: f32| {
        let limits = LimitParameters { thrust_max, torque_max: craft.limits.torque_max * 4.0 };
        Craft { limits: Limits::new(limits, &craft.vehicle).unwrap(), ..craft }
    };
    let mut certified = 0;
    for thrust_max in [7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0] {
        let craft = limited(Craft::example(), thrust_max);
        certified += u32::from(kept_to_its_limits(&craft, 6_000, &mut random, false));
    }
    for _ in 0..40 {
        let craft = Craft::random(&mut random);
        let weight = craft.vehicle.mass * craft.vehicle.gravity;
        let craft = limited(craft, weight * random.between(1.5, 3.0));
        certified += u32::from(kept_to_its_limits(&craft, 1_500, &mut random, false));
    }
    assert!(certified > 40, "{certified}");
}

#[test]
fn a_heading_that_is_off_never_moves_the_thrust() {
    let p = example::parameters();
    let mut random = Random(84);
    let (mut turned, mut inverted) = (0, 0);
    for _ in 0..2_000 {
        let tilt = random.between(0.0, 3.1);
        let (sin, cos) = (0.5 * tilt).sin_cos();
        let state = State { attitude: Quaternion::new(cos, sin, 0.0, 0.0), ..resting(random.vector(3.0)) };
        let (east, north) = random.between(-3.1, 3.1).sin_cos();
        let heading = Heading::new(Vector2::new(north, east), 0.0, 0.0).unwrap();
        let [ahead, aside] = [Heading::FORWARD, heading].map(|heading| {
            let reference = Reference::resting(Vector3::zeros(), heading);
            controller(&p).step(&state, &reference).unwrap().0
        });
        assert!((aside.thrust - ahead.thrust).abs() < 1e-4, "{tilt}: {aside:?} {ahead:?}");
        turned += u32::from((ahead.torque.z - aside.torque.z).abs() > 1e-2);
        inverted += u32::from(ahead.thrust > 3.0 && tilt > 2.0);
    }
    assert!(turned > 100 && inverted > 500, "{turned} {inverted}");
}

#[test]
fn a_flight_without_progress_goes_on_slowed_and_on_its_own_once_it_is_near_for_a_while() {
    let craft = Craft::example();
    let p = example::parameters();
    let mut controller = build(&craft, &p);
    // Held 10 m away.
    let away = resting(Vector3::new(0.0, 10.0, 0.0));
    let mut ticks = 0;
    while controller.memory().fallback.times() == 0 {
        controller.hold_estimates();
        controller.step(&away, &hover()).unwrap();
        ticks += 1;
        assert!(ticks < 100_000);
    }
    assert!((ticks as f32 * craft.period - 2.0 * PROGRESS_WINDOW_S).abs() < 0.1, "{ticks}");
    // The filters started afresh, and away from the target c stays within M_s.
    let level = Slowed::<f64>::new(&p, craft.vehicle.gravity).level as f32;
    let mut random = Random(82);
    for _ in 0..500 {
        controller.hold_estimates();
        controller.step(&resting(random.vector(50.0)), &hover()).unwrap();
        assert!(controller.memory().fallback.is_slow());
        let c = controller.memory().filters.command;
        assert!(c.xy().norm() <= level * 1.001 && c.z.abs() <= level * 1.001, "{c} {level}");
    }
    let mut at_target = 0;
    while controller.memory().fallback.is_slow() {
        controller.hold_estimates();
        controller.step(&resting(Vector3::zeros()), &hover()).unwrap();
        at_target += 1;
        assert!(at_target < 10_000);
    }
    assert_eq!(controller.memory().fallback.times(), 1);
}
