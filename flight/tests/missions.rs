//! Missions: items in their order, within the same bounds and rules as setpoints.

use crate::support::{Flight, GROUND_HEIGHT_M, PERIOD_US, go_to};
use controller_core::governor::HeadingSetpoint;
use controller_core::prelude::*;
use flight::{
    ACCEPTANCE_RADIUS_M, Battery, Leg, MissionItem, MissionRefusal, MissionStep, Mode, Reason, Refusal, Request,
};

/// Ticks within which a few metres are flown.
const LONG_FLIGHT_TICKS: u64 = 4_000;

fn item(leg: Leg, x: f32, y: f32, z: f32) -> MissionItem {
    MissionItem { leg, position: Vector3::new(x, y, z), turn: HeadingSetpoint::Keep, radius: ACCEPTANCE_RADIUS_M, hold: 0 }
}

fn waypoint(x: f32, y: f32, z: f32) -> MissionItem {
    item(Leg::Waypoint, x, y, z)
}

/// A square of 2 m, 3 m up.
fn square() -> Vec<MissionItem> {
    [(2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (0.0, 0.0)].map(|(x, y)| waypoint(x, y, 3.0)).into()
}

/// What the mission did until it was over or `most` ticks had passed, and how slow its reference was at the least
/// after the first item, m/s.
fn fly(flight: &mut Flight, most: u64) -> (Vec<MissionStep>, f32) {
    let (mut steps, mut slowest) = (Vec::new(), f32::INFINITY);
    for _ in 0..most {
        let outcome = flight.tick();
        if let Some(Ok(flown)) = outcome.flown
            && !steps.is_empty()
        {
            slowest = slowest.min(flown.reference.velocity.norm());
        }
        if let Some(step) = outcome.mission_step {
            steps.push(step);
            if !matches!(step, MissionStep::Reached(_)) {
                break;
            }
        }
    }
    (steps, slowest)
}

fn distance(flight: &Flight, x: f64, y: f64, z: f64) -> f64 {
    (flight.body.position - Vector3::new(x, y, z)).norm()
}

#[test]
fn a_square_is_flown_without_stopping_at_its_corners_and_the_last_is_held() {
    let mut flight = Flight::armed();
    flight.mission = square();
    assert_eq!(flight.answer(Request::FlyMission(None)), Ok(()));
    let (steps, slowest) = fly(&mut flight, LONG_FLIGHT_TICKS);
    let reached = [0, 1, 2, 3].map(MissionStep::Reached);
    assert_eq!(steps, [&reached[..], &[MissionStep::Over]].concat());
    assert!(slowest > 0.1, "{slowest}");
    assert_eq!(flight.pilot.mode(), Mode::Holding);
    flight.ticks(1_000);
    assert!(distance(&flight, 0.0, 0.0, 3.0) < 0.05);
}

#[test]
fn an_item_is_held_for_its_time_from_its_radius_on() {
    let mut flight = Flight::armed();
    flight.mission = vec![MissionItem { hold: 7_000_000, radius: 0.1, ..waypoint(1.0, 0.0, 2.0) }];
    flight.answer(Request::FlyMission(Some(0))).unwrap();
    let mut near = None;
    loop {
        let now = flight.inputs.now;
        let outcome = flight.tick();
        let reference = outcome.flown.unwrap().unwrap().reference;
        // The governor moves after the mission has looked.
        if near.is_none() && (reference.position - flight.mission[0].position).norm() < 0.1 {
            near = Some(now + PERIOD_US);
        }
        if outcome.mission_step == Some(MissionStep::Reached(0)) {
            assert_eq!(now - near.unwrap(), 7_000_000);
            break;
        }
    }
}

#[test]
fn from_the_ground_a_take_off_goes_straight_up_and_a_return_lands_at_home() {
    let mut flight = Flight::idling();
    flight.mission = vec![item(Leg::TakeOff, 9.0, 9.0, 3.0), waypoint(2.0, 1.0, 3.0), item(Leg::Return, 0.0, 0.0, 0.0)];
    assert_eq!(flight.answer(Request::FlyMission(None)), Ok(()));
    while flight.tick().mission_step.is_none() {
        assert!(flight.body.position.xy().norm() < 0.02);
    }
    assert_eq!(flight.pilot.mode(), Mode::Flying);
    let (steps, _) = fly(&mut flight, LONG_FLIGHT_TICKS);
    assert_eq!(steps, [MissionStep::Reached(1), MissionStep::Lands(2)]);
    assert_eq!(flight.pilot.mode(), Mode::Landing);
    flight.until(Reason::Landed, LONG_FLIGHT_TICKS);
    assert!(distance(&flight, 0.0, 0.0, GROUND_HEIGHT_M) < 0.1);
    assert_eq!(flight.tick().mission, (0, false));
}

#[test]
fn from_the_ground_a_waypoint_is_flown_to_at_its_height() {
    let mut flight = Flight::idling();
    flight.mission = vec![waypoint(3.0, 0.0, 2.5), item(Leg::Land, 3.0, 0.0, 0.0)];
    assert_eq!(flight.answer(Request::FlyMission(None)), Ok(()));
    for _ in 0..LONG_FLIGHT_TICKS {
        flight.tick();
        assert!(flight.body.position.x < 0.05 || flight.body.position.z > 2.2 || flight.pilot.mode() != Mode::Flying);
        if flight.pilot.mode() == Mode::Landing {
            break;
        }
    }
    flight.until(Reason::Landed, LONG_FLIGHT_TICKS);
    assert!(distance(&flight, 3.0, 0.0, GROUND_HEIGHT_M) < 0.1);
}

#[test]
fn a_pause_keeps_the_item_and_going_on_flies_it() {
    let mut flight = Flight::armed();
    flight.mission = square();
    flight.answer(Request::FlyMission(None)).unwrap();
    while flight.tick().mission_step != Some(MissionStep::Reached(1)) {}
    assert_eq!(flight.answer(Request::Hold), Ok(()));
    let outcome = flight.ticks(500);
    assert_eq!((outcome.mode, outcome.mission), (Mode::Holding, (2, false)));
    assert_eq!(flight.answer(Request::FlyMission(None)), Ok(()));
    let (steps, _) = fly(&mut flight, LONG_FLIGHT_TICKS);
    assert_eq!(steps, [MissionStep::Reached(2), MissionStep::Reached(3), MissionStep::Over]);
}

#[test]
fn an_item_may_be_set_and_one_that_is_not_there_is_refused() {
    let mut flight = Flight::armed();
    flight.mission = square();
    let none = Err(Refusal::Mission(MissionRefusal::NoItem));
    assert_eq!(flight.answer(Request::SetMissionItem(4)), none);
    assert_eq!(flight.answer(Request::FlyMission(Some(4))), none);
    assert_eq!(flight.answer(Request::SetMissionItem(3)), Ok(()));
    assert_eq!(flight.answer(Request::FlyMission(None)), Ok(()));
    flight.ticks(10);
    assert_eq!(flight.answer(Request::SetMissionItem(2)), Ok(()));
    let (steps, _) = fly(&mut flight, LONG_FLIGHT_TICKS);
    assert_eq!(steps, [MissionStep::Reached(2), MissionStep::Reached(3), MissionStep::Over]);
    flight.mission.clear();
    assert_eq!(flight.answer(Request::FlyMission(None)), none);
}

#[test]
fn an_item_out_of_the_fence_is_refused_at_the_start_and_ends_a_mission_on_its_way() {
    let mut flight = Flight::armed();
    flight.mission = vec![waypoint(5_000.0, 0.0, 3.0)];
    let outside = MissionRefusal::OutsideFence;
    assert_eq!(flight.answer(Request::FlyMission(None)), Err(Refusal::Mission(outside)));
    flight.mission = vec![waypoint(1.0, 0.0, 3.0), waypoint(0.0, 0.0, GROUND_HEIGHT_M as f32 - 0.5)];
    flight.answer(Request::FlyMission(None)).unwrap();
    let (steps, _) = fly(&mut flight, LONG_FLIGHT_TICKS);
    assert_eq!(steps, [MissionStep::Reached(0), MissionStep::Refused(1, MissionRefusal::BelowHome)]);
    assert_eq!(flight.pilot.mode(), Mode::Holding);
}

#[test]
fn setpoints_are_not_flown_during_a_mission_and_take_its_place_on_request() {
    let mut flight = Flight::armed();
    flight.mission = vec![waypoint(3.0, 0.0, 2.0)];
    flight.answer(Request::FlyMission(None)).unwrap();
    let mut outcome = flight.tick();
    for _ in 0..500 {
        flight.inputs.setpoint = Some(go_to(0.0, 0.0, 2.0));
        outcome = flight.tick();
    }
    assert_eq!((outcome.setpoint, outcome.setpoints_requested, outcome.mission), (None, false, (0, true)));
    assert!(flight.body.position.x > 0.5);
    assert_eq!(flight.answer(Request::FlySetpoints), Ok(()));
    // The last one that came is flown, and no more are needed.
    let outcome = flight.ticks(2_000);
    assert_eq!((outcome.mode, outcome.setpoints_requested, outcome.mission), (Mode::Flying, true, (0, false)));
    assert!(distance(&flight, 0.0, 0.0, 2.0) < 0.05);
}

#[test]
fn what_ends_a_flight_by_setpoints_ends_a_mission() {
    type Fails = fn(&mut Flight);
    let failures: [(Fails, Reason, Mode); 4] = [
        (|flight| flight.present.ground_station = false, Reason::GroundStationLost, Mode::Holding),
        (|flight| flight.present.pose = false, Reason::PoseLost, Mode::Descending),
        (|flight| flight.inputs.battery = Battery::Critical, Reason::BatteryCritical, Mode::Landing),
        (|flight| flight.inputs.killed = true, Reason::Killed, Mode::Stopped),
    ];
    for (fail, reason, mode) in failures {
        let mut flight = Flight::armed();
        flight.mission = vec![waypoint(0.0, 50.0, 3.0)];
        flight.answer(Request::FlyMission(None)).unwrap();
        flight.ticks(100);
        let mut ticks = 0;
        let outcome = loop {
            fail(&mut flight);
            let outcome = flight.tick();
            ticks += 1;
            assert!(ticks < 500, "{reason:?}");
            if outcome.transition.is_some() {
                break outcome;
            }
        };
        assert_eq!((outcome.transition.unwrap().reason, outcome.mode), (reason, mode));
        assert!(!outcome.mission.1, "{reason:?}");
    }
}

#[test]
fn a_mission_needs_an_armed_vehicle_and_does_not_end_a_landing() {
    let mut flight = Flight::settled();
    flight.mission = square();
    assert_eq!(flight.answer(Request::FlyMission(None)), Err(Refusal::NotIdling));
    let mut flight = Flight::idling();
    flight.mission = vec![item(Leg::Land, 0.0, 0.0, 0.0)];
    assert_eq!(flight.answer(Request::FlyMission(None)), Err(Refusal::NotInTheAir));
    let mut flight = Flight::armed();
    flight.mission = square();
    flight.answer(Request::Land).unwrap();
    assert_eq!(flight.answer(Request::FlyMission(None)), Err(Refusal::Landing));
}

#[test]
fn a_way_to_an_item_is_within_the_governor_s_bounds() {
    // Every tick of these flights is held to the certificate by the harness; the reference to its speed limit here.
    let mut flight = Flight::armed();
    flight.mission = vec![waypoint(40.0, 0.0, 3.0), waypoint(40.0, 40.0, 30.0)];
    flight.answer(Request::FlyMission(None)).unwrap();
    for _ in 0..LONG_FLIGHT_TICKS {
        let outcome = flight.tick();
        let velocity = outcome.flown.unwrap().unwrap().reference.velocity;
        assert!(velocity.xy().norm() <= 5.01 && velocity.z.abs() <= 2.01, "{velocity}");
        if outcome.mission_step == Some(MissionStep::Over) {
            return;
        }
    }
    panic!("not over");
}
