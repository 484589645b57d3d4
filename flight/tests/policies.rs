//! A policy aboard: let fly in the air by a request, within the same rules as setpoints, and ended by any of them.

use crate::support::{Flight, GROUND_HEIGHT_M, go_to};
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use controller_core::prelude::*;
use controller_core::shield::{self, Demand, Observation, Policy};
use flight::{Aboard, Guarded, Handover, Mode, Outcome, Reason, Refusal, Request};
use std::cell::Cell;
use std::rc::Rc;

/// Flies to the goal, or does harm.
#[derive(Clone, Default)]
struct Pilot(Rc<Cell<Harm>>);

#[derive(Debug, Clone, Copy, Default, PartialEq)]
enum Harm {
    #[default]
    None,
    Down,
    NotFinite,
    Silent,
}

impl Policy for Pilot {
    fn act(&mut self, observation: &Observation) -> Option<Demand> {
        let Observation { state, goal, .. } = observation;
        let acceleration = match self.0.get() {
            Harm::None => (goal - state.position) * 2.0 - state.velocity * 2.5,
            Harm::Down => Vector3::new(0.0, 0.0, -30.0),
            Harm::NotFinite => Vector3::repeat(f32::NAN),
            Harm::Silent => return None,
        };
        Some(Demand::Acceleration { acceleration, yaw_rate: 0.0 })
    }
}

/// A vehicle that holds 2 m up, and what tells its policy to do harm.
fn holding() -> (Flight<Guarded<Pilot>>, Rc<Cell<Harm>>) {
    let policy = Pilot::default();
    let harm = Rc::clone(&policy.0);
    let mut flight = Flight::carrying(Guarded::new(policy)).settle().idle().fly();
    flight.inputs.setpoint = Some(go_to(0.0, 0.0, 2.5));
    flight.ticks(800);
    assert_eq!(flight.answer(Request::Hold), Ok(()));
    (flight, harm)
}

fn distance<P>(flight: &Flight<P>, x: f64, y: f64, z: f64) -> f64 {
    (flight.body.position - Vector3::new(x, y, z)).norm()
}

/// What was said in so many ticks, and the last outcome.
fn said<P: Aboard>(flight: &mut Flight<P>, ticks: u64) -> (Vec<Handover>, Outcome) {
    let outcomes: Vec<_> = (0..ticks).map(|_| flight.tick()).collect();
    let said = outcomes.iter().filter_map(|outcome| outcome.handover).collect();
    (said, outcomes.last().unwrap().clone())
}

#[test]
fn a_policy_flies_to_the_setpoints_place_and_back_to_holding() {
    let (mut flight, _) = holding();
    flight.inputs.setpoint = Some(go_to(2.0, -1.0, 3.0));
    flight.inputs.request = Some(Request::FlyPolicy);
    let outcome = flight.tick();
    assert_eq!(
        (outcome.answer, outcome.mode, outcome.handover),
        (Some(Ok(())), Mode::Flying, Some(Handover::ToPolicy))
    );
    assert!(outcome.flies_policy);
    // A point is gone to for as long as it takes; the next one from the next tick on.
    assert_eq!(said(&mut flight, 800).0, []);
    assert!(distance(&flight, 2.0, -1.0, 3.0) < 0.05, "{}", flight.body.position);
    flight.inputs.setpoint = Some(go_to(0.0, 1.0, 2.0));
    assert_eq!(flight.tick().setpoint, Some(Ok(())));
    flight.ticks(800);
    assert!(distance(&flight, 0.0, 1.0, 2.0) < 0.05, "{}", flight.body.position);
    assert_eq!(flight.answer(Request::Hold), Ok(()));
    let (_, outcome) = said(&mut flight, 300);
    assert_eq!((outcome.mode, outcome.flies_policy), (Mode::Holding, false));
    assert!(distance(&flight, 0.0, 1.0, 2.0) < 0.1, "{}", flight.body.position);
}

#[test]
fn without_a_setpoint_the_goal_is_where_the_vehicle_was() {
    let (mut flight, _) = holding();
    flight.ticks(300);
    assert_eq!(flight.answer(Request::FlyPolicy), Ok(()));
    flight.ticks(300);
    assert!(flight.pilot.mode() == Mode::Flying && distance(&flight, 0.0, 0.0, 2.5) < 0.05);
    // A velocity is no goal, and a place outside of the fence is refused.
    flight.inputs.setpoint =
        Some(Setpoint { motion: Motion::Velocity(Vector3::new(1.0, 0.0, 0.0)), turn: HeadingSetpoint::Keep });
    flight.ticks(200);
    flight.inputs.setpoint = Some(go_to(500.0, 0.0, 2.0));
    assert_eq!(flight.tick().setpoint, Some(Err(Refusal::OutsideFence)));
    flight.ticks(200);
    assert!(distance(&flight, 0.0, 0.0, 2.5) < 0.05, "{}", flight.body.position);
}

