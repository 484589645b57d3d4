//! The pilot in closed loop with a rigid body: what each mode does, and how each ends.

mod flight;

use controller_core::flight::rules::{COASTING_MAX, GROUND_STATION_SILENCE_MAX, LEVELLING_MAX};
use controller_core::flight::{Mode, MotorTest, Output, PERIOD, Reason, Refusal, Request};
use controller_core::governor::{Motion, Setpoint, Turn};
use controller_core::prelude::*;
use flight::{Flight, go_to};

/// On its way to a far point, turning.
fn under_way() -> Flight {
    let mut flight = Flight::armed();
    flight.ticks(50);
    let turn = Turn::Angle { angle: 2.0, rate: 0.0 };
    flight.inputs.setpoint = Some(Setpoint { turn, ..go_to(30.0, 10.0, 3.0) });
    assert_eq!(flight.tick().setpoint, Some(Ok(())));
    flight.ticks(250);
    assert!(flight.body.velocity.norm() > 2.0, "{}", flight.body.velocity);
    flight
}

#[test]
fn armed_it_holds_its_place_and_reaches_a_setpoint_within_five_seconds() {
    let mut flight = Flight::armed();
    for _ in 0..200 {
        assert_eq!(flight.tick().mode, Mode::Flying);
        assert!((flight.body.position - Vector3::new(0.0, 0.0, 1.0)).norm() < 1e-3);
    }
    flight.inputs.setpoint = Some(go_to(1.0, 0.0, 1.0));
    flight.ticks(500);
    assert!((flight.body.position - Vector3::new(1.0, 0.0, 1.0)).norm() < 0.1, "{}", flight.body.position);
}

#[test]
fn without_a_pose_it_flies_on_for_a_second_levels_at_hover_thrust_for_another_and_stops_for_good() {
    let mut flight = under_way();
    flight.present.pose = false;
    // By IMU alone it goes on as if nothing had happened, for as long as a second exactly.
    for _ in 0..COASTING_MAX / PERIOD {
        let outcome = flight.tick();
        assert_eq!(outcome.mode, Mode::Flying);
        assert!(outcome.flown.unwrap().unwrap().position_error.norm() < 0.1);
    }
    let (ticks, entry) = flight.until(Reason::PoseLost, 20);
    assert_eq!(ticks, 1);
    assert_eq!(entry.mode, Mode::Levelling);
    let yaw = flight.yaw();
    let hover = hover_thrust();
    for tick in 1..LEVELLING_MAX / PERIOD {
        let outcome = flight.tick();
        let flown = outcome.flown.unwrap().unwrap();
        assert!((f64::from(flown.wrench.thrust) - hover).abs() < 1e-5, "{}", flown.wrench.thrust);
        assert_eq!(flown.reference.acceleration, Vector3::zeros());
        assert!(tick < 40 || flight.tilt() < 0.07, "tick {tick}: {} rad", flight.tilt());
        assert!((flight.yaw() - yaw).abs() < 0.1, "tick {tick}: {} rad", flight.yaw() - yaw);
    }
    assert!(flight.tilt() < 0.04, "{} rad", flight.tilt());
    let end = flight.tick();
    assert_eq!(end.transition.map(|transition| transition.reason), Some(Reason::PoseLostForLong));
    assert_eq!((end.output, end.mode), (Output::Stop, Mode::Disarmed));
    flight.present.pose = true;
    for _ in 0..100 {
        assert_eq!(flight.tick().output, Output::Stop);
    }
}

/// m g, N.
fn hover_thrust() -> f64 {
    let configuration = flight::configuration();
    f64::from(configuration.vehicle().mass * configuration.vehicle().gravity)
}

