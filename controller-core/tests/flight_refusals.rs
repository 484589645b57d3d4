//! Every refusal, brought about from outside, and what it leaves behind: a disarmed vehicle that can still be armed.

mod flight;

use controller_core::certificate::certified::Refused;
use controller_core::error::{ParameterError, Reason};
use controller_core::flight::{
    Grounded, Inputs, Mode, MotorTest, Output, PERIOD, Pilot, Pose, Refusal, Request, STAMP_LEAD_MAX, Stamped,
};
use controller_core::governor::{GovernorLimits, Setpoint, Turn};
use controller_core::prelude::*;
use flight::{at_rest, certified, configuration, go_to, memory, pilot, pose, rotors};

const NOW: u64 = 5_000_000;

/// Arming refused with these inputs, for this; and permitted a tick later without them.
fn refuses(inputs: Inputs, refusal: Refusal) {
    let mut pilot = pilot();
    let outcome = pilot.tick(&Inputs { request: Some(Request::Arm), ..inputs });
    assert_eq!(outcome.answer, Some(Err(refusal)));
    assert_eq!((outcome.output, outcome.mode, outcome.transition), (Output::Stop, Mode::Disarmed, None));
    let later = pilot.tick(&Inputs { request: Some(Request::Arm), ..at_rest(NOW + 3 * PERIOD) });
    assert_eq!((later.answer, later.mode), (Some(Ok(())), Mode::Flying), "after {refusal:?}");
}

/// The inputs of a vehicle at rest with its pose changed.
fn with_pose(change: impl FnOnce(&mut Stamped<Pose>)) -> Inputs {
    let mut inputs = at_rest(NOW);
    change(inputs.pose.as_mut().unwrap());
    inputs
}

fn with_imu(change: impl FnOnce(&mut Stamped<controller_core::flight::ImuSample>)) -> Inputs {
    let mut inputs = at_rest(NOW);
    change(inputs.imu.as_mut().unwrap());
    inputs
}

/// A roll of `degrees`.
fn rolled(degrees: f32) -> Quaternion<f32> {
    let half = degrees.to_radians() / 2.0;
    Quaternion::new(half.cos(), half.sin(), 0.0, 0.0)
}

/// A vehicle at rest at the origin.
fn turned(attitude: Quaternion<f32>) -> Pose {
    pose(Vector3::zeros(), Vector3::zeros(), attitude)
}

#[test]
fn arming_is_refused_without_fresh_measurements() {
    refuses(Inputs { imu: None, ..at_rest(NOW) }, Refusal::ImuStale);
    refuses(with_imu(|imu| imu.time = NOW - 20_001), Refusal::ImuStale);
    refuses(Inputs { pose: None, ..at_rest(NOW) }, Refusal::PoseStale);
    refuses(with_pose(|pose| pose.time = NOW - 100_000), Refusal::PoseStale);
}

#[test]
fn arming_is_refused_with_measurements_that_make_no_sense() {
    refuses(with_imu(|imu| imu.value.angular_velocity.y = f32::NAN), Refusal::Unusable("imu.angular_velocity"));
    refuses(with_imu(|imu| imu.value.angular_velocity.x = 101.0), Refusal::Unusable("imu.angular_velocity"));
    refuses(with_imu(|imu| imu.value.specific_force.z = f32::INFINITY), Refusal::Unusable("imu.specific_force"));
    refuses(with_imu(|imu| imu.time = NOW + STAMP_LEAD_MAX + 1), Refusal::Unusable("imu.time"));
    refuses(with_pose(|pose| pose.time = NOW + STAMP_LEAD_MAX + 1), Refusal::Unusable("pose.time"));
}

#[test]
fn arming_is_refused_at_a_tilt_of_thirty_degrees_and_not_just_below() {
    refuses(with_pose(|pose| pose.value = turned(rolled(30.01))), Refusal::Tilted);
    refuses(with_pose(|pose| pose.value = turned(-rolled(-90.0))), Refusal::Tilted);
    let inputs = with_pose(|pose| pose.value = turned(-rolled(29.99)));
    assert_eq!(pilot().tick(&Inputs { request: Some(Request::Arm), ..inputs }).answer, Some(Ok(())));
}

#[test]
fn arming_is_refused_without_a_ground_station_or_against_a_disarm_command() {
    refuses(Inputs { ground_station: None, ..at_rest(NOW) }, Refusal::GroundStationSilent);
    refuses(Inputs { ground_station: Some(NOW - 2_500_000), ..at_rest(NOW) }, Refusal::GroundStationSilent);
    refuses(Inputs { ground_station: Some(NOW + 1_000_000), ..at_rest(NOW) }, Refusal::GroundStationSilent);
    refuses(Inputs { disarm: true, ..at_rest(NOW) }, Refusal::DisarmCommanded);
}

#[test]
fn an_armed_vehicle_refuses_requests_and_flies_on() {
    let mut pilot = pilot();
    pilot.tick(&Inputs { request: Some(Request::Arm), ..at_rest(NOW) });
    for request in [Request::Arm, Request::MotorTest(MotorTest { rotor: 0, level: 0.1, duration: 1 })] {
        let outcome = pilot.tick(&Inputs { request: Some(request), ..at_rest(NOW + PERIOD) });
        assert_eq!(outcome.answer, Some(Err(Refusal::AlreadyArmed)));
        assert!(matches!(outcome.output, Output::Thrusts(_)));
    }
}

