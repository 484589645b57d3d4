//! Each rival in its home conditions, with the gains that were found for it: a step, a circle in drag, moderate
//! attitudes. And the file of gains.

use super::gains::{BUILT_IN, Set};
use super::kind::RivalKind;
use super::rate;
use super::start::Speed;
use crate::flight::course::Course;
use crate::flight::tasks::{hover, recovery};
use crate::flight::{Flight, Tick};
use crate::output::interrupt::Interrupt;
use crate::studies::tune::candidate::Judging;
use crate::studies::tune::rivals::RivalJudge;
use nalgebra::{UnitQuaternion, Vector3};
use scenario::Scenario;
use scenario::timing::Timing;

const HUMMINGBIRD: &str = include_str!("../../../vehicles/hummingbird.toml");

/// A flight of it in the circumstances of `scenario`; it knows the vehicle as in `knowledge`.
fn flight(kind: RivalKind, knowledge: &Scenario, scenario: &Scenario, gains: &[f64]) -> Flight {
    Flight::of_rival(scenario, kind.build(knowledge, gains).unwrap())
}

fn hummingbird() -> Scenario {
    Scenario::parse(HUMMINGBIRD, "hummingbird.toml").unwrap()
}

/// The course of `kind` with its built-in gains.
fn course(kind: RivalKind, scenario: &Scenario, near: f64) -> Course {
    let set = Set::parse(scenario, BUILT_IN, "gains.toml", &RivalKind::ALL).unwrap();
    let (_, gains, _) = set.rivals.into_iter().find(|(rival, ..)| *rival == kind).unwrap();
    Course::fly(scenario, flight(kind, scenario, scenario, &gains), near).unwrap()
}

#[test]
fn every_rival_flies_a_step_and_stays() {
    let mut step = hover(&hummingbird(), Vector3::new(-1.0, 0.5, -0.5), 12.0).unwrap();
    step.reality.drag = None;
    for kind in RivalKind::ALL {
        let course = course(kind, &step, 0.05);
        println!("{}: {course:?}", kind.name());
        assert!(course.settled.is_some_and(|at| at < 8.0) && course.end_error < 0.02, "{}: {course:?}", kind.name());
    }
}

#[test]
fn every_rival_flies_the_circle() {
    let file = hummingbird();
    let circle = Scenario { timing: Timing { ticks: 1600, ..file.timing }, ..file };
    for kind in RivalKind::ALL {
        let course = course(kind, &circle, 0.2);
        println!("{}: rms {}, clipped {}", kind.name(), course.rms, course.clipped);
        assert!(course.rms < 0.1, "{}: {course:?}", kind.name());
    }
}

#[test]
fn every_rival_recovers_from_moderate_attitudes() {
    for tilt in [-60.0_f64, 60.0] {
        let mut tilted = hover(&hummingbird(), Vector3::zeros(), 12.0).unwrap();
        let axis = nalgebra::Unit::new_normalize(Vector3::new(1.0, 0.6, 0.3));
        tilted.initial.attitude = UnitQuaternion::from_axis_angle(&axis, tilt.to_radians()).into_inner();
        tilted.reality.drag = None;
        for kind in RivalKind::ALL {
            let course = course(kind, &tilted, 0.1);
            assert!(course.settled.is_some() && course.yaw_error < 0.1, "{} {tilt}: {course:?}", kind.name());
        }
    }
}

#[test]
fn gains_survive_being_written_and_read() {
    let file = hummingbird();
    let set = Set::parse(&file, BUILT_IN, "gains.toml", &RivalKind::ALL).unwrap();
    for name in ["hummingbird", "hummingbird.v1.2", "2", "-"] {
        let named = Scenario { name: name.to_owned(), ..file.clone() };
        let again = Set::parse(&named, &set.written(&named, "a test"), "written", &RivalKind::ALL).unwrap();
        assert_eq!(again.rivals.len(), RivalKind::ALL.len());
        for ((_, one, _), (_, other, _)) in set.rivals.iter().zip(&again.rivals) {
            assert!(one.iter().zip(other).all(|(a, b)| (a / b - 1.0).abs() < 1e-4));
        }
    }
}

#[test]
fn a_rival_without_gains_survives_being_written_and_read() {
    let file = hummingbird();
    let mut set = Set::built_in(&file, &RivalKind::ALL).unwrap();
    set.rivals.retain(|(kind, ..)| !matches!(kind, RivalKind::Lee | RivalKind::Indi));
    set.lost = vec![RivalKind::Lee, RivalKind::Indi];
    let again = Set::parse(&file, &set.written(&file, "a test"), "written", &RivalKind::ALL).unwrap();
    assert_eq!((again.rivals.len(), &again.lost), (RivalKind::ALL.len() - 2, &set.lost));
    assert!(again.left_out().unwrap().starts_with("left out: lee, indi; "));
    assert_eq!(Set::built_in(&file, &RivalKind::ALL).unwrap().left_out(), None);
}

