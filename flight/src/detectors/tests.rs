//! Each thing that is looked for, just where it begins and just before; each ends where any of its parts is
//! missing.

extern crate std;
use super::snapshot::{COMMANDED_WITHOUT_IMPACT_MAX_M_PER_S2, Snapshot};
use super::*;
use crate::PERIOD_US;
use crate::chain::Memory;
use crate::hummingbird;
use controller_core::certificate::certified::Certified;
use controller_core::governor::GovernorLimits;
use controller_core::heading::Heading;
use controller_core::state::State;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use std::boxed::Box;

/// The greatest distance from the reference that is in order.
const TRACKING_ERROR_MAX_M: f32 = 3.0;

/// A chain of the paper's law whose reference rests at the origin.
fn chain() -> Chain<'static> {
    chain_of(&hummingbird::certified())
}

fn chain_of(certified: &Certified) -> Chain<'static> {
    chain_at(certified, PERIOD_US)
}

/// The same in ticks of `period` us.
fn chain_at(certified: &Certified, period: u64) -> Chain<'static> {
    let memory = Box::leak(Box::new(Memory::EMPTY));
    let mut chain = Chain::new(certified, &GovernorLimits::default(), period, memory).unwrap();
    chain.start(&Vector3::zeros(), &Heading::FORWARD).unwrap();
    chain
}

/// A level vehicle at rest at a height, m.
fn at(height: f32) -> EstimatedState {
    let state = State {
        position: Vector3::new(0.0, 0.0, height),
        velocity: Vector3::zeros(),
        attitude: Quaternion::new(1.0, 0.0, 0.0, 0.0),
        angular_velocity: Vector3::zeros(),
    };
    EstimatedState { state, acceleration: Vector3::zeros(), jumps: 0, gained: 0.0 }
}

/// The same leaning to its right by so many degrees.
fn leaning(degrees: f32) -> EstimatedState {
    let mut estimated = at(0.0);
    estimated.state.attitude = UnitQuaternion::from_euler_angles(degrees.to_radians(), 0.0, 0.0).into_inner();
    estimated
}

/// What is seen in the last of so many ticks, of a vehicle that is in this state however it is flown.
fn seen(mode: Mode, chain: &mut Chain, estimated: &EstimatedState, ticks: u64) -> Detected {
    let mut watch = Detectors::new(PERIOD_US);
    let mut seen = Detected::default();
    for tick in 1..=ticks {
        if mode == Mode::Landing {
            chain.descend(0.5, true);
        }
        let _ = if mode == Mode::Descending { chain.fly_level(estimated, true) } else { chain.fly(&estimated.state) };
        let inputs = Inputs { now: tick * PERIOD_US, ..Inputs::default() };
        seen = watch.tick(mode, Some(estimated), Some(chain), TRACKING_ERROR_MAX_M, &inputs);
    }
    seen
}

/// Ticks in which something that takes so long, us, is so.
fn ticks(duration: u64) -> u64 {
    duration / PERIOD_US + 2
}

#[test]
fn tracking_is_lost_far_off_and_by_what_stands_half_a_metre_below() {
    let lost = |mode, estimated: &EstimatedState| {
        let seen = seen(mode, &mut chain(), estimated, ticks(TRACKING_DEBOUNCE_US));
        seen.tracking_lost
    };
    let moving = |height: f32| {
        let mut estimated = at(height);
        estimated.state.velocity.x = 0.2;
        estimated
    };
    assert!(lost(Mode::Holding, &at(3.01)) && !lost(Mode::Holding, &at(2.99)));
    assert!(lost(Mode::Holding, &at(-0.51)) && !lost(Mode::Holding, &at(-0.49)));
    assert!(!lost(Mode::Holding, &moving(-0.51)) && lost(Mode::Holding, &moving(-3.01)));
    assert!(!lost(Mode::Descending, &at(-3.01)));
}

#[test]
fn at_any_rate_a_detector_takes_as_long() {
    let certified = hummingbird::certified();
    for period in [1_000, 2_000, 4_000, 10_000, 20_000] {
        let first = |estimated: &EstimatedState, is_seen: fn(&Detected) -> bool| {
            let (mut chain, mut watch) = (chain_at(&certified, period), Detectors::new(period));
            (1..).map(|tick| tick * period).find(|&now| {
                let _ = chain.fly(&estimated.state);
                let inputs = Inputs { now, ..Inputs::default() };
                is_seen(&watch.tick(Mode::Holding, Some(estimated), Some(&chain), TRACKING_ERROR_MAX_M, &inputs))
            })
        };
        // From the first tick on.
        assert_eq!(first(&at(3.01), |seen| seen.tracking_lost), Some(period + TRACKING_DEBOUNCE_US));
        assert_eq!(first(&leaning(31.0), |seen| seen.crashed), Some(period + GROUND_DEBOUNCE_US));
    }
}

