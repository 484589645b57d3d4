//! What the campaign has found: each flight here once ended as it must not.

use super::failure::Failure;
use super::phase::Phase;
use super::run::{Case, Flown, fly};
use super::{FLIGHT_HEIGHT, FLIGHT_SETTINGS, Vehicle, vehicle};
use flight::{FlightSettings, Reason};

/// Flies a case on the study, and holds it to what must follow.
fn flown(phase: Phase, first: Failure, second: Option<(Failure, u64)>) -> Flown {
    let flown = fly(&vehicle("study"), Case { phase, first, second, height: FLIGHT_HEIGHT });
    assert!(flown.complaints.is_empty(), "{:?}: {:?}", flown.complaints, flown.path);
    flown
}

/// When something happened first, s after the failure.
fn since(flown: &Flown, reason: Reason) -> Option<f64> {
    flown.path.iter().find(|(transition, _)| transition.reason == reason).map(|(_, since)| *since)
}

#[test]
fn a_vehicle_that_turns_round_in_an_updraft_has_not_landed() {
    // Its reference went on down while it rose, came to rest and began to sink: motors stopped 4.5 m above the ground.
    let flown = flown(Phase::Holding, Failure::Updraft, None);
    assert!(since(&flown, Reason::FenceBreached).is_some() && since(&flown, Reason::Landed).is_some());
}

#[test]
fn a_vehicle_that_sinks_against_the_airs_drag_has_not_landed() {
    // By the IMU alone a drag of 0.8 m/s^2 was taken for the ground: motors stopped 8 m above it.
    let settings = FlightSettings { fence_height: 50.0, ..FLIGHT_SETTINGS };
    let vehicle = Vehicle { settings, ..vehicle("study") };
    for (first, second) in [(Failure::PoseLost, None), (Failure::PoseLost, Some((Failure::Thermal, 300)))] {
        let flown = fly(&vehicle, Case { phase: Phase::AtPoint, first, second, height: 12.0 });
        assert!(flown.complaints.is_empty(), "{:?}: {:?}", flown.complaints, flown.path);
        println!("from 12 m: down after {:?} s, at {:?} m/s", since(&flown, Reason::Landed), flown.touchdown);
    }
}

#[test]
fn a_vehicle_that_an_updraft_all_but_stops_in_its_descent_has_not_landed() {
    // It stood at 0.15 m/s, and the law commanded a fall: motors stopped 1.3 m above the ground.
    flown(Phase::Descending, Failure::Thermal, None);
}

#[test]
fn a_take_off_that_does_not_leave_the_ground_ends() {
    // It held its position on the ground, with its rotors turning, for as long as its reference was within reach.
    let flown = flown(Phase::Spooling, Failure::HeldDown, None);
    assert!(since(&flown, Reason::HeldOnGround).is_some_and(|since| since < 9.0), "{:?}", flown.path);
}

#[test]
fn a_vehicle_that_leans_on_something_has_crashed() {
    // Only 60 degrees were a crash; the legs put a vehicle upright from 30.
    let flown = flown(Phase::Spooling, Failure::Leaned, None);
    assert!(since(&flown, Reason::Crashed).is_some_and(|since| since < 2.0), "{:?}", flown.path);
}

#[test]
fn a_battery_that_is_low_and_critical_by_turns_is_low() {
    let flown = flown(Phase::Holding, Failure::BatteryWavers, None);
    assert!(since(&flown, Reason::BatteryLow).is_some_and(|since| since < 3.05), "{:?}", flown.path);
}

#[test]
fn a_landing_for_a_low_battery_goes_on_when_poses_come_back() {
    // It held its position until the battery was critical.
    let flown = flown(Phase::Holding, Failure::BatteryLow, Some((Failure::PoseOutage, 350)));
    let reasons: Vec<Reason> = flown.path.iter().map(|(transition, _)| transition.reason).collect();
    assert_eq!(reasons, [Reason::BatteryLow, Reason::PoseLost, Reason::LandingResumed, Reason::Landed]);
}

#[test]
fn poses_that_freeze_in_a_quiet_hover_are_found_out() {
    // They were believed for 12 s, and taught the accelerometer a bias with which going down by it led up.
    let flown = flown(Phase::AtPoint, Failure::PoseFreezes, None);
    assert!(since(&flown, Reason::PoseLost).is_some_and(|since| since < 1.3), "{:?}", flown.path);
    super::found::flown(Phase::AtPoint, Failure::PoseFreezes, Some((Failure::PoseOutage, 0)));
}

#[test]
fn a_take_off_goes_on_in_a_frame_that_has_moved() {
    // It stayed where it was, taking off for ever.
    for phase in [Phase::Spooling, Phase::Climbing] {
        let flown = flown(phase, Failure::FrameMoves, None);
        assert!(since(&flown, Reason::TakenOff).is_some_and(|since| since < 12.0), "{:?}", flown.path);
    }
}
