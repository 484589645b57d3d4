//! Requests and setpoints that are refused, and configurations that never arm. What arming needs is in
//! `flight_arming.rs`.

use crate::support::{
    Flight, Handed, PERIOD_US, at_rest, certified, configuration, estimator, go_to, memory, rotors, settled,
};
use controller_core::certificate::certified::Refused;
use controller_core::error::{ParameterError, Reason};
use controller_core::governor::{GovernorLimits, HeadingSetpoint, Motion, Setpoint};
use controller_core::prelude::*;
use flight::{Battery, FlightSettings, Grounded, Mode, MotorTest, Output, Pilot, Refusal, Request};

const NOW_US: u64 = 5_000_000;

#[test]
fn an_armed_vehicle_refuses_requests_and_flies_on() {
    let mut pilot = settled(NOW_US - PERIOD_US);
    Handed { request: Some(Request::Arm), ..at_rest(NOW_US) }.to(&mut pilot);
    let test = Request::MotorTest(MotorTest { rotor: 0, level: 0.1, duration: 1 });
    for (tick, request) in (1..).zip([test, test]) {
        let outcome = Handed { request: Some(request), ..at_rest(NOW_US + tick * PERIOD_US) }.to(&mut pilot);
        assert_eq!(outcome.answer, Some(Err(Refusal::AlreadyArmed)));
        assert_eq!(outcome.output, Output::Idle);
    }
}

#[test]
fn setpoints_that_make_no_sense_are_refused_where_setpoints_are_flown() {
    let mut flight = Flight::settled();
    flight.inputs.setpoint = Some(go_to(f32::NAN, 0.0, 0.0));
    assert_eq!(flight.tick().setpoint, None);
    let mut flight = Flight::armed();
    for (setpoint, refusal) in [
        (go_to(f32::NAN, 0.0, 0.0), Refusal::Setpoint("setpoint.position")),
        (go_to(100.1, 0.0, 0.0), Refusal::OutsideFence),
        (go_to(0.0, 0.0, 51.1), Refusal::OutsideFence),
        (
            Setpoint { motion: Motion::Velocity(Vector3::repeat(f32::NAN)), turn: HeadingSetpoint::Keep },
            Refusal::Setpoint("setpoint.velocity"),
        ),
        (
            Setpoint { turn: HeadingSetpoint::Rate(f32::INFINITY), ..go_to(0.0, 0.0, 0.0) },
            Refusal::Setpoint("setpoint.yaw_rate"),
        ),
    ] {
        flight.inputs.setpoint = Some(setpoint);
        let outcome = flight.tick();
        assert_eq!((outcome.setpoint, outcome.mode), (Some(Err(refusal)), Mode::Flying));
    }
}

#[test]
fn what_cannot_be_done_on_the_ground_is_refused_there() {
    let requests = [Request::Hold, Request::GoTo(go_to(1.0, 0.0, 2.0)), Request::TakeOff(None), Request::Disarm];
    let not = Err(Refusal::NotInTheAir);
    for request in requests {
        let wanted = match request {
            Request::TakeOff(_) => Err(Refusal::NotIdling),
            Request::Disarm => Ok(()),
            _ => not,
        };
        assert_eq!(Flight::settled().answer(request), wanted, "{request:?}");
    }
    for height in [0.4, 50.1, f32::NAN, f32::INFINITY, -1.0] {
        assert_eq!(Flight::idling().answer(Request::TakeOff(Some(height))), Err(Refusal::TakeOffHeight));
    }
    for (height, answer) in [(4.1, Err(Refusal::OutsideFence)), (4.0, Ok(()))] {
        let mut flight = Flight::settled();
        flight.pilot.use_settings(&FlightSettings { fence_height: 4.0, ..FlightSettings::DEFAULT });
        assert_eq!(flight.answer(Request::Arm), Ok(()));
        assert_eq!(flight.answer(Request::TakeOff(Some(height))), answer, "{height} m");
    }
}

