//! The pose is lost in the middle of a fast way, not at a hover.

use super::flight::Flight;
use super::landing::check_landed;
use firmware::hardware::MotorCommand;
use flight::Mode;

/// A flight on its way to a point 20 m off, with its poses just gone.
fn lost_on_the_way() -> Flight {
    let mut flight = Flight::in_the_air();
    flight.station.go_to([20.0, 0.0, 1.0]);
    while flight.hardware.pose().velocity.x < 2.0 {
        flight.pass(0.01);
        assert!(flight.now() < 30_000_000, "it does not get fast");
    }
    flight.poses(false);
    flight
}

/// The greatest tilt from now on, rad, for so many seconds or until the motors stop.
fn worst_tilt(flight: &mut Flight, seconds: f64) -> f32 {
    let mut worst = 0.0_f32;
    let end = flight.now() + (seconds * 1e6) as u64;
    while flight.now() < end && flight.hardware.command() != MotorCommand::Stop {
        flight.pass(0.01);
        worst = worst.max(flight.hardware.tilt());
    }
    worst
}

#[test]
fn a_pose_lost_at_speed_is_levelled_and_then_goes_down() {
    let mut flight = lost_on_the_way();
    let leaning = flight.hardware.tilt();
    assert!(leaning > 0.2, "{leaning}: nothing to level");
    // By IMU alone it goes on as before.
    let coasting = worst_tilt(&mut flight, 0.9);
    assert_eq!(flight.report().mode, Mode::Flying);
    let early = worst_tilt(&mut flight, 0.5).max(coasting);
    assert_eq!(flight.report().mode, Mode::Descending);
    // These gains take 0.5 s to bring it upright, and then overshoot by half.
    let late = worst_tilt(&mut flight, 0.6);
    assert!(early < leaning + 0.02, "{leaning} {early} rad");
    assert!(late < 0.6 * leaning, "{leaning} {late} rad");
    // Levelling has kept its height, and nothing has braked it.
    let pose = flight.hardware.pose();
    assert!((2.0..5.5).contains(&pose.velocity.x), "{}", pose.velocity);
    assert!((pose.position.z - 1.0).abs() < 0.2, "{}", pose.position);
    // It comes down as fast as it drifts, and still lands.
    check_landed(&mut flight, 5.0);
}

#[test]
fn a_pose_regained_at_speed_is_braked_from_without_a_lurch() {
    for seconds in [1.05, 1.4, 1.9] {
        let mut flight = lost_on_the_way();
        let before = worst_tilt(&mut flight, seconds);
        assert_eq!(flight.report().mode, Mode::Descending);
        flight.poses(true);
        let regained = flight.hardware.pose().position;
        let after = worst_tilt(&mut flight, 20.0);
        assert_eq!(flight.report().mode, Mode::Holding);
        assert!(flight.station.received("Pose regained").is_some());
        assert!(before.max(after) < 0.4, "{before} {after} rad");
        // The old way is forgotten: it stands where braking took it.
        let pose = flight.hardware.pose();
        assert!(pose.velocity.norm() < 0.05, "{}", pose.velocity);
        assert!((0.0..16.0).contains(&(pose.position.x - regained.x)), "{regained} {}", pose.position);
        assert!((pose.position.z - 1.0).abs() < 0.5, "{}", pose.position);
    }
}

#[test]
fn what_the_law_was_correcting_when_the_pose_was_lost_is_forgotten() {
    // It climbs faster and faster when its poses are lost.
    let mut flight = Flight::in_the_air();
    flight.station.go_to([0.0, 0.0, 40.0]);
    let (begin, weight) = (flight.now(), hover_thrust());
    let thrust = |flight: &Flight| flight.report().wrench.unwrap().thrust;
    while thrust(&flight) < 1.012 * weight {
        assert!(flight.now() - begin < 5_000_000, "nothing to forget");
        flight.pass(0.01);
    }
    flight.poses(false);
    let mut last = 0.0;
    while flight.report().mode == Mode::Flying {
        last = thrust(&flight);
        flight.pass(0.01);
    }
    assert!(last > 1.01 * weight, "{last} N: nothing left to forget");
    // Levelling sets in from hover thrust; it only brakes the climb.
    let first = thrust(&flight);
    assert!(first < weight && first > 0.9 * weight, "{first} N, hover is {weight} N");
    while flight.hardware.pose().velocity.z > 0.1 {
        assert_eq!(flight.report().mode, Mode::Descending);
        assert!(thrust(&flight) < 1.003 * weight, "{} N, hover is {weight} N", thrust(&flight));
        assert!(flight.now() - begin < 15_000_000, "the climb does not end");
        flight.pass(0.01);
    }
}

/// The vehicle's weight, N.
fn hover_thrust() -> f32 {
    let configuration = firmware::configuration::embedded().unwrap();
    configuration.vehicle().mass * configuration.vehicle().gravity
}
