//! Each rival in its home conditions, with the gains that were found for it: a step, a circle in drag, moderate
//! attitudes. And the file of gains.

use super::gains::{BUILT_IN, Set};
use super::kind::Kind;
use super::start::Speed;
use super::tuning::RivalJudge;
use crate::course::Course;
use crate::interrupt::Interrupt;
use crate::tune::candidate::Judging;
use crate::tune::trials::hover;
use nalgebra::{UnitQuaternion, Vector3};
use scenario::Scenario;
use scenario::timing::Timing;

const HUMMINGBIRD: &str = include_str!("../../../vehicles/hummingbird.toml");

fn hummingbird() -> Scenario {
    Scenario::parse(HUMMINGBIRD, "hummingbird.toml").unwrap()
}

/// The course of `kind` with its built-in gains.
fn course(kind: Kind, scenario: &Scenario, near: f64) -> Course {
    let set = Set::of(scenario, BUILT_IN, "gains.toml").unwrap();
    let (_, gains, _) = set.rivals.into_iter().find(|(rival, ..)| *rival == kind).unwrap();
    Course::over(scenario, kind.flight(scenario, scenario, &gains).unwrap(), near).unwrap()
}

#[test]
fn every_rival_flies_a_step_and_stays() {
    let mut step = hover(&hummingbird(), Vector3::new(-1.0, 0.5, -0.5), 12.0).unwrap();
    step.reality.drag = None;
    for kind in Kind::ALL {
        let course = course(kind, &step, 0.05);
        println!("{}: {course:?}", kind.name());
        assert!(course.settled.is_some_and(|at| at < 8.0) && course.end_error < 0.02, "{}: {course:?}", kind.name());
    }
}

#[test]
fn every_rival_flies_the_circle() {
    let file = hummingbird();
    let circle = Scenario { timing: Timing { ticks: 1600, ..file.timing }, ..file };
    for kind in Kind::ALL {
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
        for kind in Kind::ALL {
            let course = course(kind, &tilted, 0.1);
            assert!(course.settled.is_some() && course.yaw_error < 0.1, "{} {tilt}: {course:?}", kind.name());
        }
    }
}

#[test]
fn gains_survive_being_written_and_read() {
    let file = hummingbird();
    let set = Set::of(&file, BUILT_IN, "gains.toml").unwrap();
    for name in ["hummingbird", "hummingbird.v1.2", "2", "-"] {
        let named = Scenario { name: name.to_owned(), ..file.clone() };
        let again = Set::of(&named, &set.written(&named, "a test"), "written").unwrap();
        assert_eq!(again.rivals.len(), Kind::ALL.len());
        for ((_, one, _), (_, other, _)) in set.rivals.iter().zip(&again.rivals) {
            assert!(one.iter().zip(other).all(|(a, b)| (a / b - 1.0).abs() < 1e-4));
        }
    }
}

#[test]
fn a_rival_without_gains_survives_being_written_and_read() {
    let file = hummingbird();
    let mut set = Set::built_in(&file).unwrap();
    set.rivals.retain(|(kind, ..)| !matches!(kind, Kind::Lee | Kind::Indi));
    set.lost = vec![Kind::Lee, Kind::Indi];
    let again = Set::of(&file, &set.written(&file, "a test"), "written").unwrap();
    assert_eq!((again.rivals.len(), &again.lost), (Kind::ALL.len() - 2, &set.lost));
    assert!(again.left_out().unwrap().starts_with("left out: lee, indi; "));
    assert_eq!(Set::built_in(&file).unwrap().left_out(), None);
}

#[test]
fn a_search_on_slower_rotors_starts_at_better_gains_than_start() {
    let mut file = hummingbird();
    file.rotor_lag = 0.05;
    let uninterrupted = Interrupt::default();
    for kind in [Kind::Lee, Kind::Indi, Kind::Nested] {
        let own = RivalJudge::new(&file, kind, &kind.start(&file).at(Speed::OWN));
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
        let text = BUILT_IN.replacen(from, to, 1);
        assert_ne!(text, BUILT_IN, "{from}");
        Set::of(&file, &text, "mine.toml").unwrap_err().to_string()
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