#[test]
fn motor_tests_of_other_rotors_levels_or_durations_are_refused() {
    let good = MotorTest { rotor: 3, level: 0.15, duration: 2_000_000 };
    for (test, refusal) in [
        (MotorTest { rotor: 4, ..good }, Refusal::NoSuchRotor),
        (MotorTest { rotor: usize::MAX, ..good }, Refusal::NoSuchRotor),
        (MotorTest { level: 0.151, ..good }, Refusal::MotorTestLevel),
        (MotorTest { level: 0.0, ..good }, Refusal::MotorTestLevel),
        (MotorTest { level: f32::NAN, ..good }, Refusal::MotorTestLevel),
        (MotorTest { duration: 2_000_001, ..good }, Refusal::MotorTestDuration),
        (MotorTest { duration: 0, ..good }, Refusal::MotorTestDuration),
    ] {
        let mut pilot = pilot();
        let outcome = pilot.tick(&Inputs { request: Some(Request::MotorTest(test)), ..at_rest(NOW) });
        assert_eq!((outcome.answer, outcome.output), (Some(Err(refusal)), Output::Stop));
        let outcome = pilot.tick(&Inputs { request: Some(Request::MotorTest(good)), ..at_rest(NOW) });
        assert_eq!((outcome.answer, outcome.mode), (Some(Ok(())), Mode::MotorTest));
        let outcome = pilot.tick(&Inputs { request: Some(Request::Arm), ..at_rest(NOW + PERIOD) });
        assert_eq!((outcome.answer, outcome.mode), (Some(Err(Refusal::MotorTestRunning)), Mode::Disarmed));
    }
}

#[test]
fn setpoints_are_refused_on_the_ground_and_when_they_make_no_sense() {
    let mut pilot = pilot();
    let outcome = pilot.tick(&Inputs { setpoint: Some(go_to(1.0, 0.0, 0.0)), ..at_rest(NOW) });
    assert_eq!(outcome.setpoint, Some(Err(Refusal::NotFlying)));
    pilot.tick(&Inputs { request: Some(Request::Arm), ..at_rest(NOW + PERIOD) });
    let bad = [
        (go_to(f32::NAN, 0.0, 0.0), "setpoint.position"),
        (Setpoint { turn: Turn::Rate(f32::INFINITY), ..go_to(0.0, 0.0, 0.0) }, "setpoint.yaw_rate"),
    ];
    for (setpoint, field) in bad {
        let outcome = pilot.tick(&Inputs { setpoint: Some(setpoint), ..at_rest(NOW + 2 * PERIOD) });
        assert_eq!((outcome.setpoint, outcome.mode), (Some(Err(Refusal::Setpoint(field))), Mode::Flying));
    }
}

/// It never arms, says why, and tests motors nevertheless.
fn is_grounded(mut pilot: Pilot, grounded: Grounded) {
    assert_eq!(pilot.grounded(), Some(grounded));
    let outcome = pilot.tick(&Inputs { request: Some(Request::Arm), ..at_rest(NOW) });
    assert_eq!(outcome.answer, Some(Err(Refusal::Grounded(grounded))));
    assert_eq!((outcome.output, outcome.mode), (Output::Stop, Mode::Disarmed));
    let test = Request::MotorTest(MotorTest { rotor: 3, level: 0.1, duration: 1_000_000 });
    let outcome = pilot.tick(&Inputs { request: Some(test), ..at_rest(NOW) });
    assert_eq!(outcome.mode, Mode::MotorTest);
}

#[test]
fn a_configuration_that_is_not_certified_never_arms_and_the_failed_inequality_is_named() {
    let base = configuration();
    let torque_max = Vector3::new(1.0, 1.0, 0.05);
    let weak = Limits::new(LimitParameters { thrust_max: 20.0, torque_max }, base.vehicle()).unwrap();
    let weak = Configuration::new(*base.vehicle(), weak, *base.gains().unwrap(), *base.bounds()).unwrap();
    let refused = Certified::new(weak.with_rotors(rotors()).unwrap()).unwrap_err();
    let pilot = Pilot::new(Err(&refused), &GovernorLimits::default(), memory());
    let grounded = Grounded::Inequality("T2 yaw torque");
    assert_eq!(grounded.to_string(), "Not certified: T2 yaw torque");
    is_grounded(pilot, grounded);
}

#[test]
fn a_certified_configuration_that_cannot_be_flown_is_grounded_too() {
    let limits = GovernorLimits::default();
    let rotorless = Certified::new(configuration()).unwrap();
    is_grounded(Pilot::new(Ok(&rotorless), &limits, memory()), Grounded::NoRotors);
    let hover = configuration().with_bounds(ReferenceBounds::REST).unwrap().with_rotors(rotors()).unwrap();
    let hover = Certified::new(hover).unwrap();
    let field = "reference_bounds.horizontal_speed";
    is_grounded(Pilot::new(Ok(&hover), &limits, memory()), Grounded::Parameter(field));
    let slow = GovernorLimits { horizontal_speed: 0.0, ..limits };
    is_grounded(Pilot::new(Ok(&certified()), &slow, memory()), Grounded::Parameter("governor.horizontal_speed"));
    let error = ParameterError { field: "vehicle.mass", reason: Reason::NotPositive };
    is_grounded(Pilot::new(Err(&Refused::Undefined(error)), &limits, memory()), Grounded::Parameter("vehicle.mass"));
}
