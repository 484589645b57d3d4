//! The firmware's own tasks, minutes of flight in seconds: on a clock that moves only when every task waits.
//!
//! Nothing here but the peripherals is a stand-in: control, IMU and both halves of the link are the ones that boards
//! run.

mod battery_and_fence;
mod flight;
mod grounded;
mod hostile;
mod landing;
mod losses;
mod motor_test;
mod peripherals;
mod policy;
mod rates;
mod refusals;
mod simulated_hardware;
mod station;
mod streams;

use ::flight::Mode;
use firmware::hardware::MotorCommand;
use firmware::parameters::table::Name;
use flight::Flight;
use landing::check_landed;
use mavlink::dialects::common::MavResult;

#[test]
fn a_vehicle_on_the_ground_boots_disarmed_and_refuses_nothing() {
    let mut flight = Flight::boot();
    flight.pass(3.0);
    assert_eq!(flight.report().mode, Mode::Ready);
    assert_eq!(flight.hardware.command(), MotorCommand::Stop);
    assert_eq!(flight.station.texts(), []);
    // A stop that was written in time is all the watchdog asks for.
    assert!(flight.now() - flight.hardware.fed() <= 10_000);
}

#[test]
fn it_arms_goes_up_by_a_setpoint_hovers_steps_and_is_disarmed_by_force_alone() {
    let mut flight = Flight::in_the_air();
    assert_eq!(flight.station.acknowledged(), Some(MavResult::MAV_RESULT_ACCEPTED));
    assert!(flight.distance([0.0, 0.0, 1.0]) < 0.05, "{}", flight.hardware.pose().position);
    flight.station.go_to([1.0, 0.0, 1.0]);
    flight.pass(5.0);
    assert!(flight.distance([1.0, 0.0, 1.0]) < 0.1, "{}", flight.hardware.pose().position);
    flight.station.arm(false);
    flight.pass(0.1);
    assert_eq!(flight.station.acknowledged(), Some(MavResult::MAV_RESULT_DENIED));
    assert!(flight.station.received("Refused: in the air; land, or disarm by force").is_some());
    assert_eq!(flight.report().mode, Mode::Flying);
    flight.station.disarm_by_force();
    flight.pass(0.02);
    assert_eq!(flight.hardware.command(), MotorCommand::Stop);
    assert_eq!(flight.report().timing.missed, 0);
}

#[test]
fn it_takes_off_by_a_command_holds_and_lands_by_a_command() {
    let mut flight = Flight::boot();
    flight.pass(2.0);
    flight.station.arm(true);
    flight.pass(1.0);
    // Idling, it stays where it is.
    assert_eq!((flight.report().mode, flight.hardware.pose().position.z), (Mode::Idling, 0.0));
    let MotorCommand::Run(idle) = flight.hardware.command() else { panic!("{:?}", flight.hardware.command()) };
    assert!(idle.iter().all(|level| *level > 0.0 && *level < 0.1), "{idle:?}");
    flight.station.take_off(1.5);
    let begin = flight.now();
    let taken_off = flight.until("Take-off over: holding position", 15.0);
    assert!(flight.distance([0.0, 0.0, 1.5]) < 0.05, "{}", flight.hardware.pose().position);
    println!("took off to 1.5 m in {:.2} s", 1e-6 * (taken_off - begin) as f64);
    let mut worst = 0.0_f32;
    for _ in 0..500 {
        flight.pass(0.01);
        worst = worst.max(flight.distance([0.0, 0.0, 1.5]));
    }
    assert_eq!(flight.report().mode, Mode::Holding);
    assert!(worst < 0.02, "{worst} m");
    assert_eq!(flight.hardware.touchdown(), None);
    flight.station.land();
    flight.until("Landing by command", 0.1);
    check_landed(&mut flight, 10.0);
    assert_eq!(flight.report().timing.missed, 0);
    // It may fly again.
    flight.pass(2.0);
    assert_eq!(flight.report().mode, Mode::Ready);
    flight.go_up();
    assert!(flight.distance([0.0, 0.0, 1.0]) < 0.05, "{}", flight.hardware.pose().position);
}

#[test]
fn armed_without_a_request_it_disarms_after_ten_seconds() {
    let mut flight = Flight::boot();
    flight.pass(2.0);
    flight.station.arm(true);
    let armed = flight.until("Armed: idling", 0.1);
    let disarmed = flight.until("Disarmed: nothing commanded for 10 s", 11.0);
    assert!((disarmed - armed).abs_diff(10_000_000) <= 20_000, "{}", disarmed - armed);
    assert_eq!((flight.hardware.command(), flight.hardware.pose().position.z), (MotorCommand::Stop, 0.0));
}