#[test]
fn the_law_takes_over_says_why_and_gives_the_vehicle_back() {
    for (does, reason) in [
        (Harm::Down, shield::Reason::Stop),
        (Harm::NotFinite, shield::Reason::Demand),
        (Harm::Silent, shield::Reason::Silent),
    ] {
        let (mut flight, harm) = holding();
        assert_eq!(flight.answer(Request::FlyPolicy), Ok(()));
        flight.ticks(100);
        harm.set(does);
        let (heard, outcome) = said(&mut flight, 100);
        assert_eq!((heard, outcome.mode), (vec![Handover::ToLaw(reason)], Mode::Flying));
        assert!(flight.body.position.z > GROUND_HEIGHT_M + 0.4);
        harm.set(Harm::None);
        assert_eq!(said(&mut flight, 600).0, [Handover::ToPolicy]);
        // In the end the law keeps it, until a person asks again.
        let mut last = None;
        for _ in 0..30 {
            harm.set(does);
            last = said(&mut flight, 100).0.last().copied().or(last);
            harm.set(Harm::None);
            last = said(&mut flight, 2_000).0.last().copied().or(last);
        }
        assert_eq!(last, Some(Handover::ToLawForGood(reason)));
        flight.inputs.request = Some(Request::FlyPolicy);
        assert_eq!(flight.tick().handover, Some(Handover::ToPolicy));
        // Asked for again and again it still waits for its time.
        harm.set(does);
        said(&mut flight, 100);
        harm.set(Harm::None);
        for _ in 0..20 {
            assert_eq!(flight.answer(Request::FlyPolicy), Ok(()));
            assert_eq!(said(&mut flight, 2).0, []);
        }
        assert_eq!(said(&mut flight, 600).0, [Handover::ToPolicy]);
    }
}

#[test]
fn every_rule_of_flying_holds_for_a_policy() {
    let flying = || {
        let (mut flight, harm) = holding();
        assert_eq!(flight.answer(Request::FlyPolicy), Ok(()));
        flight.ticks(100);
        (flight, harm)
    };
    let (mut flight, _) = flying();
    flight.present.ground_station = false;
    flight.until(Reason::GroundStationLost, 260);
    let (mut flight, _) = flying();
    flight.present.pose = false;
    flight.until(Reason::PoseLost, 110);
    let (mut flight, _) = flying();
    assert_eq!(flight.answer(Request::Land), Ok(()));
    let outcome = flight.ticks(10);
    assert_eq!((outcome.mode, outcome.flies_policy), (Mode::Landing, false));
    let (mut flight, _) = flying();
    flight.inputs.killed = true;
    flight.until(Reason::Killed, 1);
    // Any other way of flying ends it, where the vehicle is.
    let (mut flight, _) = flying();
    flight.inputs.setpoint = Some(go_to(1.0, 0.0, 2.0));
    flight.tick();
    assert_eq!(flight.answer(Request::FlySetpoints), Ok(()));
    flight.inputs.setpoint = Some(go_to(1.0, 0.0, 2.0));
    let outcome = flight.ticks(600);
    assert_eq!((outcome.mode, outcome.flies_policy), (Mode::Flying, false));
    assert!(distance(&flight, 1.0, 0.0, 2.0) < 0.05);
    let (mut flight, _) = flying();
    assert_eq!(flight.answer(Request::GoTo(go_to(0.0, 1.0, 2.0))), Ok(()));
    let outcome = flight.ticks(600);
    assert_eq!((outcome.mode, outcome.flies_policy), (Mode::Holding, false));
    assert!(distance(&flight, 0.0, 1.0, 2.0) < 0.05);
}

#[test]
fn a_policy_is_let_fly_in_the_air_only() {
    let mut flight = Flight::carrying(Guarded::new(Pilot::default())).settle();
    assert_eq!(flight.answer(Request::FlyPolicy), Err(Refusal::NotInTheAir));
    let mut flight = flight.idle();
    assert_eq!(flight.answer(Request::FlyPolicy), Err(Refusal::NotInTheAir));
    let (mut flight, _) = holding();
    assert_eq!(flight.answer(Request::Land), Ok(()));
    assert_eq!(flight.answer(Request::FlyPolicy), Err(Refusal::Landing));
}

#[test]
fn without_a_policy_or_under_the_papers_law_none_flies() {
    let mut flight = Flight::armed();
    assert_eq!(flight.answer(Request::FlyPolicy), Err(Refusal::NoPolicy));
    let outcome = flight.ticks(10);
    assert_eq!((outcome.mode, outcome.flies_policy), (Mode::Flying, false));
    let mut aboard = Guarded::new(Pilot::default());
    aboard.fit(&crate::support::configuration(), 0.01);
    let corners = [Vector3::repeat(-5.0), Vector3::repeat(5.0)];
    let refused = aboard.begin(corners, &Vector3::zeros(), &Heading::FORWARD);
    assert_eq!(refused, Err(Refusal::NoPolicyUnderLaw));
    let none: Option<Guarded<Pilot>> = None;
    assert_eq!({ none }.begin(corners, &Vector3::zeros(), &Heading::FORWARD), Err(Refusal::NoPolicy));
}

#[test]
fn every_hand_over_in_words_fits_a_statustext() {
    for reason in shield::Reason::ALL {
        for handed in [Handover::ToPolicy, Handover::ToLaw(reason), Handover::ToLawForGood(reason)] {
            assert!(handed.to_string().len() <= flight::reason::TEXT_MAX, "{handed}");
        }
    }
}