#[test]
fn a_pose_regained_within_the_second_is_flown_from_and_the_vehicle_brakes_and_holds() {
    let mut flight = under_way();
    flight.present.pose = false;
    flight.until(Reason::PoseLost, 120);
    flight.ticks(50);
    flight.present.pose = true;
    let regained = flight.tick();
    assert_eq!(regained.transition.map(|transition| transition.reason), Some(Reason::PoseRegained));
    assert_eq!(regained.mode, Mode::Flying);
    // The reference starts where the vehicle is.
    assert!(regained.flown.unwrap().unwrap().position_error.norm() < 0.1);
    let last = flight.ticks(1_500).flown.unwrap().unwrap();
    assert_eq!(last.reference.velocity, Vector3::zeros());
    assert!(last.position_error.norm() < 0.02, "{}", last.position_error);
    assert!(flight.body.velocity.norm() < 0.02);
    // And takes setpoints again.
    flight.inputs.setpoint = Some(go_to(0.0, 0.0, 2.0));
    assert_eq!(flight.tick().setpoint, Some(Ok(())));
}

#[test]
fn attitudes_between_poses_are_carried_on_by_the_gyro() {
    // Ten poses a second, none of them older than 100 ms: it flies on, and as well as with a hundred.
    let mut flight = Flight::armed();
    flight.ticks(50);
    flight.inputs.setpoint = Some(Setpoint { turn: Turn::Angle { angle: 1.5, rate: 0.0 }, ..go_to(3.0, 0.0, 1.0) });
    for tick in 0..600 {
        flight.present.pose = tick % 10 == 0;
        let truth = flight.body.attitude;
        let outcome = flight.tick();
        assert_eq!(outcome.mode, Mode::Flying);
        let used = outcome.flown.unwrap().unwrap().state.attitude.cast::<f64>();
        let error = 2.0 * (used.conjugate() * truth).imag().norm();
        assert!(error < 2e-3, "tick {tick}: {error} rad");
    }
    assert!((flight.body.position - Vector3::new(3.0, 0.0, 1.0)).norm() < 0.1, "{}", flight.body.position);
}

#[test]
fn without_a_ground_station_it_stops_and_holds_as_long_as_the_pose_lasts() {
    let mut flight = under_way();
    flight.present.ground_station = false;
    let (ticks, _) = flight.until(Reason::GroundStationLost, 300);
    assert_eq!(ticks, GROUND_STATION_SILENCE_MAX / PERIOD);
    flight.inputs.setpoint = Some(go_to(0.0, 0.0, 1.0));
    assert_eq!(flight.tick().setpoint, Some(Err(Refusal::NotFlying)));
    let still = flight.ticks(1_000).flown.unwrap().unwrap().reference;
    let later = flight.ticks(6_000);
    assert_eq!(later.mode, Mode::Holding);
    assert_eq!(later.flown.unwrap().unwrap().reference, still);
    assert!((flight.body.position - still.position.cast()).norm() < 0.02);
    assert!(still.position.x < 25.0, "it went on to the setpoint: {}", still.position);

    flight.present.ground_station = true;
    let back = flight.tick();
    assert_eq!(back.transition.map(|transition| transition.reason), Some(Reason::GroundStationRegained));
    assert_eq!(back.flown.unwrap().unwrap().reference, still);
    flight.present.ground_station = false;
    flight.until(Reason::GroundStationLost, 300);
    flight.present.pose = false;
    flight.until(Reason::PoseLost, 120);
    flight.until(Reason::PoseLostForLong, 120);
}

#[test]
fn a_gyro_that_falls_silent_in_flight_stops_the_motors_within_three_ticks() {
    let mut flight = under_way();
    flight.present.imu = false;
    let (ticks, outcome) = flight.until(Reason::ImuLost, 10);
    assert_eq!(ticks, 3);
    assert_eq!((outcome.output, outcome.mode), (Output::Stop, Mode::Disarmed));
}

