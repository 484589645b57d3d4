//! Flights that something else flew, to look at: pictures, moving pictures and pages.
//!
//! They are drawn by what draws the flights of `host-sim`. A flight is its rows, a control period apart.

use crate::errors::{failed, refused_field, unwritable};
use crate::rows::{REFERENCE_COLUMNS, Rows, STATE_COLUMNS, WRENCH_COLUMNS, counted, rows, vector};
use crate::scenarios::Scenario;
use host_sim::reports::plots::path::poses;
use host_sim::reports::plots::replay::{Stretch, gif, still};
use host_sim::reports::report::page::{Block, Page, Section};
use host_sim::reports::report::plot::{Color, Curve, Plot};
use host_sim::reports::report::replay::{Body, Replay};
use host_sim::reports::report::track::Track;
use nalgebra::Vector3;
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use std::path::PathBuf;

/// The longest moving picture, s.
const DURATION_MAX_S: f64 = 60.0;

/// Lines in the world.
type Things = Vec<Vec<Vector3<f64>>>;

/// A picture (420, 480, 3) of uint8, as a camera that stands far away: the path of `states` (n, 13) with its shadow on
/// the floor, that of `references` (n, 19), and the vehicle, larger than life, at the last of them.
///
/// Args:
///     states, references: of a flight, row by row.
///     things: lines that stand in the world, each (k, 3), m: a gate.
///     around: points (k, 3), m, that the picture holds as well, so that it stands still while the path grows.
#[pyfunction]
#[pyo3(signature = (states, references, *, things=Vec::new(), around=None))]
#[allow(clippy::needless_pass_by_value)] // Python's lists come by value
pub fn picture<'py>(
    py: Python<'py>,
    states: &Bound<'py, PyAny>,
    references: &Bound<'py, PyAny>,
    things: Vec<Bound<'py, PyAny>>,
    around: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray3<u8>>> {
    let (states, references) = flight(states, references)?;
    let track = track(&states, &references, 1.0);
    let around = around.map_or(Ok(Vec::new()), |around| points(around, "around"))?;
    let drawing = still(&poses(&track), &lines(&things)?, &around);
    let pixels = drawing.pixels().ok_or_else(|| failed("picture: cannot be drawn"))?;
    let colors = pixels.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]);
    let (width, height) = (drawing.size.0 as usize, drawing.size.1 as usize);
    PyArray1::from_vec(py, colors.collect()).reshape([height, width, 3])
}

/// Writes a flight that something else flew into a file that any browser opens: a moving picture, `.gif`, or a page
/// with a replay and plots, `.html`.
///
/// Args:
///     scenario: its vehicle and its period.
///     path: what to write.
///     states, references, wrenches: of a flight, row by row: (n, 13), (n, 19), (n, 4).
///     things: lines that stand in the world, each (k, 3), m; a page has none.
///     by_policy: (n,), whether a policy flew; the page then shows it.
///     speed: seconds of flight in a second of the moving picture.
#[pyfunction]
#[pyo3(signature = (scenario, path, states, references, wrenches, *, things=Vec::new(), by_policy=None, speed=1.0))]
#[allow(clippy::needless_pass_by_value, clippy::too_many_arguments)] // its user names them
pub fn replay(
    scenario: &Scenario,
    path: PathBuf,
    states: &Bound<'_, PyAny>,
    references: &Bound<'_, PyAny>,
    wrenches: &Bound<'_, PyAny>,
    things: Vec<Bound<'_, PyAny>>,
    by_policy: Option<&Bound<'_, PyAny>>,
    speed: f64,
) -> PyResult<()> {
    let (states, references) = flight(states, references)?;
    let wrenches = rows::<WRENCH_COLUMNS>(wrenches, states.len(), "wrenches")?;
    let by_policy = by_policy.map(|rows| vector(rows, "by_policy")).transpose()?;
    if let Some(other) = by_policy.as_ref().filter(|rows| rows.len() != states.len()) {
        return Err(refused_field(
            "by_policy",
            format!("must have shape ({},), found ({},)", states.len(), other.len()),
        ));
    }
    if !(0.05..=100.0).contains(&speed) {
        return Err(refused_field("speed", format!("must be from 0.05 to 100, found {speed}")));
    }
    let things = lines(&things)?;
    let mut track = track(&states, &references, scenario.read.timing.period());
    let bytes = match path.extension().and_then(|extension| extension.to_str()) {
        Some("gif") => {
            let long = track.end() / speed;
            if long > DURATION_MAX_S {
                return Err(refused_field(
                    "speed",
                    format!(
                        "the picture would take {long:.0} s, at most {DURATION_MAX_S} are allowed: take a higher one"
                    ),
                ));
            }
            let stretch = Stretch { from: 0.0, to: track.end(), speed };
            gif(&track, &things, stretch).map_err(|error| failed(format!("{}: {error}", path.display())))?
        }
        Some("html") => {
            let single = |number: f64| number as f32;
            track.columns.push(("thrust".into(), wrenches.iter().map(|row| single(row[0])).collect()));
            if let Some(rows) = by_policy {
                track.columns.push(("by_policy".into(), rows.into_iter().map(single).collect()));
            }
            page(scenario, track).html().into_bytes()
        }
        _ => return Err(refused_field("path", format!("must end in .gif or .html, found {}", path.display()))),
    };
    std::fs::write(&path, bytes).map_err(|error| unwritable(format!("{}: cannot be written: {error}", path.display())))
}