#[test]
fn a_search_on_slower_rotors_starts_at_better_gains_than_start() {
    let mut file = hummingbird();
    file.rotor_lag = 0.05;
    let uninterrupted = Interrupt::default();
    for kind in [RivalKind::Cascade, RivalKind::Indi, RivalKind::Nested] {
        let own = RivalJudge::new(&file, kind, &kind.start(&file).at(Speed::UNSCALED));
        let best = RivalJudge::at_best_start(&file, kind, &uninterrupted);
        let [own, best] = [own, best].map(|judge| judge.judge(&judge.start()).cost);
        println!("{}: {own} at START, {best} where the search starts", kind.name());
        assert!(best < own, "{}: {own} {best}", kind.name());
    }
}

#[test]
fn gains_that_cannot_be_used_are_refused_by_name() {
    let file = hummingbird();
    let refused = |from: &str, to: &str| {
        let text = BUILT_IN.replace(from, to);
        assert_ne!(text, BUILT_IN, "{from}");
        Set::parse(&file, &text, "mine.toml", &RivalKind::ALL).unwrap_err().to_string()
    };
    for (from, to) in [("mass = 0.5", "mass = 0.6"), ("lag = 0.005", "lag = 0.006"), ("delay = 0.0", "delay = 0.01")] {
        let message = refused(from, to);
        assert!(message.starts_with("mine.toml: no table is of hummingbird's vehicle (mass = 0.5, "), "{message}");
        assert!(message.contains("`host-sim compare FILE` finds"), "{message}");
    }
    assert!(refused("[hummingbird.lee]", "[hummingbird.lea]").contains("hummingbird.lee: missing"));
    assert!(refused("k_w_yaw = ", "k_w_yaw = -").contains("hummingbird.lee.k_w_yaw: must be a finite number"));
    assert!(refused("k_w_yaw = ", "k_w_jaw = ").contains("hummingbird.lee.k_w_jaw: unknown"));
    assert!(refused("[hummingbird.lee]", "[hummingbird.lee").starts_with("mine.toml: "));
}

#[test]
fn gains_of_another_rate_are_named_and_fly_all_trials() {
    let file = hummingbird();
    let at = |rate: f64| rate::at(&file, rate).unwrap();
    let built_in = |rate: f64| Set::built_in(&at(rate), &[RivalKind::Lee, RivalKind::Indi]).unwrap();
    assert_eq!(built_in(100.0).of_other_rates(100.0), None);
    let said = built_in(500.0).of_other_rates(500.0).unwrap();
    assert_eq!(said, "gains not found at 500 Hz: lee at 100 Hz; --tune searches better ones");
    for rate in [50.0, 250.0, 500.0] {
        let set = built_in(rate);
        assert_eq!(set.rivals[0], built_in(100.0).rivals[0], "{rate} Hz");
        let (kind, gains, _) = &set.rivals[1];
        let slow = at(rate);
        let judge = RivalJudge::new(&slow, *kind, gains);
        let verdict = judge.judge(&judge.start());
        println!("{} at {rate} Hz: cost {}", kind.name(), verdict.cost);
        assert!(verdict.accepted() && verdict.cost < 4.0, "{rate} Hz: {verdict:?}");
    }
}

#[test]
fn a_rival_keeps_the_files_limits() {
    let text = HUMMINGBIRD.replace("torque_max = [1.0, 1.0, 0.4]", "torque_max = [0.3, 0.4, 0.05]");
    let limited = Scenario::parse(&text, "limited.toml").unwrap();
    let upside_down = recovery(&limited, 2.0).unwrap();
    let gains = Set::built_in(&limited, &[RivalKind::Indi]).unwrap().rivals.remove(0).1;
    let mut flight = flight(RivalKind::Indi, &limited, &upside_down, &gains);
    let ticks: Vec<Tick> = (0..100).map(|_| flight.tick().unwrap()).collect();
    let greatest = |axis: usize| ticks.iter().map(|tick| tick.wrench.torque[axis].abs()).fold(0.0, f32::max);
    assert_eq!([0, 1, 2].map(greatest)[0], 0.3);
    assert!(greatest(1) <= 0.4 && greatest(2) <= 0.05);
    assert!(ticks.iter().any(|tick| tick.clipped));
}