#[test]
fn five_minutes_of_flight_miss_no_tick_and_stay_in_place() {
    let mut flight = Flight::in_the_air();
    for leg in 0..30 {
        let x = if leg % 2 == 0 { 1.0 } else { 0.0 };
        flight.station.go_to([x, 0.0, 1.5]);
        flight.pass(10.0);
        assert!(flight.distance([x, 0.0, 1.5]) < 0.05, "leg {leg}: {}", flight.hardware.pose().position);
    }
    let timing = flight.report().timing;
    assert_eq!((timing.missed, timing.worst_jitter), (0, 0));
    // Control got every increment of the IMU, each beginning where the one before it ended.
    assert_eq!((timing.gaps, flight.shared.lost_increments.get()), (0, 0));
    assert_eq!(flight.report().mode, Mode::Flying);
}

#[test]
fn a_pose_that_stops_is_levelled_for_a_second_and_then_the_vehicle_comes_down() {
    let mut flight = Flight::in_the_air();
    flight.poses(false);
    let last = flight.now();
    flight.pass(0.98);
    assert_eq!(flight.report().mode, Mode::Flying);
    flight.pass(0.04);
    assert_eq!(flight.report().mode, Mode::Descending);
    let lost = flight.until("Pose lost: levelling for 1 s, then going down", 0.1);
    assert!((990_000..=1_030_000).contains(&(lost - last)), "{}", lost - last);
    flight.pass(0.95);
    assert!((flight.hardware.pose().position.z - 1.0).abs() < 0.1, "{}", flight.hardware.pose().position);
    check_landed(&mut flight, 5.0);
    assert!(flight.hardware.pose().position.xy().norm() < 0.5, "{}", flight.hardware.pose().position);
}

#[test]
fn a_pose_back_after_half_a_second_is_held_on() {
    let mut flight = Flight::in_the_air();
    flight.poses(false);
    flight.pass(1.5);
    assert_eq!(flight.report().mode, Mode::Descending);
    flight.poses(true);
    flight.pass(10.0);
    assert_eq!(flight.report().mode, Mode::Holding);
    assert!(flight.distance([0.0, 0.0, 1.0]) < 0.5, "{}", flight.hardware.pose().position);
    assert!(flight.station.received("Pose regained: braking to hold position").is_some());
}

#[test]
fn a_ground_station_that_vanishes_leaves_the_vehicle_holding_its_position() {
    let mut flight = Flight::in_the_air_with(&[(Name::GroundStationPatience, 600.0)]);
    flight.station.go_to([1.0, 0.0, 1.0]);
    flight.pass(1.0);
    flight.station.beat(false);
    flight.pass(4.0);
    assert_eq!(flight.report().mode, Mode::Holding);
    assert!(flight.station.received("Ground station lost: holding position").is_some());
    flight.pass(6.0);
    let held = flight.hardware.pose().position;
    flight.pass(60.0);
    assert!((flight.hardware.pose().position - held).norm() < 0.02, "{held} {}", flight.hardware.pose().position);
    // Back again, its setpoints are not flown before it asks for that.
    flight.station.beat(true);
    flight.pass(1.5);
    flight.station.go_to([0.0, 0.0, 1.0]);
    flight.pass(5.0);
    assert_eq!(flight.report().mode, Mode::Holding);
    assert!((flight.hardware.pose().position - held).norm() < 0.02, "{held} {}", flight.hardware.pose().position);
    flight.station.fly_setpoints();
    flight.pass(0.1);
    assert!(flight.station.received("Refused: no usable setpoint in the last second").is_some());
    flight.station.go_to([0.0, 0.0, 1.0]);
    flight.station.fly_setpoints();
    flight.pass(10.0);
    assert_eq!(flight.report().mode, Mode::Flying);
    assert!(flight.distance([0.0, 0.0, 1.0]) < 0.05, "{}", flight.hardware.pose().position);
}

#[test]
fn a_ground_station_that_stays_away_for_ten_seconds_makes_it_land() {
    let mut flight = Flight::in_the_air();
    flight.pass(0.05);
    flight.station.beat(false);
    let since = flight.now();
    let lost = flight.until("Ground station lost: holding position", 3.0);
    let gone = flight.until("Ground station still lost: landing", 10.0);
    // Its last heartbeat was up to a second old.
    assert!((1_500_000..=2_510_000).contains(&(lost - since)), "{}", lost - since);
    assert!((gone - lost).abs_diff(7_500_000) <= 20_000, "{}", gone - lost);
    check_landed(&mut flight, 10.0);
}

#[test]
fn setpoints_that_move_must_be_renewed() {
    let mut flight = Flight::in_the_air();
    for _ in 0..10 {
        flight.station.move_at([0.5, 0.0, 0.0]);
        flight.pass(0.5);
    }
    assert_eq!(flight.report().mode, Mode::Flying);
    assert!(flight.hardware.pose().position.x > 1.0, "{}", flight.hardware.pose().position);
    flight.pass(0.7);
    assert_eq!(flight.report().mode, Mode::Holding);
    assert!(flight.station.received("Setpoints lost: holding position").is_some());
    flight.pass(8.0);
    assert!(flight.hardware.pose().velocity.norm() < 0.01, "{}", flight.hardware.pose().velocity);
}
