//! The files in `tests/flights/trajectory_files`, in shapes that other programs write: each is read or refused as the
//! table in `docs/trajectories.md` says, and all that are read are the same path.

use super::{on_in, route};
use crate::Scenario;
use crate::along::Along;
use crate::remarks::remarks;
use crate::verdict::Verdict;
use nalgebra::Vector3;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

const DIRECTORY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/flights/trajectory_files");
const PAGE: &str = include_str!("../../../../docs/trajectories.md");

/// A row of the page's table.
struct Case<'a> {
    file: &'a str,
    with: &'a str,
    verdict: &'a str,
    said: &'a str,
}

fn cases() -> Vec<Case<'static>> {
    let case = |line: &'static str| {
        let (file, rest) = line.strip_prefix("| [")?.split_once("](../tests/flights/trajectory_files/")?;
        let cells: Vec<&str> = rest.split(" | ").map(|cell| cell.trim_matches([' ', '|', '`'])).collect();
        let [_, _, with, verdict, said] = cells[..] else { panic!("{line}") };
        Some(Case { file, with, verdict, said })
    };
    PAGE.lines().filter_map(case).collect()
}

/// The Hummingbird on a path of the corpus.
fn read(source: &str) -> Result<Scenario, String> {
    on_in(&format!("kind = \"trajectory\"\n{source}"), &format!("{DIRECTORY}/a test"))
}

#[test]
fn every_file_of_the_corpus_is_in_the_table() {
    let files = std::fs::read_dir(DIRECTORY).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(files.collect::<BTreeSet<_>>(), cases().iter().map(|case| case.file.to_owned()).collect());
}

#[test]
fn every_file_of_the_corpus_is_read_certified_or_refused_as_the_table_says() {
    for Case { file, with, verdict, said } in cases() {
        let scenario = match read(&format!("file = \"{file}\"\n{with}")) {
            Ok(scenario) => scenario,
            Err(error) => {
                assert_eq!(verdict, "refused", "{file}: {error}");
                assert!([": reference.file: ", file, said].iter().all(|part| error.contains(part)), "{error}");
                continue;
            }
        };
        let along = Along::judge(&scenario).unwrap();
        let is_certified = along.holds();
        assert_eq!(verdict, if is_certified { "certified" } else { "not certified" }, "{file}");
        let remarks = remarks(&scenario, is_certified);
        let all = format!("{along}\n{}", remarks.join("\n"));
        assert!(all.contains(said), "{file}: {all}");
        // What goes without saying is not said: there are the motors' idle and the path's extent.
        assert!(!said.is_empty() || remarks.len() == 2, "{file}: {all}");
        let points = &route(&scenario).points;
        let (start, end) = (points[0].time, points[points.len() - 1].time);
        for point in points {
            let there = scenario.trajectory.at((point.time * 1e6).round() as u64).position.map(f64::from);
            let since = 6.0 * (point.time - start) / (end - start);
            let (sin, cos) = (TAU * since / 8.0).sin_cos();
            let off = (there - Vector3::new(cos, sin, 1.0 + 0.05 * since)).norm();
            assert!(off < 0.03, "{file}: {off} m off at {since} s");
        }
    }
}

#[test]
fn a_heading_is_read_from_every_column_that_says_it() {
    for file in
        ["own.csv", "crazyswarm.csv", "gym_pybullet_drones.csv", "tum.txt", "euroc.csv", "rostopic.csv", "units.csv"]
    {
        let scenario = read(&format!("file = \"{file}\"")).unwrap();
        let last = route(&scenario).points.last().unwrap().time;
        // Three quarters of a turn.
        let direction = scenario.trajectory.at((last * 1e6).round() as u64).heading.direction();
        assert!((direction.y + 1.0).abs() < 0.01, "{file}: {direction}");
    }
}

#[test]
fn the_path_of_the_corpus_is_certified() {
    let scenario = read("file = \"own.csv\"").unwrap();
    assert_eq!(Verdict::judge(&scenario).unwrap().refusal(), None);
}
