extern crate std;
use super::super::tests::{at_rest, chain};
use super::*;
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use controller_core::reference::Reference;
use std::vec::Vec;

/// The limits of the references of the vehicle of the tests, horizontal; and the speed of one that rests.
const ACCELERATION_MAX_M_PER_S2: f32 = 2.4675;
const JERK_MAX_M_PER_S3: f32 = 3.876;
const REST_SPEED_M_PER_S: f32 = 1e-3;

/// A chain that flies, with its rotors brought up.
fn flying() -> Chain<'static> {
    let mut chain = chain();
    (0..100).for_each(|_| _ = chain.fly(&at_rest()));
    chain
}

fn moving(velocity: Vector3<f32>) -> State {
    State { position: Vector3::new(1.0, 2.0, 3.0), velocity, ..at_rest() }
}

/// The references from now on, until they rest.
fn references(chain: &mut Chain, state: &State) -> Vec<Reference> {
    let mut flown = Vec::new();
    while flown.last().is_none_or(|last: &Reference| last.velocity.norm() > REST_SPEED_M_PER_S) {
        flown.push(chain.fly(state).unwrap().reference);
        assert!(flown.len() < 1_000, "{:?}", flown.last());
    }
    flown
}

#[test]
fn a_velocity_is_slowed_across_and_keeps_its_direction_and_its_vertical_part() {
    let slowed = |x, y, z| slowed(&Vector3::new(x, y, z), 5.0);
    assert_eq!(slowed(3.0, -4.0, 9.0), Vector3::new(3.0, -4.0, 9.0));
    assert!((slowed(6.0, -8.0, 9.0) - Vector3::new(3.0, -4.0, 9.0)).norm() < 1e-6);
    assert_eq!(slowed(0.0, 0.0, -2.0), Vector3::new(0.0, 0.0, -2.0));
}

#[test]
fn a_hold_begins_where_and_as_fast_as_the_vehicle_is_and_ends_where_braking_takes_it() {
    let state = moving(Vector3::new(3.0, -4.0, 1.0));
    let mut chain = flying();
    chain.take_up(&at_rest()).unwrap();
    chain.regain(&state, 0.0).unwrap();
    let flown = references(&mut chain, &state);
    let (first, last) = (flown[0], flown[flown.len() - 1]);
    assert!((first.position - state.position).norm() < 0.06, "{}", first.position);
    assert!((first.velocity - state.velocity).norm() < 0.01, "{}", first.velocity);
    // v^2 / (2 a) + v a / (2 J): 5.33 and 1.51 m across from 5 m/s, 0.125 and 0.05 m up from 1 m/s.
    let (acceleration, jerk) = (0.95 * ACCELERATION_MAX_M_PER_S2, 0.95 * JERK_MAX_M_PER_S3);
    let time = 5.0 / acceleration + acceleration / jerk;
    let way = Vector3::new(3.0, -4.0, 0.0) * (0.5 * time) + Vector3::z() * 0.175;
    assert!((last.position - state.position - way).norm() < 0.001, "{}", last.position - state.position);
    assert!((flown.len() as f32 * 0.01 - time).abs() < 0.05, "{} ticks", flown.len());
}

#[test]
fn a_reference_that_brakes_stays_within_the_bounds_also_while_the_governor_sets_off() {
    let state = moving(Vector3::new(5.0, 0.0, -2.0));
    let mut chain = flying();
    chain.regain(&state, 0.0).unwrap();
    let back = Motion::Position(Vector3::new(-20.0, 0.0, 3.0));
    chain.accept(&Setpoint { motion: back, turn: HeadingSetpoint::Keep }, 0.0).unwrap();
    let flown: Vec<_> = (0..300).map(|_| chain.fly(&state).unwrap().reference).collect();
    for Reference { acceleration, jerk, snap, .. } in &flown {
        assert!(
            acceleration.xy().norm() < ACCELERATION_MAX_M_PER_S2 && acceleration.z.abs() < 0.1755,
            "{acceleration}"
        );
        assert!(jerk.norm() < JERK_MAX_M_PER_S3 && snap.norm() < 6.089, "{jerk} {snap}");
    }
    let most = flown.iter().map(|reference| -reference.acceleration.x).fold(0.0, f32::max);
    assert!(most > 0.94 * ACCELERATION_MAX_M_PER_S2, "{most}");
}

#[test]
fn a_hold_takes_a_reference_that_is_ahead_back_to_the_vehicle() {
    let mut chain = flying();
    chain.rise(1.5).unwrap();
    (0..250).for_each(|_| _ = chain.fly(&at_rest()));
    assert!(chain.governor.way_to_rest() > 0.3, "{}", chain.governor.way_to_rest());
    chain.hold(&at_rest(), 0.0);
    let flown = references(&mut chain, &at_rest());
    assert_eq!(flown[0].position, Vector3::zeros());
}

#[test]
fn what_rests_or_nearly_does_is_held_where_it_is() {
    let mut chain = flying();
    let pushed = State { velocity: Vector3::new(1.0, 0.0, 0.0), ..at_rest() };
    chain.hold(&pushed, 0.0);
    chain.land(&pushed, 0.5);
    assert_eq!(chain.fly(&pushed).unwrap().reference.position, Vector3::zeros());
}

#[test]
fn a_hold_does_not_lead_into_the_ground() {
    let state = State { position: Vector3::new(0.0, 0.0, 0.2), velocity: Vector3::new(0.0, 0.0, -2.0), ..at_rest() };
    let mut chain = flying();
    chain.regain(&state, 0.0).unwrap();
    let last = *references(&mut chain, &state).last().unwrap();
    assert!(last.position.z.abs() < 1e-6, "{}", last.position.z);
}

#[test]
fn a_landing_that_sinks_already_goes_on_as_it_does_and_never_faster_than_it_may() {
    for (sinks, goes_on) in [(-0.3, -0.3), (-2.0, -0.5), (1.0, 0.0)] {
        let state = moving(Vector3::new(0.0, 0.0, sinks));
        let mut chain = flying();
        chain.rise(1.5).unwrap();
        (0..250).for_each(|_| _ = chain.fly(&at_rest()));
        chain.land(&state, 0.5);
        (0..60).for_each(|_| _ = chain.fly(&state));
        let speed = chain.reference().velocity.z;
        // Without a command to go down it would stop: it has begun to.
        assert!(speed >= goes_on - 1e-3 && speed <= goes_on + 0.1, "{sinks}: {speed}");
    }
}

#[test]
fn a_flight_is_taken_up_no_faster_across_than_references_may_be() {
    let mut chain = flying();
    let fast = State { velocity: Vector3::new(0.0, 8.0, 0.0), ..at_rest() };
    chain.take_up(&fast).unwrap();
    let taken_up = chain.fly(&fast).unwrap().reference;
    assert!((taken_up.velocity.y - chain.speed).abs() < 0.01, "{}", taken_up.velocity);
    chain.regain(&fast, 0.0).unwrap();
    let braked = chain.fly(&fast).unwrap().reference;
    assert!((braked.velocity.y - chain.speed).abs() < 0.05, "{}", braked.velocity);
}

#[test]
fn a_vehicle_that_sinks_stops_within_what_braking_takes() {
    let sinking = |speed: f32| moving(Vector3::new(0.0, 0.0, -speed));
    let chain = flying();
    assert!(chain.stops_within(0.0, &sinking(0.2)));
    assert!(chain.stops_within(1.1, &sinking(2.0)) && !chain.stops_within(0.9, &sinking(2.0)));
}