#[test]
fn a_frame_that_moves_just_after_a_crash_is_not_believed_and_without_one_it_is() {
    let thrown = |mode, struck: f32, later: u64| {
        let (mut chain, mut watch) = (chain(), Detectors::new(PERIOD_US));
        let hit = EstimatedState { acceleration: Vector3::new(0.0, 0.0, struck), ..at(0.0) };
        let moved = EstimatedState { jumps: 1, ..at(0.0) };
        let mut look = |estimated: &EstimatedState, now: u64| {
            let _ = chain.fly(&estimated.state);
            watch
                .tick(mode, Some(estimated), Some(&chain), TRACKING_ERROR_MAX_M, &Inputs { now, ..Inputs::default() })
                .tracking_lost
        };
        assert!(!look(&at(0.0), PERIOD_US) && !look(&hit, 2 * PERIOD_US));
        look(&moved, 2 * PERIOD_US + later)
    };
    assert!(thrown(Mode::Holding, 26.0, STRUCK_MEMORY_US - 1) && !thrown(Mode::Holding, 26.0, STRUCK_MEMORY_US));
    assert!(thrown(Mode::Flying, -70.0, PERIOD_US) && !thrown(Mode::Holding, 24.0, PERIOD_US));
    assert!(!thrown(Mode::Descending, 26.0, PERIOD_US));
}

#[test]
fn a_vehicle_that_lies_still_has_crashed_and_one_that_turns_has_not() {
    let crashed = |mode, estimated: &EstimatedState| {
        let seen = seen(mode, &mut chain(), estimated, ticks(GROUND_DEBOUNCE_US));
        seen.crashed
    };
    // Beside where the law wants it, which is level.
    assert!(crashed(Mode::Holding, &leaning(31.0)) && !crashed(Mode::Holding, &leaning(29.0)));
    // Idling, nothing is wanted of it.
    assert!(crashed(Mode::Idling, &leaning(61.0)) && !crashed(Mode::Idling, &leaning(59.0)));
    assert!(!crashed(Mode::Checks, &leaning(61.0)));
    let mut turning = leaning(61.0);
    turning.state.angular_velocity.y = 0.6;
    assert!(!crashed(Mode::Holding, &turning));
}

/// Held where it stands by a wind that needs such a tilt.
#[test]
fn a_vehicle_that_the_law_tilts_has_not_crashed() {
    let mut held = leaning(61.0);
    held.state.position.y = 100.0;
    let mut chain = chain_of(&Certified::new(hummingbird::extended_law()).unwrap());
    (0..200).for_each(|_| _ = chain.fly(&held.state));
    assert!(!seen(Mode::Holding, &mut chain, &held, ticks(GROUND_DEBOUNCE_US)).crashed);
    held.state.attitude = leaning(81.0).state.attitude;
    assert!(seen(Mode::Holding, &mut chain, &held, ticks(GROUND_DEBOUNCE_US)).crashed);
}

#[test]
fn what_stays_a_quarter_metre_above_its_reference_has_landed_if_it_stands() {
    // Brought up first: the reference waits for the rotors.
    let landed = |mode, speed: f32, duration: u64| {
        let (mut chain, mut estimated) = (chain(), at(0.1));
        (0..100).for_each(|_| _ = chain.fly(&estimated.state));
        estimated.state.velocity.x = speed;
        seen(mode, &mut chain, &estimated, duration).landed
    };
    assert!(landed(Mode::Landing, 0.09, 500));
    assert!(!landed(Mode::Landing, 0.11, 500), "still, but not standing");
    assert!(!landed(Mode::Landing, 0.0, 150), "the reference has hardly moved");
    assert!(!landed(Mode::Holding, 0.0, 500));
}

#[test]
fn what_has_not_left_its_place_of_arming_has_landed_as_soon_as_it_flies() {
    assert!(seen(Mode::TakingOff, &mut chain(), &at(0.04), 1).landed);
    assert!(!seen(Mode::TakingOff, &mut chain(), &at(0.06), 1).landed);
    assert!(!seen(Mode::Idling, &mut chain(), &at(0.04), 1).landed);
}

/// A chain that has been levelled, without a pose, and has gone down for a while.
fn descending(estimated: &EstimatedState) -> Chain<'static> {
    let mut chain = chain();
    (0..100).for_each(|_| _ = chain.fly(&at(1.0).state));
    chain.level(Some(0.0), false);
    (0..2_000).for_each(|_| _ = chain.fly_level(estimated, true));
    chain
}

