//! A battery that runs down, and a fence: each ends a flight.

use super::flight::Flight;
use super::landing::check_landed;
use firmware::parameters::table::Name;
use flight::Mode;
use mavlink::dialects::common::MavResult;

const FULL_V: f32 = 12.6;
const LOW_V: f32 = 10.8;
const CRITICAL_V: f32 = 10.2;

/// A flight with a battery that is measured, and limits that the ground station has set.
fn with_a_battery() -> Flight {
    let mut flight = Flight::boot();
    flight.hardware.voltage(FULL_V);
    flight.station.set("BAT_LOW", LOW_V);
    flight.station.set("BAT_CRIT", CRITICAL_V);
    flight.pass(2.0);
    flight
}

#[test]
fn a_battery_that_stays_low_makes_it_land_once_and_a_critical_one_for_good() {
    let mut flight = with_a_battery();
    flight.go_up();
    // A burst of thrust makes it sag for a while.
    flight.hardware.voltage(LOW_V - 0.1);
    flight.pass(2.0);
    flight.hardware.voltage(FULL_V);
    flight.pass(5.0);
    assert_eq!(flight.report().mode, Mode::Flying);
    flight.hardware.voltage(LOW_V - 0.1);
    let since = flight.now();
    let landing = flight.until("Battery low: landing", 5.0);
    assert!((3_000_000..=3_300_000).contains(&(landing - since)), "{}", landing - since);
    // After the warning a request to come further is granted.
    flight.station.go_to([0.0, 0.0, 1.0]);
    flight.station.hold();
    flight.pass(0.5);
    flight.station.go_to([0.0, 0.0, 1.0]);
    flight.station.fly_setpoints();
    flight.pass(5.0);
    assert_eq!(flight.report().mode, Mode::Flying);
    flight.hardware.voltage(CRITICAL_V - 0.1);
    flight.until("Battery critical: landing", 5.0);
    flight.station.hold();
    flight.until("Refused: what made it land is still so", 0.1);
    check_landed(&mut flight, 10.0);
}

#[test]
fn a_low_battery_does_not_take_off() {
    let mut flight = with_a_battery();
    flight.hardware.voltage(LOW_V - 0.1);
    flight.pass(0.5);
    let (result, texts) = flight.ask_to_arm();
    assert_eq!((result, texts), (Some(MavResult::MAV_RESULT_DENIED), vec!["Refused: the battery is low".to_owned()]));
    flight.hardware.voltage(FULL_V);
    flight.pass(0.5);
    assert_eq!(flight.ask_to_arm().0, Some(MavResult::MAV_RESULT_ACCEPTED));
}

/// A flight in a fence of this radius and height, m, about the origin.
fn fenced(radius: f32, height: f32) -> Flight {
    Flight::in_the_air_with(&[(Name::FenceRadius, radius), (Name::FenceHeight, height)])
}

#[test]
fn a_setpoint_outside_the_fence_is_refused_and_the_vehicle_stays() {
    for outside in [[4.1, 0.0, 1.0], [0.0, -4.1, 1.0], [3.0, 3.0, 1.0], [0.0, 0.0, 3.1]] {
        let mut flight = fenced(4.0, 3.0);
        flight.station.go_to(outside);
        flight.pass(5.0);
        assert!(flight.station.received("Refused: outside the fence").is_some(), "{outside:?}");
        assert_eq!(flight.report().mode, Mode::Flying);
        assert!(flight.distance([0.0, 0.0, 1.0]) < 0.05, "{}", flight.hardware.pose().position);
        // One inside is flown.
        flight.station.go_to([2.0, 0.0, 1.0]);
        flight.pass(8.0);
        assert!(flight.distance([2.0, 0.0, 1.0]) < 0.05, "{}", flight.hardware.pose().position);
    }
}

/// How far a vehicle goes on, m, that has flown at `velocity` until `end`, us, and then holds.
fn braking_distance(velocity: [f32; 3], end: u64) -> f32 {
    let mut flight = Flight::in_the_air();
    while flight.now() < end {
        flight.station.move_at(velocity);
        flight.pass(0.1);
    }
    let begin = flight.hardware.pose().position;
    flight.station.hold();
    flight.pass(10.0);
    (flight.hardware.pose().position - begin).norm()
}

#[test]
fn a_velocity_that_leads_out_of_the_fence_ends_in_a_landing() {
    for (velocity, fence) in [([1.0, 0.0, 0.0], (4.0, 3.0)), ([0.0, 0.0, 0.5], (100.0, 3.0))] {
        let mut flight = fenced(fence.0, fence.1);
        while flight.report().mode == Mode::Flying {
            flight.station.move_at(velocity);
            flight.pass(0.1);
            assert!(flight.now() < 60_000_000, "it does not end: {}", flight.hardware.pose().position);
        }
        assert_eq!(flight.report().mode, Mode::Landing);
        let (end, begin) = (flight.now(), flight.hardware.pose().position);
        assert!(begin.xy().norm() > fence.0 || begin.z > fence.1, "{begin}");
        flight.until("Outside the fence: landing", 0.1);
        check_landed(&mut flight, 25.0);
        // Braking and sinking are one change of velocity, along one direction: that takes longer than to brake alone.
        let (gone_on, braking) =
            ((flight.hardware.pose().position - begin).xy().norm(), braking_distance(velocity, end));
        println!("{gone_on:.2} m behind the fence, by holding {braking:.2} m");
        assert!(gone_on < 2.0 * braking + 0.01, "{gone_on} m, by holding {braking} m");
    }
}
