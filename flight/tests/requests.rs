//! Earlier and present requests: the newest counts, and nothing that was granted is forgotten.

use crate::support::{Flight, PERIOD_US, go_to};
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use controller_core::prelude::*;
use flight::rules::SETPOINTS_REQUEST_MAX_US;
use flight::{Battery, Mode, Outcome, Output, Reason, Refusal, Request, SETPOINT_AGE_MAX_US};

/// Outside the fence.
fn far() -> Setpoint {
    go_to(5_000.0, 0.0, 2.0)
}

fn velocity(x: f32) -> Setpoint {
    Setpoint { motion: Motion::Velocity(Vector3::new(x, 0.0, 0.0)), turn: HeadingSetpoint::Keep }
}

/// A tick with a request.
fn ask(flight: &mut Flight, request: Request) -> Outcome {
    flight.inputs.request = Some(request);
    flight.tick()
}

/// Ticks in each of which a setpoint comes; the last one's outcome.
fn stream(flight: &mut Flight, setpoint: Setpoint, ticks: u64) -> Outcome {
    for _ in 1..ticks {
        flight.inputs.setpoint = Some(setpoint);
        flight.tick();
    }
    flight.inputs.setpoint = Some(setpoint);
    flight.tick()
}

/// Idling since the last tick; setpoints were requested before arming, and come.
fn idling_with_setpoints_wanted() -> Flight {
    let mut flight = Flight::settled();
    for request in [Request::FlySetpoints, Request::Arm] {
        flight.inputs.setpoint = Some(go_to(0.0, 0.0, 2.0));
        assert_eq!(ask(&mut flight, request).answer, Some(Ok(())));
    }
    assert_eq!(flight.pilot.mode(), Mode::Idling);
    flight
}

#[test]
fn setpoints_requested_before_arming_are_flown_from_arming_on() {
    let mut flight = idling_with_setpoints_wanted();
    assert_eq!(stream(&mut flight, go_to(0.0, 0.0, 2.0), 1).mode, Mode::Flying);
}

#[test]
fn a_granted_flight_that_may_not_begin_is_refused_with_a_reason() {
    let mut flight = idling_with_setpoints_wanted();
    for _ in 0..10 {
        flight.inputs.battery = Battery::Missing;
        let outcome = stream(&mut flight, go_to(0.0, 0.0, 2.0), 1);
        assert_eq!((outcome.mode, outcome.setpoint), (Mode::Idling, Some(Err(Refusal::BatteryMissing))));
    }
    assert_eq!(stream(&mut flight, go_to(0.0, 0.0, 2.0), 1).mode, Mode::Flying);
}

#[test]
fn a_landing_that_is_granted_while_idling_goes_before_setpoints_wanted_earlier() {
    let mut flight = idling_with_setpoints_wanted();
    flight.inputs.setpoint = Some(go_to(0.0, 0.0, 2.0));
    let outcome = ask(&mut flight, Request::Land);
    assert_eq!((outcome.answer, outcome.mode), (Some(Ok(())), Mode::Checks));
}

#[test]
fn a_take_off_that_is_granted_goes_before_setpoints_wanted_earlier_and_rises() {
    let mut flight = idling_with_setpoints_wanted();
    flight.inputs.setpoint = Some(go_to(0.0, 0.0, 2.0));
    let outcome = ask(&mut flight, Request::TakeOff(Some(3.0)));
    assert_eq!((outcome.answer, outcome.mode), (Some(Ok(())), Mode::TakingOff));
    let from = flight.body.position.z;
    let outcome = stream(&mut flight, go_to(0.0, 0.0, 2.0), 2_000);
    assert_eq!(outcome.mode, Mode::Holding);
    assert!((flight.body.position.z - from - 3.0).abs() < 0.1, "{}", flight.body.position.z - from);
}

#[test]
fn a_stream_that_ends_in_setpoints_that_are_refused_has_ended_all_the_same() {
    for refused in [far(), velocity(f32::NAN)] {
        let mut flight = Flight::armed();
        assert_eq!(stream(&mut flight, velocity(0.1), 50).mode, Mode::Flying);
        let mut ticks = 0;
        while flight.pilot.mode() == Mode::Flying {
            assert!(matches!(stream(&mut flight, refused, 1).setpoint, None | Some(Err(_))));
            ticks += 1;
            assert!(ticks <= SETPOINT_AGE_MAX_US / PERIOD_US, "{refused:?}");
        }
        assert_eq!((flight.pilot.mode(), ticks), (Mode::Holding, SETPOINT_AGE_MAX_US / PERIOD_US));
    }
}

