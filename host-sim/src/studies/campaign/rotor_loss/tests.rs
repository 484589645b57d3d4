//! A rotor that fails in flight, and one that does not.

use super::super::outcome::Outcome;
use super::*;
use crate::flight::Flight;
use scenario::rotor_loss::PLACE_HELD_DISTANCE_M;
use scenario::verdict::Verdict;

const HUMMINGBIRD: &str = include_str!("../../../../../vehicles/hummingbird.toml");

fn scenario(sections: &str) -> Scenario {
    Scenario::parse(&format!("{}\n{sections}", HUMMINGBIRD.replace("duration = 40.0", "duration = 8.0")), "f").unwrap()
}

fn flown(scenario: &Scenario) -> Outcome {
    let verdict = Verdict::judge(scenario).unwrap();
    Outcome::judge(scenario, Flight::new(scenario).unwrap(), verdict.certificate())
}

#[test]
fn a_dead_rotor_is_found_and_the_place_is_held_with_every_rotor_in_its_range() {
    let outcome = flown(&scenario("[failure]\nrotor = 3\ntime = 2.005\n"));
    let loss = outcome.rotor;
    let (rotor, time) = loss.found.unwrap();
    assert!(rotor == 2 && (2.02..2.1).contains(&time) && !loss.is_false_alarm(), "{loss:?}");
    assert!(loss.height_lost > 0.01 && loss.height_lost < 0.5 && loss.distance < 1.0, "{loss:?}");
    assert!(outcome.tracks() && outcome.beyond == 0 && outcome.verdict(true) == "holds", "{outcome:?}");
    // It turns: it is away from its heading.
    assert!(outcome.heading.is_none() && !outcome.in_time);
}

#[test]
fn without_a_failure_none_is_found_and_none_is_missed() {
    let loss = flown(&scenario("")).rotor;
    assert_eq!((loss.failure, loss.found, loss.height_lost, loss.distance), (None, None, 0.0, 0.0));
    // One that would fail after the flight's end did not fail.
    assert_eq!(RotorLoss::before_flight(&scenario("[failure]\nrotor = 3\ntime = 9.0\n")).failure, None);
}

#[test]
fn a_false_alarm_is_a_rotor_that_had_not_failed() {
    let failing = RotorLoss::before_flight(&scenario("[failure]\nrotor = 3\ntime = 2.0\n"));
    let sound = RotorLoss::before_flight(&scenario(""));
    for (loss, found, expected) in [
        (failing, None, false),
        (failing, Some((2, 2.0)), false),
        (failing, Some((2, 1.99)), true),
        (failing, Some((1, 2.1)), true),
        (sound, None, false),
        (sound, Some((2, 2.1)), true),
    ] {
        assert_eq!(RotorLoss { found, ..loss }.is_false_alarm(), expected, "{found:?}");
    }
}

#[test]
fn a_flight_without_a_rotor_tracks_if_it_ends_near_its_place() {
    let outcome = flown(&scenario("[failure]\nrotor = 3\ntime = 2.0\n"));
    for (final_error, expected) in
        [(PLACE_HELD_DISTANCE_M, "holds"), (PLACE_HELD_DISTANCE_M + 0.01, "away"), (f64::INFINITY, "away")]
    {
        assert_eq!(Outcome { final_error, ..outcome }.verdict(true), expected, "{final_error}");
    }
    assert_eq!(Outcome { beyond: 1, ..outcome }.verdict(true), "beyond");
}

#[test]
fn height_lost_is_counted_from_the_lower_of_where_it_failed_and_the_reference() {
    let scenario = scenario("[failure]\nrotor = 1\ntime = 1.0\n");
    let mut flight = Flight::new(&scenario).unwrap();
    let tick = flight.brief_tick().unwrap();
    let at = |seconds: f64, height: f64, wanted: f32| {
        let mut tick = tick.clone();
        tick.time_us = (seconds * 1e6) as u64;
        (tick.state.position, tick.reference.position) =
            (tick.state.position.map(|_| 0.0), tick.reference.position * 0.0);
        (tick.state.position.z, tick.reference.position.z) = (height, wanted);
        tick
    };
    let lost = |ticks: &[(f64, f64, f32)]| {
        let mut loss = RotorLoss::before_flight(&scenario);
        ticks.iter().for_each(|(seconds, height, wanted)| loss.observe(&at(*seconds, *height, *wanted), None));
        (loss.height_lost, loss.distance)
    };
    assert_eq!(lost(&[(0.99, -9.0, 0.0)]), (0.0, 0.0), "before it");
    assert_eq!(lost(&[(1.0, 0.0, 0.0), (2.0, -0.5, 0.0)]), (0.5, 0.5));
    assert_eq!(lost(&[(1.0, 5.0, 0.0), (2.0, -0.5, 0.0)]), (0.5, 5.0), "it was on its way down");
    assert_eq!(lost(&[(1.0, 0.0, 0.0), (2.0, -0.5, -0.5)]), (0.0, 0.0), "the reference went down");
}

#[test]
fn a_command_outside_a_rotors_range_is_seen_and_a_lost_rotor_may_stop() {
    let text = HUMMINGBIRD.replace("speed = [0.0, 1500.0]", "speed = [100.0, 1500.0]");
    let scenario = Scenario::parse(&text, "f").unwrap();
    let rotors = scenario.configuration.rotors();
    let mut tick = Flight::new(&scenario).unwrap().brief_tick().unwrap();
    assert!(is_within_ranges(&tick, rotors, 0));
    let greatest = rotors.unwrap().iter().next().unwrap().thrust_max;
    for (thrust, lost, expected) in [
        (greatest, 0, true),
        (greatest * 1.001, 0, false),
        (greatest * 1.001, 3, false),
        (0.0, 0, false),
        (0.0, 3, true),
        (-1e-3, 3, false),
        (f32::NAN, 3, false),
    ] {
        tick.rotor_thrusts[3] = thrust;
        assert_eq!(is_within_ranges(&tick, rotors, lost), expected, "{thrust} of rotor 4, {lost} lost");
    }
    assert!(!is_within_ranges(&tick, None, 0), "more thrusts than rotors");
}
