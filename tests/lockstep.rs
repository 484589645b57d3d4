//! The firmware's own tasks, minutes of flight in seconds: on a clock that moves only when every task waits.
//!
//! Nothing here but the peripherals is a stand-in: control, IMU and both halves of the link are the ones that boards run.

mod clock;
mod flight;
mod grounded;
mod hostile;
mod line;
mod losses;
mod motor_test;
mod peripherals;
mod refusals;
mod station;
mod world;

use controller_core::flight::Mode;
use firmware::hardware::MotorCommand;
use flight::Flight;
use mavlink::dialects::common::MavResult;

#[test]
fn a_vehicle_on_the_ground_boots_disarmed_and_refuses_nothing() {
    let mut flight = Flight::boot();
    flight.pass(3.0);
    assert_eq!(flight.report().mode, Mode::Disarmed);
    assert_eq!(flight.world.command(), MotorCommand::Stop);
    assert_eq!(flight.station.texts(), []);
    // A stop that was written in time is all the watchdog asks for.
    assert!(flight.now() - flight.world.fed() <= 10_000);
}

#[test]
fn it_arms_takes_off_hovers_steps_and_disarms() {
    let mut flight = Flight::in_the_air();
    assert_eq!(flight.station.acknowledged(), Some(MavResult::MAV_RESULT_ACCEPTED));
    assert!(flight.distance([0.0, 0.0, 1.0]) < 0.05, "{}", flight.world.pose().position);
    flight.station.go_to([1.0, 0.0, 1.0]);
    flight.pass(5.0);
    assert!(flight.distance([1.0, 0.0, 1.0]) < 0.1, "{}", flight.world.pose().position);
    flight.station.arm(false);
    flight.pass(0.02);
    assert_eq!(flight.world.command(), MotorCommand::Stop);
    assert_eq!(flight.report().timing.missed, 0);
}

#[test]
fn five_minutes_of_flight_miss_no_tick_and_stay_in_place() {
    let mut flight = Flight::in_the_air();
    for leg in 0..30 {
        let x = if leg % 2 == 0 { 1.0 } else { 0.0 };
        flight.station.go_to([x, 0.0, 1.5]);
        flight.pass(10.0);
        assert!(flight.distance([x, 0.0, 1.5]) < 0.05, "leg {leg}: {}", flight.world.pose().position);
    }
    let timing = flight.report().timing;
    assert_eq!((timing.missed, timing.worst_jitter), (0, 0));
    // Control got every increment of the IMU, each beginning where the one before it ended.
    assert_eq!((timing.gaps, flight.shared.lost_increments()), (0, 0));
    assert_eq!(flight.report().mode, Mode::Flying);
}

#[test]
fn a_pose_that_stops_is_levelled_for_a_second_and_then_stopped() {
    let mut flight = Flight::in_the_air();
    flight.poses(false);
    let last = flight.now();
    flight.pass(0.98);
    assert_eq!(flight.report().mode, Mode::Flying);
    flight.pass(0.04);
    assert_eq!(flight.report().mode, Mode::Levelling);
    flight.pass(0.95);
    assert_eq!(flight.report().mode, Mode::Levelling);
    flight.pass(0.05);
    assert_eq!((flight.report().mode, flight.world.command()), (Mode::Disarmed, MotorCommand::Stop));
    flight.pass(0.5);
    let lost = flight.station.heard("Pose lost").unwrap();
    let stopped = flight.station.heard("Stopped: no believable pose").unwrap();
    assert!((990_000..=1_030_000).contains(&(lost - last)), "{}", lost - last);
    assert!((990_000..=1_030_000).contains(&(stopped - lost)), "{}", stopped - lost);
}

#[test]
fn a_pose_back_after_half_a_second_is_flown_on() {
    let mut flight = Flight::in_the_air();
    flight.poses(false);
    flight.pass(1.5);
    assert_eq!(flight.report().mode, Mode::Levelling);
    flight.poses(true);
    flight.pass(10.0);
    assert_eq!(flight.report().mode, Mode::Flying);
    assert!(flight.distance([0.0, 0.0, 1.0]) < 0.5, "{}", flight.world.pose().position);
}

#[test]
fn a_ground_station_that_vanishes_leaves_the_vehicle_holding_its_position() {
    let mut flight = Flight::in_the_air();
    flight.station.go_to([1.0, 0.0, 1.0]);
    flight.pass(1.0);
    flight.station.beat(false);
    flight.pass(4.0);
    assert_eq!(flight.report().mode, Mode::Holding);
    assert!(flight.station.heard("Ground station lost").is_some());
    flight.pass(6.0);
    let held = flight.world.pose().position;
    flight.pass(60.0);
    assert!((flight.world.pose().position - held).norm() < 0.02, "{held} {}", flight.world.pose().position);
    // Back again, it may be flown on.
    flight.station.beat(true);
    flight.pass(1.5);
    flight.station.go_to([0.0, 0.0, 1.0]);
    flight.pass(10.0);
    assert!(flight.distance([0.0, 0.0, 1.0]) < 0.05, "{}", flight.world.pose().position);
}
