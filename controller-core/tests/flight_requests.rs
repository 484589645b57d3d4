//! What was asked for earlier, and what is asked for now: the newest counts, and nothing that was granted is forgotten.

mod flight;

use controller_core::flight::rules::SETPOINTS_WANTED_MAX;
use controller_core::flight::{Mode, Outcome, PERIOD, Request};
use controller_core::governor::Setpoint;
use flight::{Flight, go_to};

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

/// Idling since the last tick; setpoints were asked for before arming, and come.
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
fn setpoints_asked_for_before_arming_are_flown_from_arming_on() {
    let mut flight = idling_with_setpoints_wanted();
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
fn setpoints_asked_for_on_the_ground_are_taken_back_by_whatever_else_is_asked_for() {
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
fn setpoints_asked_for_on_the_ground_are_wanted_for_five_seconds() {
    for (waited, mode) in
        [(SETPOINTS_WANTED_MAX / PERIOD - 1, Mode::Flying), (SETPOINTS_WANTED_MAX / PERIOD, Mode::Idling)]
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