#[test]
fn a_setpoint_that_is_refused_begins_no_flight_and_says_why() {
    // The fence is placed by arming.
    let mut flight = Flight::settled();
    stream(&mut flight, far(), 1);
    for request in [Request::FlySetpoints, Request::Arm] {
        flight.inputs.setpoint = Some(far());
        assert_eq!(ask(&mut flight, request).answer, Some(Ok(())));
    }
    let outcome = stream(&mut flight, far(), 10);
    assert_eq!((outcome.mode, outcome.setpoint), (Mode::Idling, Some(Err(Refusal::OutsideFence))));
    flight.inputs.setpoint = Some(far());
    let outcome = ask(&mut flight, Request::FlySetpoints);
    assert_eq!((outcome.mode, outcome.answer), (Mode::Idling, Some(Ok(()))));
    // One that may be flown does begin it.
    assert_eq!(stream(&mut flight, go_to(0.0, 0.0, 2.0), 1).mode, Mode::Flying);
    let mut flight = Flight::armed();
    assert_eq!(ask(&mut flight, Request::Hold).mode, Mode::Holding);
    flight.ticks(SETPOINT_AGE_MAX_US / PERIOD_US);
    flight.inputs.setpoint = Some(far());
    let outcome = ask(&mut flight, Request::FlySetpoints);
    assert_eq!((outcome.mode, outcome.answer), (Mode::Holding, Some(Err(Refusal::OutsideFence))));
    // What came is known for a second.
    flight.ticks(SETPOINT_AGE_MAX_US / PERIOD_US);
    assert_eq!(ask(&mut flight, Request::FlySetpoints).answer, Some(Err(Refusal::NoSetpoints)));
}

#[test]
fn any_other_request_cancels_setpoints_requested_on_the_ground() {
    for request in [Request::Disarm, Request::Hold, Request::Land, Request::TakeOff(None)] {
        let mut flight = Flight::settled();
        assert_eq!(ask(&mut flight, Request::FlySetpoints).answer, Some(Ok(())));
        ask(&mut flight, request);
        assert_eq!(ask(&mut flight, Request::Arm).answer, Some(Ok(())));
        assert_eq!(stream(&mut flight, go_to(0.0, 0.0, 2.0), 10).mode, Mode::Idling, "{request:?}");
    }
    let mut flight = Flight::settled();
    ask(&mut flight, Request::FlySetpoints);
    flight.inputs.disarm = true;
    flight.tick();
    assert_eq!(ask(&mut flight, Request::Arm).answer, Some(Ok(())));
    assert_eq!(stream(&mut flight, go_to(0.0, 0.0, 2.0), 10).mode, Mode::Idling);
}

#[test]
fn setpoints_requested_on_the_ground_stay_requested_for_five_seconds() {
    for (waited, mode) in
        [(SETPOINTS_REQUEST_MAX_US / PERIOD_US - 1, Mode::Flying), (SETPOINTS_REQUEST_MAX_US / PERIOD_US, Mode::Idling)]
    {
        let mut flight = Flight::settled();
        assert_eq!(ask(&mut flight, Request::FlySetpoints).answer, Some(Ok(())));
        flight.ticks(waited - 1);
        assert_eq!(ask(&mut flight, Request::Arm).answer, Some(Ok(())));
        assert_eq!(stream(&mut flight, go_to(0.0, 0.0, 2.0), 10).mode, mode, "{waited}");
    }
    // An armed vehicle waits for them for as long as it idles.
    let mut flight = Flight::idling();
    assert_eq!(ask(&mut flight, Request::FlySetpoints).answer, Some(Ok(())));
    flight.ticks(900);
    assert_eq!(stream(&mut flight, go_to(0.0, 0.0, 2.0), 1).mode, Mode::Flying);
}

/// Going down by the IMU alone, commanded to land meanwhile, and poses again from the next tick on.
fn commanded_to_land_without_a_pose() -> Flight {
    let mut flight = Flight::armed();
    flight.ticks(50);
    flight.present.pose = false;
    flight.until(Reason::PoseLost, 110);
    assert_eq!(ask(&mut flight, Request::Land).answer, Some(Ok(())));
    flight.ticks(30);
    flight.present.pose = true;
    flight
}

#[test]
fn a_landing_that_is_granted_without_a_pose_is_begun_when_there_is_one() {
    let mut flight = commanded_to_land_without_a_pose();
    flight.until(Reason::LandingResumed, 20);
    // Once: who holds afterwards holds.
    assert_eq!(ask(&mut flight, Request::Hold).mode, Mode::Holding);
    assert_eq!(flight.ticks(300).mode, Mode::Holding);
}

#[test]
fn a_landing_granted_without_a_pose_gives_way_to_a_later_request() {
    let mut flight = commanded_to_land_without_a_pose();
    flight.until(Reason::LandingResumed, 20);
    assert_eq!(ask(&mut flight, Request::Hold).answer, Some(Ok(())));
    assert_eq!(flight.ticks(300).mode, Mode::Holding);
    // Nor does it outlast its flight.
    let mut flight = commanded_to_land_without_a_pose();
    flight.inputs.disarm = true;
    flight.tick();
    flight.body = Flight::new().body;
    flight.ground = crate::support::GROUND_HEIGHT_M;
    flight.ticks(300);
    for request in [Request::Arm, Request::TakeOff(None)] {
        assert_eq!(ask(&mut flight, request).answer, Some(Ok(())));
    }
    assert_eq!(flight.ticks(2_000).mode, Mode::Holding);
}

