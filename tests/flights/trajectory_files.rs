//! Trajectories from files, through the whole of the desktop: certified and flown, near what the files say.
//!
//! `cargo test -p host-sim trajectory_files -- --nocapture` prints how near.

use crate::support::binary::{self, host_sim, status, stdout};
use controller_core::governor::{Governor, GovernorLimits, HeadingSetpoint, Memory, Motion, Setpoint};
use controller_core::reference::Reference;
use host_sim::flight::Flight;
use host_sim::reports::reference_rows::FOLLOWED_WITHIN_2_CM_FACTOR;
use nalgebra::Vector3;
use scenario::reference::ReferenceKind;
use scenario::trajectory::{Route, Way};
use scenario::verdict::Verdict;
use scenario::{Scenario, self_contained};
use std::fs;
use std::path::Path;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn shipped(name: &str) -> Scenario {
    Scenario::load(&Path::new(ROOT).join(format!("scenarios/{name}.toml"))).unwrap()
}

/// The text of the shipped gates.
fn gates() -> String {
    fs::read_to_string(Path::new(ROOT).join("scenarios/gates.toml")).unwrap()
}

/// Eighteen points on two circles at three heights, on the Hummingbird.
fn eighteen() -> String {
    let gates = gates();
    let (head, _) = gates.split_once("points = [").unwrap();
    let points: String = (0..18)
        .map(|i| {
            let (angle, radius) = (0.7 * f64::from(i), if i % 2 == 0 { 3.0 } else { 2.0 });
            let height = 1.5 + 0.5 * f64::from(i % 3);
            format!("{{ position = [{:.3}, {:.3}, {height}] }},", radius * angle.cos(), radius * angle.sin())
        })
        .collect();
    format!("{head}points = [{points}]\n")
}

/// Rows in UTM coordinates, 5,000 km from the origin, on the Hummingbird.
fn far() -> Scenario {
    let gates = gates();
    let (head, _) = gates.split_once("[reference]").unwrap();
    let reference = "kind = \"trajectory\"\nfile = \"utm.csv\"\norigin = [465000.0, 5427000.0, 0.0]";
    let file = format!("{ROOT}/tests/flights/trajectory_files/far");
    Scenario::parse(&format!("{head}[reference]\n{reference}\n"), &file).unwrap()
}

/// How far from its points, at their times, and from its reference the vehicle flies at worst, m.
fn flown(scenario: &Scenario) -> (f64, f64) {
    assert_eq!(Verdict::judge(scenario).unwrap().refusal(), None, "{}", scenario.name);
    let ReferenceKind::Route(Route { points, .. }) = &scenario.reference else { panic!("no route") };
    let mut flight = Flight::new(scenario).unwrap();
    let (mut off, mut path, mut next) = (0.0_f64, Vec::new(), points.iter().peekable());
    for _ in 0..scenario.timing.ticks {
        let tick = flight.tick().unwrap();
        off = off.max((tick.state.position - tick.reference.position.map(f64::from)).norm());
        path.push((tick.time_us as f64 * 1e-6, tick.state.position));
    }
    let mut missed: f64 = 0.0;
    for pair in path.windows(2) {
        let [(from, start), (to, end)] = [pair[0], pair[1]];
        while let Some(point) = next.next_if(|point| point.time < to) {
            let there = start + (end - start) * ((point.time - from) / (to - from));
            missed = missed.max((there - Vector3::from(point.position)).norm());
        }
    }
    assert!(next.peek().is_none(), "{}: points are left", scenario.name);
    (missed, off)
}

#[test]
fn files_of_rows_pieces_and_points_are_certified_and_flown_near_what_they_say() {
    let eighteen = Scenario::parse(&eighteen(), "eighteen").unwrap();
    for (scenario, most) in
        [(shipped("eight"), 0.02), (shipped("pieces"), 0.03), (shipped("gates"), 0.15), (eighteen, 0.15), (far(), 0.02)]
    {
        let (missed, off) = flown(&scenario);
        println!("{}: {missed:.4} m from its points at worst, {off:.4} m from its reference", scenario.name);
        assert!(missed < most, "{}: {missed} m from its points", scenario.name);
        if let ReferenceKind::Route(Route { way: Way::Near { farthest: (distance, _), .. }, .. }) = &scenario.reference
        {
            assert!(missed <= distance + off + 1e-3, "{}: {missed} of {distance} and {off} m", scenario.name);
        }
    }
}

#[test]
fn a_campaign_and_a_report_keep_the_rows_of_a_file() {
    let directory = binary::directory("trajectory_files", "campaign");
    for file in ["eight.toml", "eight.csv"] {
        fs::copy(Path::new(ROOT).join("scenarios").join(file), directory.join(file)).unwrap();
    }
    let campaign = ["campaign", "eight.toml", "--flights", "8", "--out", "flown"];
    let output = host_sim(&directory, &campaign);
    assert!(status(&output) < 2, "{}", stdout(&output));
    // Without the file beside it, the campaign goes on from what it kept.
    let text = self_contained::read(&directory.join("eight.toml")).unwrap();
    fs::remove_file(directory.join("eight.csv")).unwrap();
    let kept = fs::read_to_string(directory.join("flown/scenario.toml")).unwrap();
    assert_eq!(kept, text);
    Scenario::parse(&kept, "kept").unwrap();
}

/// How far the governor's reference is at worst from a scenario's that it is streamed 50 times a second, m.
fn streamed(scenario: &Scenario) -> f32 {
    let memory = Box::leak(Box::new(Memory::EMPTY));
    let (bounds, period) = (scenario.configuration.bounds(), scenario.timing.period() as f32);
    let governor = Governor::new(bounds, &GovernorLimits::default(), period, memory).unwrap();
    // Two seconds at rest, then as `host-sim reference` writes it.
    let at = |tick: u64| {
        let time = (tick * 10_000).saturating_sub(2_000_000) as f64 / FOLLOWED_WITHIN_2_CM_FACTOR;
        let Reference { velocity, acceleration, .. } = scenario.trajectory.at(time as u64);
        let slower = FOLLOWED_WITHIN_2_CM_FACTOR as f32;
        let (velocity, acceleration) = (velocity / slower, acceleration / (slower * slower));
        Reference { velocity, acceleration, ..scenario.trajectory.at(time as u64) }
    };
    let first = at(0);
    governor.start(&first.position, &Vector3::zeros(), &first.heading).unwrap();
    let mut worst = 0.0_f32;
    for tick in 0..(scenario.timing.ticks as f64 * FOLLOWED_WITHIN_2_CM_FACTOR) as u64 + 200 {
        if tick % 2 == 0 {
            let Reference { position, velocity, acceleration, .. } = at(tick);
            let motion = Motion::PositionVelocityAcceleration { position, velocity, acceleration };
            governor.accept(&Setpoint { motion, turn: HeadingSetpoint::Keep }).unwrap();
        }
        let off = (governor.tick().position - at(tick + 1).position).norm();
        worst = worst.max(off);
    }
    worst
}

#[test]
fn what_is_flown_from_a_file_is_flown_as_well_where_it_is_streamed() {
    for scenario in [shipped("eight"), shipped("pieces")] {
        let worst = streamed(&scenario);
        println!("{}, streamed: the governor is {worst:.4} m off at worst", scenario.name);
        assert!(worst < 0.02, "{}: {worst} m", scenario.name);
    }
}