#[test]
fn by_the_imu_alone_what_should_fall_and_rests_has_landed() {
    let landed = |change: fn(&mut EstimatedState)| {
        let mut estimated = at(0.0);
        let mut chain = descending(&estimated);
        let commanded = chain.commanded_acceleration(chain.flown().unwrap());
        assert!(commanded < COMMANDED_WITHOUT_IMPACT_MAX_M_PER_S2, "{commanded} m/s^2");
        change(&mut estimated);
        seen(Mode::Descending, &mut chain, &estimated, ticks(GROUND_DEBOUNCE_US)).landed
    };
    assert!(landed(|_| ()));
    assert!(landed(|estimated| estimated.acceleration.z = -0.39));
    assert!(!landed(|estimated| estimated.acceleration.z = -0.41), "it falls");
    assert!(landed(|estimated| estimated.state.angular_velocity.x = 0.49));
    assert!(!landed(|estimated| estimated.state.angular_velocity.x = 0.51), "it turns");
    // 0.3 m/s and what drifts in twenty seconds, either way.
    assert!(landed(|estimated| estimated.gained = 0.49) && landed(|estimated| estimated.gained = -0.49));
    assert!(!landed(|estimated| estimated.gained = 0.52) && !landed(|estimated| estimated.gained = -0.52));
}

/// Whether it is seen as landed within so many seconds from a speed, m/s, on, at which its poses were given up, with a
/// jerk, m/s^2: of a vehicle in the air, whose drag is so much of its speed in a second, or of one on the ground.
fn is_landed_after_lies(speed: f32, drag: Option<f32>, jerk: f32, seconds: u64) -> bool {
    let mut chain = chain_of(&Certified::new(hummingbird::extended_law()).unwrap());
    (0..100).for_each(|_| _ = chain.fly(&at(1.0).state));
    chain.level(Some(speed), true);
    let (mut watch, mut estimated, mut sinks) = (Detectors::new(PERIOD_US), at(0.0), speed);
    let period = PERIOD_US as f32 * 1e-6;
    (1..=seconds * 1_000_000 / PERIOD_US).any(|tick| {
        let flown = chain.fly_level(&estimated, true).unwrap();
        let acceleration = drag.map_or(0.0, |drag| chain.commanded_acceleration(&flown) - drag * sinks);
        sinks += acceleration * period;
        estimated.gained += acceleration * period;
        estimated.acceleration.z = acceleration + if tick == 1 { jerk } else { 0.0 };
        let inputs = Inputs { now: tick * PERIOD_US, ..Inputs::default() };
        watch.tick(Mode::Descending, Some(&estimated), Some(&chain), TRACKING_ERROR_MAX_M, &inputs).landed
    })
}

#[test]
fn after_lies_what_sinks_against_the_air_as_it_should_has_not_landed() {
    for drag in [0.0, 0.3, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.5] {
        for speed in [-1.0, -0.5, -0.2, -0.05, 0.0, 0.05, 0.2, 0.5, 1.0] {
            let landed = |jerk: f32| is_landed_after_lies(speed, Some(drag), jerk, 10);
            assert!(!landed(0.0) && !landed(6.0), "{drag} of {speed} m/s");
        }
    }
}

#[test]
fn after_lies_what_stands_on_a_ground_that_is_not_felt_has_landed_within_three_seconds() {
    for error in [-0.7, -0.3, 0.0, 0.3, 0.7] {
        assert!(is_landed_after_lies(error, None, 0.0, 3), "{error} m/s");
        assert!(is_landed_after_lies(error, None, 6.0, 3), "{error} m/s, with a jerk");
    }
}

#[test]
fn after_a_jerk_it_takes_less_to_have_landed_and_only_while_it_sinks() {
    let landed = |descends: bool, jerk: f32, then: Mode| {
        let mut estimated = at(0.0);
        let mut chain = chain();
        (0..100).for_each(|_| _ = chain.fly(&at(1.0).state));
        chain.level(Some(0.0), false);
        let (mut watch, mut now) = (Detectors::new(PERIOD_US), 0);
        let mut tick = |chain: &mut Chain, estimated: &EstimatedState, mode: Mode, descends: bool| {
            now += PERIOD_US;
            chain.fly_level(estimated, descends).unwrap();
            watch.tick(mode, Some(estimated), Some(chain), TRACKING_ERROR_MAX_M, &Inputs { now, ..Inputs::default() })
        };
        estimated.acceleration.z = jerk;
        tick(&mut chain, &estimated, Mode::Descending, descends);
        estimated.acceleration.z = 0.0;
        tick(&mut chain, &estimated, then, descends);
        // As long as the law commands something in between, of what is on the ground.
        for _ in 0..3_000 {
            let seen = tick(&mut chain, &estimated, Mode::Descending, true);
            let commanded = chain.commanded_acceleration(chain.flown().unwrap());
            if commanded < COMMANDED_WITHOUT_IMPACT_MAX_M_PER_S2 {
                return false;
            }
            if seen.landed {
                return true;
            }
        }
        panic!("the law never commands less");
    };
    assert!(landed(true, 5.5, Mode::Descending) && !landed(true, 4.5, Mode::Descending));
    assert!(!landed(false, 5.5, Mode::Descending), "it was only levelled");
    assert!(!landed(true, 5.5, Mode::Holding), "a jerk of an earlier descent");
}

