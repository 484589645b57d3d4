//! The pilot in closed loop with a rigid body: what each mode does, and how each ends.

use crate::support::{Flight, GROUND_HEIGHT_M, PERIOD_US, SPOOLING_TICKS, go_to};
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use controller_core::prelude::*;
use flight::rules::{
    BATTERY_DEBOUNCE_US, COASTING_MAX_US, GROUND_STATION_TIMEOUT_US, LEVELLING_MAX_US, TRACKING_DEBOUNCE_US,
};
use flight::{Battery, Mode, MotorTest, Output, Reason, Refusal, Request};

/// On its way to a far point, turning.
fn under_way() -> Flight {
    let mut flight = Flight::armed();
    flight.ticks(50);
    let turn = HeadingSetpoint::Angle { angle: 2.0, rate: 0.0 };
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
fn without_a_pose_it_flies_on_for_a_second_levels_for_another_and_comes_down_by_the_imu() {
    let mut flight = under_way();
    flight.present.pose = false;
    // By IMU alone it goes on as if nothing had happened, for as long as a second exactly.
    for _ in 0..COASTING_MAX_US / PERIOD_US {
        let outcome = flight.tick();
        assert_eq!(outcome.mode, Mode::Flying);
        assert!(outcome.flown.unwrap().unwrap().position_error.norm() < 0.1);
    }
    let (ticks, entry) = flight.until(Reason::PoseLost, 20);
    assert_eq!(ticks, 1);
    assert_eq!(entry.mode, Mode::Descending);
    let (yaw, height) = (flight.yaw(), flight.body.position.z);
    flight.ground = height - 3.0;
    for tick in 1..LEVELLING_MAX_US / PERIOD_US {
        let flown = flight.tick().flown.unwrap().unwrap();
        assert_eq!((flown.reference.velocity, flown.reference.acceleration), (Vector3::zeros(), Vector3::zeros()));
        assert!(tick < 40 || flight.tilt() < 0.07, "tick {tick}: {} rad", flight.tilt());
        assert!((flight.yaw() - yaw).abs() < 0.1, "tick {tick}: {} rad", flight.yaw() - yaw);
    }
    assert!(flight.tilt() < 0.04, "{} rad", flight.tilt());
    assert!(flight.body.velocity.z.abs() < 0.3 && (flight.body.position.z - height).abs() < 0.5);
    // Then down, at a speed that does no harm, until the ground is found.
    let mut fastest = 0.0_f64;
    let landed = (1..1_500).find_map(|tick| {
        fastest = fastest.max(-flight.body.velocity.z);
        let outcome = flight.tick();
        outcome.transition.map(|transition| (tick, transition.reason, outcome.output))
    });
    let (ticks, reason, output) = landed.unwrap();
    assert_eq!((reason, output), (Reason::Landed, Output::Stop));
    assert!(fastest < 1.2 && (200..800).contains(&ticks), "{fastest} m/s, {ticks} ticks");
    assert_eq!(flight.body.position.z, flight.ground);
    // For good, poses or not.
    flight.present.pose = true;
    for _ in 0..300 {
        assert_eq!(flight.tick().output, Output::Stop);
    }
}

#[test]
fn without_a_pose_and_without_a_ground_it_stops_in_the_end() {
    let mut flight = under_way();
    flight.present.pose = false;
    flight.until(Reason::PoseLost, 120);
    let (ticks, outcome) = flight.until(Reason::DescendingOver, 3_100);
    assert_eq!((ticks, outcome.output, outcome.mode), (3_000, Output::Stop, Mode::Stopped));
    // And stays so until it is disarmed.
    flight.inputs.request = Some(Request::Arm);
    assert_eq!(flight.tick().answer, Some(Err(Refusal::Stopped)));
    flight.inputs.request = Some(Request::Disarm);
    assert_eq!(flight.tick().mode, Mode::Checks);
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
    assert_eq!(regained.mode, Mode::Holding);
    // The reference starts where the vehicle is.
    assert!(regained.flown.unwrap().unwrap().position_error.norm() < 0.1);
    let last = flight.ticks(1_500).flown.unwrap().unwrap();
    assert_eq!(last.reference.velocity, Vector3::zeros());
    assert!(last.position_error.norm() < 0.02, "{}", last.position_error);
    assert!(flight.body.velocity.norm() < 0.02);
    // And takes setpoints again, on request.
    flight.inputs.setpoint = Some(go_to(0.0, 0.0, 2.0));
    assert_eq!(flight.tick().setpoint, None);
    flight.inputs.request = Some(Request::FlySetpoints);
    assert_eq!(flight.tick().mode, Mode::Flying);
}

#[test]
fn stopped_in_the_air_it_is_not_reported_on_the_ground_before_it_lies_there() {
    for kill in [false, true] {
        let mut flight = Flight::armed();
        flight.ground = flight.body.position.z - 20.0;
        (flight.inputs.disarm, flight.inputs.killed) = (!kill, kill);
        let stopped = flight.tick();
        assert!(stopped.output == Output::Stop && !stopped.is_airborne && stopped.may_fall);
        // Disarming what was killed does not catch it.
        flight.inputs.request = kill.then_some(Request::Disarm);
        assert!(flight.tick().mode.may_arm());
        while flight.body.position.z > flight.ground {
            assert!(flight.tick().may_fall, "{}", flight.body.position.z);
        }
        assert!(flight.ticks(30).may_fall);
        assert!(!flight.ticks(60).may_fall && !flight.ticks(100).may_fall);
    }
}

#[test]
fn what_was_never_in_the_air_or_landed_does_not_fall() {
    let mut flight = Flight::idling();
    flight.inputs.request = Some(Request::TakeOff(None));
    flight.ticks(SPOOLING_TICKS / 2);
    flight.inputs.disarm = true;
    assert!(!flight.tick().may_fall);
    let mut flight = Flight::armed();
    flight.ground = 0.5;
    flight.inputs.request = Some(Request::Land);
    while flight.tick().mode.is_armed() {}
    assert!(!flight.tick().may_fall);
}

#[test]
fn attitudes_between_poses_are_carried_on_by_the_gyro() {
    // Ten poses a second, none of them older than 100 ms: it flies on, and as well as with a hundred.
    let mut flight = Flight::armed();
    flight.ticks(50);
    flight.inputs.setpoint =
        Some(Setpoint { turn: HeadingSetpoint::Angle { angle: 1.5, rate: 0.0 }, ..go_to(3.0, 0.0, 1.0) });
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
fn without_a_ground_station_it_holds_for_ten_seconds_and_lands() {
    let mut flight = under_way();
    flight.present.ground_station = false;
    let (ticks, _) = flight.until(Reason::GroundStationLost, 300);
    assert_eq!(ticks, GROUND_STATION_TIMEOUT_US / PERIOD_US);
    flight.inputs.setpoint = Some(go_to(0.0, 0.0, 1.0));
    assert_eq!(flight.tick().setpoint, None);
    let still = flight.ticks(700).flown.unwrap().unwrap().reference;
    // The paper's law takes out slowly what a vehicle braked from its own motion is off by.
    assert!(still.velocity.norm() < 1e-6 && flight.body.velocity.norm() < 0.05, "{}", flight.body.velocity);
    assert!((flight.body.position - still.position.cast()).norm() < 0.2, "{}", flight.body.position);
    assert!(still.position.x < 20.0, "it went on to the setpoint: {}", still.position);
    flight.ground = flight.body.position.z - 2.0;
    let (ticks, landing) = flight.until(Reason::GroundStationGone, 60);
    assert_eq!(landing.mode, Mode::Landing);
    assert_eq!(ticks + 701 + GROUND_STATION_TIMEOUT_US / PERIOD_US, 1_000);
    let (_, landed) = flight.until(Reason::Landed, 900);
    assert_eq!((landed.output, landed.mode), (Output::Stop, Mode::Checks));
    assert_eq!(flight.body.position.z, flight.ground);
}

#[test]
fn a_ground_station_that_comes_back_finds_it_holding_and_may_fly_on() {
    let mut flight = under_way();
    flight.present.ground_station = false;
    flight.until(Reason::GroundStationLost, 300);
    flight.present.ground_station = true;
    assert_eq!(flight.ticks(1_200).mode, Mode::Holding);
    flight.inputs.request = Some(Request::FlySetpoints);
    assert_eq!(flight.tick().answer, Some(Err(Refusal::NoSetpoints)));
    flight.inputs.setpoint = Some(go_to(0.0, 0.0, 2.0));
    flight.inputs.request = Some(Request::FlySetpoints);
    flight.until(Reason::SetpointsCommanded, 1);
    flight.ticks(3_000);
    assert!((flight.body.position - Vector3::new(0.0, 0.0, 2.0)).norm() < 0.1, "{}", flight.body.position);
}

#[test]
fn a_gyro_that_falls_silent_in_flight_stops_the_motors_within_three_ticks() {
    let mut flight = under_way();
    flight.present.imu = false;
    let (ticks, outcome) = flight.until(Reason::ImuLost, 10);
    assert_eq!(ticks, 3);
    assert_eq!((outcome.output, outcome.mode), (Output::Stop, Mode::Stopped));
}

/// A flight in each mode that a pilot with a certificate can be in.
fn one_in_each_mode() -> Vec<Flight> {
    let mut testing = Flight::settled();
    testing.inputs.request = Some(Request::MotorTest(MotorTest { rotor: 1, level: 0.1, duration: 1_000_000 }));
    testing.tick();
    let mut checks = Flight::new();
    checks.ticks(5);
    let mut rising = Flight::idling();
    rising.inputs.request = Some(Request::TakeOff(None));
    rising.ticks(300);
    let [mut holding, mut landing, mut descending, mut stopped] = [(); 4].map(|()| under_way());
    holding.inputs.request = Some(Request::Hold);
    holding.tick();
    landing.inputs.request = Some(Request::Land);
    landing.tick();
    descending.present.pose = false;
    descending.until(Reason::PoseLost, 120);
    stopped.present.imu = false;
    stopped.until(Reason::ImuLost, 10);
    vec![
        Flight::new(),
        checks,
        Flight::settled(),
        testing,
        Flight::idling(),
        rising,
        under_way(),
        holding,
        landing,
        descending,
        stopped,
    ]
}

#[test]
fn a_disarm_command_with_force_stops_the_motors_in_its_tick_from_any_mode() {
    for (mode, mut flight) in Mode::ALL.into_iter().zip(one_in_each_mode()) {
        assert_eq!(flight.pilot.mode(), mode);
        // Against everything else at once.
        flight.inputs.disarm = true;
        flight.inputs.request = Some(Request::Arm);
        flight.inputs.setpoint = Some(go_to(0.0, 0.0, 1.0));
        flight.present = crate::support::Present { imu: true, pose: true, ground_station: true };
        let outcome = flight.tick();
        assert_eq!(outcome.output, Output::Stop, "{mode:?}");
        assert_eq!(outcome.answer, Some(Err(Refusal::DisarmCommanded)));
        let stops = mode.is_armed() || matches!(mode, Mode::MotorTest | Mode::Stopped);
        let reason = outcome.transition.map(|transition| transition.reason);
        assert_eq!(reason == Some(Reason::Disarmed), stops, "{mode:?}: {reason:?}");
        assert_eq!(flight.ticks(10).output, Output::Stop);
    }
}

#[test]
fn the_kill_switch_stops_the_motors_in_its_tick_and_keeps_them_so() {
    for (mode, mut flight) in Mode::ALL.into_iter().zip(one_in_each_mode()) {
        for _ in 0..5 {
            flight.inputs.killed = true;
            flight.inputs.request = Some(Request::Arm);
            let outcome = flight.tick();
            assert_eq!(outcome.output, Output::Stop, "{mode:?}");
            assert!(matches!(outcome.answer, Some(Err(_))), "{mode:?}");
        }
        assert_eq!(flight.pilot.mode() == Mode::Stopped, mode.is_armed() || mode == Mode::Stopped, "{mode:?}");
    }
}

#[test]
fn a_plain_disarm_command_stops_motors_on_the_ground_and_none_in_the_air() {
    for (mode, mut flight) in Mode::ALL.into_iter().zip(one_in_each_mode()) {
        flight.inputs.request = Some(Request::Disarm);
        let outcome = flight.tick();
        if mode.flies() {
            assert_eq!((outcome.answer, outcome.mode), (Some(Err(Refusal::InTheAir)), mode));
            assert!(matches!(outcome.output, Output::Thrusts(_)));
        } else {
            assert_eq!((outcome.answer, outcome.output), (Some(Ok(())), Output::Stop), "{mode:?}");
        }
    }
}

#[test]
fn a_plain_disarm_command_stops_a_vehicle_that_takes_off_and_still_stands() {
    let mut flight = Flight::idling();
    flight.inputs.request = Some(Request::TakeOff(None));
    let rising = flight.ticks(20);
    assert_eq!((rising.mode, rising.is_airborne), (Mode::TakingOff, false));
    flight.inputs.request = Some(Request::Disarm);
    let outcome = flight.tick();
    assert_eq!((outcome.answer, outcome.output), (Some(Ok(())), Output::Stop));
}

#[test]
fn a_new_flight_starts_as_the_first_did() {
    let arm = |flight: &mut Flight| {
        flight.inputs.request = Some(Request::Arm);
        let outcome = flight.tick();
        assert_eq!(outcome.answer, Some(Ok(())));
        flight.inputs.request = Some(Request::TakeOff(None));
        flight.tick().flown.unwrap().unwrap()
    };
    let mut flight = under_way();
    flight.inputs.disarm = true;
    flight.tick();
    // Caught in the air and put back: poses leap, the IMU felt nothing of it. On the ground the estimate follows.
    (flight.body, flight.ground) = (Flight::new().body, GROUND_HEIGHT_M);
    flight.ticks(250);
    let (again, first) = (arm(&mut flight), arm(&mut Flight::settled()));
    assert!((again.reference.position - first.reference.position).norm() < 1e-3, "{again:?}");
    assert!((again.wrench.thrust - first.wrench.thrust).abs() < 1e-3, "{again:?}");
    assert!((again.wrench.torque - first.wrench.torque).norm() < 1e-3, "{again:?}");
}

#[test]
fn a_low_battery_lands_the_next_flight_as_it_did_the_last() {
    let mut flight = Flight::settled();
    for _ in 0..2 {
        flight.inputs.request = Some(Request::Arm);
        assert_eq!(flight.tick().answer, Some(Ok(())));
        flight.inputs.request = Some(Request::TakeOff(None));
        assert_eq!(flight.tick().mode, Mode::TakingOff);
        let landing = (1..400_u64).find_map(|tick| {
            flight.inputs.battery = Battery::Low;
            flight.tick().transition.map(|transition| (tick, transition.reason))
        });
        assert_eq!(landing, Some((BATTERY_DEBOUNCE_US / PERIOD_US + 1, Reason::BatteryLow)));
        flight.inputs.disarm = true;
        assert_eq!(flight.tick().output, Output::Stop);
        // Down again, with another battery.
        flight.ticks(300);
    }
}

#[test]
fn a_landing_under_way_comes_to_rest_across_before_it_goes_down() {
    let mut flight = under_way();
    flight.inputs.request = Some(Request::Land);
    let (mut braking, mut lowest) = (0, f32::INFINITY);
    for _ in 0..1_000 {
        let velocity = flight.tick().flown.unwrap().unwrap().reference.velocity;
        lowest = lowest.min(velocity.z);
        if velocity.xy().norm() > 0.1 {
            braking += 1;
            assert!(velocity.z > -0.01, "goes down at {velocity}");
        }
    }
    assert!(braking > 50 && lowest < -0.3, "{braking} ticks, {lowest} m/s");
}

#[test]
fn a_vehicle_that_does_not_get_off_the_ground_lands_a_while_after_its_reference_is_half_a_metre_up() {
    let mut flight = Flight::idling();
    flight.inputs.request = Some(Request::TakeOff(Some(3.0)));
    // Something holds it: it stays where it is, and its IMU feels rest.
    let held = flight.body;
    flight.imu = Box::new(|increment| {
        *increment = crate::support::resting_imu(increment.start, increment.end, &Quaternion::new(1.0, 0.0, 0.0, 0.0));
    });
    let mut heights = Vec::new();
    let reason = loop {
        let outcome = flight.tick();
        flight.body = held;
        if let Some(transition) = outcome.transition.filter(|transition| transition.from == Mode::TakingOff) {
            break transition.reason;
        }
        heights
            .push(outcome.flown.map_or(0.0, |flown| f64::from(flown.unwrap().reference.position.z) - held.position.z));
        assert!(heights.len() < 1_000);
    };
    assert_eq!(reason, Reason::TrackingLost);
    let then = heights.len() - (TRACKING_DEBOUNCE_US / PERIOD_US) as usize;
    assert!(heights[then - 2] < 0.5 && heights[then + 1] > 0.5, "{:?}", &heights[then - 2..]);
}

#[test]
fn a_velocity_setpoint_is_flown_too() {
    let mut flight = Flight::armed();
    for _ in 0..400 {
        let motion = Motion::Velocity(Vector3::new(1.0, 0.0, 0.0));
        flight.inputs.setpoint = Some(Setpoint { motion, turn: HeadingSetpoint::Keep });
        flight.tick();
    }
    assert!((flight.body.velocity.x - 1.0).abs() < 0.1, "{}", flight.body.velocity);
}
