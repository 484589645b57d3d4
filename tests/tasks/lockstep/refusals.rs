//! Arming refused, for each reason that shows on the link: the command denied, and why in words.

use super::flight::Flight;
use firmware::hardware::MotorCommand;
use mavlink::dialects::common::MavResult;
use std::f64::consts::PI;

/// A vehicle on the ground with everything that arming needs.
fn ready() -> Flight {
    let mut flight = Flight::boot();
    flight.pass(2.0);
    flight
}

fn is_refused(flight: &mut Flight, words: &str) {
    let (result, texts) = flight.ask_to_arm();
    assert_eq!(result, Some(MavResult::MAV_RESULT_DENIED), "{words}");
    assert_eq!(texts, [words]);
    flight.pass(0.1);
    assert_eq!(flight.hardware.command(), MotorCommand::Stop, "{words}");
}

fn is_granted(flight: &mut Flight) {
    let (result, texts) = flight.ask_to_arm();
    assert_eq!(result, Some(MavResult::MAV_RESULT_ACCEPTED));
    // The lock-step's poses have no clock that answers.
    assert_eq!(texts, ["Armed: idling", "Poses: delay unknown; use TIMESYNC or POSE_DELAY"]);
    assert!(matches!(flight.hardware.command(), MotorCommand::Run(_)));
}

#[test]
fn without_a_pose() {
    let mut flight = Flight::boot();
    flight.poses(false);
    flight.pass(1.5);
    is_refused(&mut flight, "Estimator: not started, no consistent poses");
    flight.poses(true);
    flight.pass(1.2);
    is_refused(&mut flight, "Refused: poses not believed for a whole second");
    flight.pass(0.5);
    is_granted(&mut flight);
}

#[test]
fn with_a_pose_that_has_just_grown_old() {
    let mut flight = ready();
    flight.poses(false);
    flight.pass(0.4);
    is_refused(&mut flight, "Estimator: no believable pose");
}

#[test]
fn on_a_slope_of_more_than_thirty_degrees_whichever_way() {
    for yaw in [0.0, 2.0] {
        for (roll, pitch) in [(31.0, 0.0), (-31.0, 0.0), (0.0, 31.0), (0.0, -31.0), (23.0, 23.0)] {
            let mut flight = ready();
            flight.hardware.set_down(f64::to_radians(roll), f64::to_radians(pitch), yaw);
            flight.pass(3.0);
            is_refused(&mut flight, "Refused: tilted by 30 degrees or more");
        }
        for (roll, pitch) in [(29.0, 0.0), (0.0, -29.0), (20.0, 20.0)] {
            let mut flight = ready();
            flight.hardware.set_down(f64::to_radians(roll), f64::to_radians(pitch), yaw);
            flight.pass(3.0);
            is_granted(&mut flight);
        }
    }
}

#[test]
fn upside_down() {
    for (roll, pitch) in [(PI, 0.0), (0.0, PI), (PI - 0.3, 0.2)] {
        let mut flight = ready();
        flight.hardware.set_down(roll, pitch, 0.5);
        flight.pass(3.0);
        is_refused(&mut flight, "Refused: tilted by 30 degrees or more");
    }
}

#[test]
fn by_a_station_that_sends_no_heartbeats() {
    let mut flight = Flight::boot();
    flight.station.beat(false);
    flight.pass(2.0);
    is_refused(&mut flight, "Refused: no ground station for 2.5 s");
    flight.station.beat(true);
    flight.pass(1.0);
    is_granted(&mut flight);
}

#[test]
fn by_a_station_whose_heartbeats_have_ceased() {
    let mut flight = ready();
    flight.station.beat(false);
    flight.pass(2.6);
    is_refused(&mut flight, "Refused: no ground station for 2.5 s");
}

#[test]
fn who_asks_twice_is_granted_twice() {
    let mut flight = ready();
    is_granted(&mut flight);
    assert_eq!(flight.ask_to_arm(), (Some(MavResult::MAV_RESULT_ACCEPTED), vec![]));
    assert!(flight.report().mode.is_armed());
}