#[test]
fn a_jerk_that_was_no_landing_is_forgotten_before_the_poses_are_given_up() {
    let touched = |later: u64| {
        let (mut chain, mut watch, mut now) = (chain(), Detectors::new(PERIOD_US), 0);
        let mut tick = |mode: Mode, acceleration: f32| {
            now += PERIOD_US;
            let mut estimated = at(1.0);
            estimated.acceleration.z = acceleration;
            chain.descend(0.5, true);
            chain.fly(&estimated.state).unwrap();
            watch
                .tick(mode, Some(&estimated), Some(&chain), TRACKING_ERROR_MAX_M, &Inputs { now, ..Inputs::default() })
                .touched
        };
        (0..200).for_each(|_| assert!(!tick(Mode::Landing, 0.0)));
        assert!(tick(Mode::Landing, 20.0));
        (1..later / PERIOD_US).for_each(|_| _ = tick(Mode::Landing, 0.0));
        tick(Mode::Descending, 0.0)
    };
    assert!(touched(IMPACT_MEMORY_US) && !touched(IMPACT_MEMORY_US + PERIOD_US));
}

/// What is seen in the last of so many ticks on the ground, at a speed of NaN, after an upward acceleration.
fn seen_after(jerk: f32, ticks: u64) -> Detected {
    let mut chain = descending(&at(0.0));
    let (mut watch, mut last, mut estimated) = (Detectors::new(PERIOD_US), Detected::default(), at(0.0));
    for tick in 1..=ticks {
        estimated.acceleration.z = if tick == 1 { jerk } else { 0.0 };
        estimated.gained = if tick == 1 { 0.0 } else { -0.55 };
        chain.fly_level(&estimated, true).unwrap();
        let inputs = Inputs { now: tick * PERIOD_US, ..Inputs::default() };
        last = watch.tick(Mode::Descending, Some(&estimated), Some(&chain), TRACKING_ERROR_MAX_M, &inputs);
    }
    last
}

#[test]
fn after_a_hit_a_speed_that_is_none_keeps_it_from_nothing() {
    let long = ticks(GROUND_DEBOUNCE_US) + 60;
    assert!(!seen_after(1.0, long).landed && seen_after(15.0, long).landed);
    assert!(!seen_after(15.0, long).imu_doubtful);
}

#[test]
fn friction_on_ground_that_was_touched_is_expected_and_more_than_that_is_not() {
    let mut estimated = at(0.0);
    let chain = descending(&estimated);
    let mut flown = *chain.flown().unwrap();
    // Half the weight is the ground's.
    flown.wrench.thrust *= 0.5;
    let carried = -chain.commanded_acceleration(&flown);
    assert!((4.5..6.0).contains(&carried), "{carried} m/s^2");
    let mut is_unexpected = |across: f32, upwards: f32, touched: bool| {
        estimated.acceleration = Vector3::new(0.6 * across, -0.8 * across, upwards);
        let look =
            Snapshot { mode: Mode::Descending, state: Some(&estimated), chain: Some(&chain), flown: Some(&flown) };
        look.is_unexpected(touched)
    };
    assert!(!is_unexpected(0.6 * carried, 0.0, true) && !is_unexpected(0.0, 0.0, true));
    assert!(is_unexpected(0.6 * carried, 0.0, false), "it has touched nothing");
    assert!(is_unexpected(1.1 * carried, 0.0, true), "no ground holds so much");
    assert!(is_unexpected(0.6 * carried, 0.5, true) && is_unexpected(0.6 * carried, -0.5, true), "nothing holds it up");
}

#[test]
fn a_low_battery_is_reported_until_it_is_acted_on() {
    let mut watch = Detectors::new(PERIOD_US);
    let look = |watch: &mut Detectors, now: u64| {
        let inputs = Inputs { now, battery: Battery::Low, ..Inputs::default() };
        watch.tick(Mode::Holding, None, None, TRACKING_ERROR_MAX_M, &inputs).battery_low
    };
    assert!(!look(&mut watch, 0) && look(&mut watch, BATTERY_DEBOUNCE_US));
    assert!(look(&mut watch, BATTERY_DEBOUNCE_US));
    watch.latch_low();
    assert!(!look(&mut watch, BATTERY_DEBOUNCE_US + PERIOD_US));
    assert!(!look(&mut watch, 9 * BATTERY_DEBOUNCE_US));
}