#[test]
fn what_cannot_be_done_in_the_air_is_refused_there() {
    let mut flight = Flight::armed();
    flight.ticks(300);
    assert_eq!(flight.answer(Request::TakeOff(None)), Err(Refusal::Flies));
    for height in [-5.0, f32::INFINITY, 1e9] {
        assert_eq!(flight.answer(Request::TakeOff(Some(height))), Err(Refusal::TakeOffHeight));
    }
    assert_eq!(flight.answer(Request::GoTo(go_to(0.0, 200.0, 2.0))), Err(Refusal::OutsideFence));
    // A critical battery lands, and no request cancels that.
    flight.inputs.battery = Battery::Critical;
    for _ in 0..301 {
        flight.tick();
        flight.inputs.battery = Battery::Critical;
    }
    assert_eq!(flight.pilot.mode(), Mode::Landing);
    for request in [Request::Hold, Request::GoTo(go_to(0.0, 0.0, 2.0))] {
        flight.inputs.battery = Battery::Critical;
        assert_eq!(flight.answer(request), Err(Refusal::MustLand));
    }
    flight.inputs.battery = Battery::Critical;
    assert_eq!(flight.answer(Request::FlySetpoints), Err(Refusal::Landing));
    // Nor does a vehicle that goes down by the IMU hold: it is in the air, and knows not where.
    let mut flight = Flight::armed();
    flight.present.pose = false;
    flight.until(flight::Reason::PoseLost, 120);
    for request in [Request::Hold, Request::GoTo(go_to(0.0, 0.0, 2.0)), Request::FlySetpoints] {
        assert_eq!(flight.answer(request), Err(Refusal::WithoutPose), "{request:?}");
    }
}

/// It never arms, reports why, and tests motors nevertheless.
fn is_grounded(mut pilot: Pilot, grounded: Grounded) {
    assert_eq!(pilot.grounded(), Some(grounded));
    at_rest(NOW_US - PERIOD_US).to(&mut pilot);
    let outcome = Handed { request: Some(Request::Arm), ..at_rest(NOW_US) }.to(&mut pilot);
    assert_eq!(outcome.answer, Some(Err(Refusal::Grounded(grounded))));
    assert_eq!((outcome.output, outcome.mode), (Output::Stop, Mode::Locked));
    let test = Request::MotorTest(MotorTest { rotor: 3, level: 0.1, duration: 1_000_000 });
    let outcome = Handed { request: Some(test), ..at_rest(NOW_US) }.to(&mut pilot);
    assert_eq!(outcome.mode, Mode::MotorTest);
}

#[test]
fn a_landing_for_control_that_is_late_goes_on_for_as_long_as_it_is() {
    let mut flight = Flight::armed();
    for _ in 0..12 {
        flight.inputs.is_late = true;
        flight.tick();
    }
    assert_eq!(flight.pilot.mode(), Mode::Landing);
    for (is_late, answer) in [(true, Err(Refusal::MustLand)), (false, Ok(()))] {
        flight.inputs.is_late = is_late;
        assert_eq!(flight.answer(Request::Hold), answer);
    }
}

#[test]
fn a_configuration_that_is_not_certified_never_arms_and_the_failed_inequality_is_named() {
    let base = configuration();
    let torque_max = Vector3::new(1.0, 1.0, 0.05);
    let weak = Limits::new(LimitParameters { thrust_max: 20.0, torque_max }, base.vehicle()).unwrap();
    let weak = Configuration::new(*base.vehicle(), weak, *base.gains().unwrap(), *base.bounds()).unwrap();
    let refused = Certified::new(weak.with_rotors(rotors()).unwrap()).unwrap_err();
    let pilot = Pilot::new(
        Err(&refused),
        &GovernorLimits::default(),
        &FlightSettings::DEFAULT,
        PERIOD_US,
        estimator(),
        memory(),
    );
    let grounded = Grounded::Inequality("T2 yaw torque");
    assert_eq!(grounded.to_string(), "Not certified: T2 yaw torque");
    is_grounded(pilot, grounded);
}

#[test]
fn a_certified_configuration_that_cannot_be_flown_is_grounded_too() {
    let limits = GovernorLimits::default();
    let rotorless = Certified::new(configuration()).unwrap();
    is_grounded(
        Pilot::new(Ok(&rotorless), &limits, &FlightSettings::DEFAULT, PERIOD_US, estimator(), memory()),
        Grounded::NoRotors,
    );
    let hover = configuration().with_bounds(ReferenceBounds::REST).unwrap().with_rotors(rotors()).unwrap();
    let hover = Certified::new(hover).unwrap();
    let field = "reference_bounds.horizontal_speed";
    is_grounded(
        Pilot::new(Ok(&hover), &limits, &FlightSettings::DEFAULT, PERIOD_US, estimator(), memory()),
        Grounded::Parameter(field),
    );
    let slow = GovernorLimits { horizontal_speed: 0.0, ..limits };
    is_grounded(
        Pilot::new(Ok(&certified()), &slow, &FlightSettings::DEFAULT, PERIOD_US, estimator(), memory()),
        Grounded::Parameter("governor.horizontal_speed"),
    );
    let error = ParameterError { field: "vehicle.mass", reason: Reason::NotPositive };
    is_grounded(
        Pilot::new(
            Err(&Refused::Undefined(error)),
            &limits,
            &FlightSettings::DEFAULT,
            PERIOD_US,
            estimator(),
            memory(),
        ),
        Grounded::Parameter("vehicle.mass"),
    );
}