#[test]
fn a_request_for_the_present_state_is_granted_and_changes_nothing() {
    let mut flight = Flight::idling();
    let outcome = ask(&mut flight, Request::Arm);
    assert_eq!((outcome.answer, outcome.mode), (Some(Ok(())), Mode::Idling));
    let from = flight.body.position.z;
    for height in [Some(3.0), Some(3.0), None] {
        let outcome = ask(&mut flight, Request::TakeOff(height));
        // Another height is another flight.
        let answer = if height.is_some() { Ok(()) } else { Err(Refusal::TakingOff) };
        assert_eq!((outcome.answer, outcome.mode), (Some(answer), Mode::TakingOff), "{height:?}");
        flight.ticks(150);
    }
    for height in [-5.0, f32::INFINITY, 1e9] {
        assert_eq!(ask(&mut flight, Request::TakeOff(Some(height))).answer, Some(Err(Refusal::TakeOffHeight)));
    }
    assert_eq!(ask(&mut flight, Request::Arm).answer, Some(Ok(())));
    assert_eq!(flight.ticks(2_000).mode, Mode::Holding);
    assert!((flight.body.position.z - from - 3.0).abs() < 0.1, "{}", flight.body.position.z - from);
    assert_eq!(ask(&mut flight, Request::Land).answer, Some(Ok(())));
    assert_eq!(ask(&mut flight, Request::Land).answer, Some(Ok(())));
}

#[test]
fn landing_a_landed_vehicle_is_refused_with_a_reason() {
    let mut flight = Flight::idling();
    for _ in 0..2 {
        assert_eq!(ask(&mut flight, Request::Land).answer, Some(Ok(())));
        assert_eq!(flight.ticks(1).output, Output::Stop);
    }
}

/// A vehicle that holds on the ground disarms within two ticks.
fn disarms(flight: &mut Flight) {
    flight.until(Reason::HeldOnGround, 1);
    let (_, landed) = flight.until(Reason::Landed, 1);
    assert_eq!((landed.output, landed.mode), (Output::Stop, Mode::Checks));
}

#[test]
fn a_hold_on_the_ground_ends_the_take_off_and_does_not_stand_there_with_thrust() {
    // While the rotors come up, and just behind that.
    for ticks in [1, 50, 99, 110] {
        let mut flight = Flight::idling();
        assert_eq!(ask(&mut flight, Request::TakeOff(None)).mode, Mode::TakingOff);
        flight.ticks(ticks);
        assert_eq!(ask(&mut flight, Request::Hold).answer, Some(Ok(())));
        disarms(&mut flight);
        flight.ticks(150);
        // It may take off again.
        for request in [Request::Arm, Request::TakeOff(None)] {
            assert_eq!(ask(&mut flight, request).answer, Some(Ok(())), "{ticks}");
        }
        assert_eq!(flight.ticks(2_000).mode, Mode::Holding);
    }
}

#[test]
fn a_station_or_a_stream_that_is_lost_on_the_ground_leaves_no_thrust_there() {
    let mut flight = Flight::idling();
    flight.present.ground_station = false;
    flight.ticks(200);
    ask(&mut flight, Request::TakeOff(None));
    flight.until(Reason::GroundStationLost, 60);
    disarms(&mut flight);
    let mut flight = idling_with_setpoints_wanted();
    assert_eq!(stream(&mut flight, velocity(0.0), 10).mode, Mode::Flying);
    flight.until(Reason::SetpointsLost, 110);
    disarms(&mut flight);
}

#[test]
fn setpoints_that_lift_nothing_off_the_ground_end_after_ten_seconds() {
    let mut flight = Flight::idling();
    assert_eq!(ask(&mut flight, Request::FlySetpoints).answer, Some(Ok(())));
    assert_eq!(stream(&mut flight, velocity(0.0), 990).mode, Mode::Flying);
    let outcome = stream(&mut flight, velocity(0.0), 20);
    assert_eq!(outcome.output, Output::Stop, "{:?}", outcome.mode);
}

#[test]
fn a_point_is_flown_to_from_the_air_only() {
    let mut flight = Flight::idling();
    ask(&mut flight, Request::TakeOff(None));
    let outcome = ask(&mut flight, Request::GoTo(go_to(0.0, 0.0, 1.0)));
    assert_eq!((outcome.answer, outcome.mode), (Some(Err(Refusal::NotInTheAir)), Mode::TakingOff));
}