#[test]
fn a_disarm_command_stops_the_motors_in_its_tick_from_any_mode() {
    let mut holding = under_way();
    holding.present.ground_station = false;
    holding.until(Reason::GroundStationLost, 300);
    let mut levelling = under_way();
    levelling.present.pose = false;
    levelling.until(Reason::PoseLost, 120);
    let mut testing = Flight::new();
    testing.inputs.request = Some(Request::MotorTest(MotorTest { rotor: 1, level: 0.1, duration: 1_000_000 }));
    testing.tick();
    let flights = [Flight::new(), testing, under_way(), holding, levelling];
    for (mode, mut flight) in Mode::ALL.into_iter().zip(flights) {
        assert_eq!(flight.pilot.mode(), mode);
        // Against everything else at once.
        flight.inputs.disarm = true;
        flight.inputs.request = Some(Request::Arm);
        flight.inputs.setpoint = Some(go_to(0.0, 0.0, 1.0));
        flight.present = flight::Present { imu: true, pose: true, ground_station: true };
        let outcome = flight.tick();
        assert_eq!((outcome.output, outcome.mode), (Output::Stop, Mode::Disarmed));
        assert_eq!(outcome.answer, Some(Err(Refusal::DisarmCommanded)));
        assert_eq!(outcome.transition.map(|t| t.reason), (mode != Mode::Disarmed).then_some(Reason::DisarmCommanded));
        assert_eq!(flight.ticks(10).output, Output::Stop);
    }
}

#[test]
fn a_new_flight_starts_as_the_first_did() {
    let arm = |flight: &mut Flight| {
        flight.inputs.request = Some(Request::Arm);
        let outcome = flight.tick();
        assert_eq!(outcome.answer, Some(Ok(())));
        outcome.flown.unwrap().unwrap()
    };
    let mut flight = under_way();
    flight.inputs.disarm = true;
    flight.tick();
    // Caught in the air and put back: poses leap, the IMU felt nothing of it. On the ground the estimate follows.
    (flight.body, flight.held) = (Flight::new().body, true);
    flight.ticks(250);
    let (again, first) = (arm(&mut flight), arm(&mut Flight::settled()));
    assert!((again.reference.position - first.reference.position).norm() < 1e-3, "{again:?}");
    assert!((again.wrench.thrust - first.wrench.thrust).abs() < 1e-3, "{again:?}");
    assert!((again.wrench.torque - first.wrench.torque).norm() < 1e-3, "{again:?}");
}

#[test]
fn a_motor_test_turns_one_motor_slowly_and_ends_by_itself_or_by_any_request() {
    let test = MotorTest { rotor: 2, level: 0.15, duration: 500_000 };
    let mut flight = Flight::new();
    flight.inputs.request = Some(Request::MotorTest(test));
    let begin = flight.tick();
    assert_eq!((begin.answer, begin.mode), (Some(Ok(())), Mode::MotorTest));
    assert_eq!(begin.output, Output::Test { rotor: 2, level: 0.15 });
    for _ in 1..50 {
        assert_eq!(flight.tick().output, Output::Test { rotor: 2, level: 0.15 });
    }
    let end = flight.tick();
    assert_eq!(end.transition.map(|transition| transition.reason), Some(Reason::MotorTestOver));
    assert_eq!(end.output, Output::Stop);
    for request in [Request::Arm, Request::MotorTest(test)] {
        flight.inputs.request = Some(Request::MotorTest(test));
        flight.tick();
        flight.inputs.request = Some(request);
        let interrupted = flight.tick();
        assert_eq!(interrupted.answer, Some(Err(Refusal::MotorTestRunning)));
        assert_eq!((interrupted.output, interrupted.mode), (Output::Stop, Mode::Disarmed));
    }
}

#[test]
fn a_velocity_setpoint_is_flown_too() {
    let mut flight = Flight::armed();
    for _ in 0..400 {
        let motion = Motion::Velocity(Vector3::new(1.0, 0.0, 0.0));
        flight.inputs.setpoint = Some(Setpoint { motion, turn: Turn::Keep });
        flight.tick();
    }
    assert!((flight.body.velocity.x - 1.0).abs() < 0.1, "{}", flight.body.velocity);
}