/// States and references of one flight.
fn flight(
    states: &Bound<'_, PyAny>,
    references: &Bound<'_, PyAny>,
) -> PyResult<(Rows<STATE_COLUMNS>, Rows<REFERENCE_COLUMNS>)> {
    let states = counted::<STATE_COLUMNS>(states, "states")?;
    if states.is_empty() {
        return Err(refused_field("states", "must have a row at least"));
    }
    let references = rows::<REFERENCE_COLUMNS>(references, states.len(), "references")?;
    Ok((states, references))
}

fn lines(things: &[Bound<'_, PyAny>]) -> PyResult<Things> {
    things.iter().map(|thing| points(thing, "things")).collect()
}

fn points(array: &Bound<'_, PyAny>, field: &str) -> PyResult<Vec<Vector3<f64>>> {
    Ok(counted::<3>(array, field)?.into_iter().map(Vector3::from).collect())
}

/// The columns that replays and plots need, by their names in log.csv.
fn track(states: &Rows<STATE_COLUMNS>, references: &Rows<REFERENCE_COLUMNS>, period: f64) -> Track {
    const NAMES: [&str; STATE_COLUMNS] = ["px", "py", "pz", "vx", "vy", "vz", "qw", "qx", "qy", "qz", "wx", "wy", "wz"];
    let single = |column: &mut dyn Iterator<Item = f64>| column.map(|number| number as f32).collect::<Vec<f32>>();
    let of_states =
        NAMES.iter().enumerate().map(|(place, name)| (*name, single(&mut states.iter().map(|row| row[place]))));
    let of_references = ["pdx", "pdy", "pdz"]
        .iter()
        .enumerate()
        .map(|(place, name)| (*name, single(&mut references.iter().map(|row| row[place]))));
    let yaw = single(&mut references.iter().map(|row| row[16].atan2(row[15]).to_degrees()));
    let distance = |(state, reference): (&[f64; STATE_COLUMNS], &[f64; REFERENCE_COLUMNS])| {
        (0..3).map(|axis| (state[axis] - reference[axis]).powi(2)).sum::<f64>().sqrt()
    };
    let tilt = |row: &[f64; STATE_COLUMNS]| {
        (1.0 - 2.0 * (row[7].powi(2) + row[8].powi(2))).clamp(-1.0, 1.0).acos().to_degrees()
    };
    let worked_out = [
        ("yaw_d", yaw),
        ("distance", single(&mut states.iter().zip(references).map(distance))),
        ("tilt", single(&mut states.iter().map(tilt))),
    ];
    let columns = of_states.chain(of_references).chain(worked_out).map(|(name, values)| (name.to_owned(), values));
    Track { name: "flight".into(), start: 0.0, step: period, columns: columns.collect() }
}

fn page(scenario: &Scenario, track: Track) -> Page {
    let configuration = &scenario.read.configuration;
    let vehicle = configuration.vehicle();
    let name = scenario.read.name.clone();
    let rotors = configuration.rotors().into_iter().flat_map(|rotors| rotors.iter());
    let replay = Replay {
        bodies: vec![Body { track: 0, label: name.clone(), color: Color::Blue }],
        rotors: rotors.map(|rotor| rotor.position.cast().into()).collect(),
        hover_thrust: f64::from(vehicle.mass * vehicle.gravity),
    };
    let curves = |names: &[&str]| {
        names
            .iter()
            .enumerate()
            .map(|(place, name)| Curve::new(*name, *name, Color::at_place(place)))
            .collect::<Vec<_>>()
    };
    let goal = curves(&["pdx", "pdy", "pdz"]).into_iter().map(Curve::dashed).collect();
    let mut plots = vec![
        Plot::new("Position", "m", [curves(&["px", "py", "pz"]), goal].concat()),
        Plot::new("Distance from the reference", "m", curves(&["distance"])).from_zero(),
        Plot::new("Velocity", "m/s", curves(&["vx", "vy", "vz"])),
        Plot::new("Tilt of the thrust axis", "°", curves(&["tilt"])).from_zero(),
        Plot::new("Body rates", "rad/s", curves(&["wx", "wy", "wz"])),
        Plot::new("Thrust, as commanded", "N", curves(&["thrust"])).from_zero(),
    ];
    if track.column("by_policy").is_some() {
        plots.push(Plot::new("The policy flies", "", curves(&["by_policy"])).from_zero());
    }
    let sections = [("Replay", Block::Replay(replay)), ("Plots", Block::Plots(plots))];
    Page {
        title: name,
        kind: "episode".into(),
        lead: format!("{:.2} s of simulated flight. Dashed lines are references.", track.end()),
        tracks: vec![track],
        sections: sections.map(|(title, block)| Section { title: title.into(), blocks: vec![block] }).into(),
        ..Page::default()
    }
}
