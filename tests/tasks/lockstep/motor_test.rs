//! The motor test: one motor, slowly, not for long, and never against a disarm command.

use super::flight::Flight;
use firmware::hardware::{MOTOR_COUNT, MotorCommand};
use flight::Mode;
use mavlink::dialects::common::MavResult;

const TICK_US: u64 = 10_000;

/// The longest test, and the greatest level.
const TEST_MAX_US: u64 = 2_000_000;
const LEVEL_MAX: f32 = 0.15;

fn ready() -> Flight {
    let mut flight = Flight::boot();
    flight.pass(1.5);
    flight
}

#[test]
fn each_motor_turns_alone_at_the_greatest_level_for_the_longest_time_and_stops() {
    for motor in 0..MOTOR_COUNT {
        let mut flight = ready();
        let begin = flight.now();
        flight.station.test_motor(motor as u8 + 1, 15.0, 2.0);
        flight.pass(0.011);
        let one = MotorCommand::One { motor, level: LEVEL_MAX };
        while flight.hardware.command() != MotorCommand::Stop {
            assert_eq!(flight.hardware.command(), one);
            assert_eq!(flight.report().mode, Mode::MotorTest);
            assert!(flight.now() - begin < 2 * TEST_MAX_US, "it does not end");
            flight.pass(0.001);
        }
        let took = flight.now() - begin;
        assert!(took.abs_diff(TEST_MAX_US) <= 2 * TICK_US, "{took} us");
        flight.pass(0.1);
        let texts: Vec<_> = flight.station.texts().into_iter().map(|(_, text)| text).collect();
        assert_eq!(texts, ["Motor test begins", "Motor test over"]);
        assert_eq!(flight.station.acknowledged(), Some(MavResult::MAV_RESULT_ACCEPTED));
        // Nothing left the ground.
        assert_eq!(flight.hardware.pose().position.z, 0.0);
    }
}

#[test]
fn a_disarm_command_ends_it_within_a_tick() {
    let mut flight = ready();
    flight.station.test_motor(2, 10.0, 2.0);
    flight.pass(0.5);
    assert!(matches!(flight.hardware.command(), MotorCommand::One { motor: 1, .. }));
    flight.station.arm(false);
    flight.pass(0.01);
    assert_eq!(flight.hardware.command(), MotorCommand::Stop);
    flight.pass(0.1);
    assert!(flight.station.received("Disarmed by command").is_some());
    flight.pass(2.0);
    assert_eq!(flight.hardware.command(), MotorCommand::Stop);
}

#[test]
fn any_other_request_ends_it_and_is_refused() {
    for arm in [true, false] {
        let mut flight = ready();
        flight.station.test_motor(2, 10.0, 2.0);
        flight.pass(0.5);
        flight.station.forget_acknowledgements();
        if arm {
            flight.station.arm(true)
        } else {
            flight.station.test_motor(3, 10.0, 2.0)
        }
        flight.pass(0.01);
        assert_eq!(flight.hardware.command(), MotorCommand::Stop);
        flight.pass(0.1);
        assert_eq!(flight.station.acknowledged(), Some(MavResult::MAV_RESULT_DENIED));
        assert!(flight.station.received("Motor test stopped by another request").is_some());
        assert_eq!(flight.hardware.command(), MotorCommand::Stop);
    }
}

#[test]
fn one_that_is_too_fast_too_long_or_of_no_motor_turns_nothing() {
    for (number, percent, seconds, words) in [
        (1, 15.1, 1.0, "Motor test refused: level not in 0 to 15 %"),
        (1, 0.0, 1.0, "Motor test refused: level not in 0 to 15 %"),
        (1, 100.0, 1.0, "Motor test refused: level not in 0 to 15 %"),
        (1, 10.0, 2.1, "Motor test refused: duration not in 0 to 2 s"),
        (1, 10.0, 0.0, "Motor test refused: duration not in 0 to 2 s"),
        (5, 10.0, 1.0, ""),
        (0, 10.0, 1.0, ""),
    ] {
        let mut flight = ready();
        flight.station.test_motor(number, percent, seconds);
        for _ in 0..20 {
            flight.pass(0.01);
            assert_eq!(flight.hardware.command(), MotorCommand::Stop, "motor {number} {percent} % {seconds} s");
        }
        assert_eq!(flight.station.acknowledged(), Some(MavResult::MAV_RESULT_DENIED));
        assert!(words.is_empty() || flight.station.received(words).is_some(), "{:?}", flight.station.texts());
    }
}

#[test]
fn none_is_run_in_flight() {
    let mut flight = Flight::in_the_air();
    flight.station.forget_acknowledgements();
    flight.station.test_motor(1, 10.0, 1.0);
    for _ in 0..20 {
        flight.pass(0.01);
        assert!(matches!(flight.hardware.command(), MotorCommand::Run(_)));
    }
    assert_eq!(flight.station.acknowledged(), Some(MavResult::MAV_RESULT_DENIED));
    assert!(flight.station.received("Refused: armed already").is_some());
}
