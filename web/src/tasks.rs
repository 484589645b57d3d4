//! What a flight of the page is, as a scenario.
//!
//! | task | |
//! |---|---|
//! | `upside_down` | hover where it starts, roll -179 degrees, yaw 100 degrees off |
//! | `wind` | hover |
//! | `circle` | a circle of 3 m, at a share of the greatest speed that certifies |
//! | `step` | hover 1 m from where it is |
//! | `own` | a trajectory file's path, from its start |
//!
//! The wind sets in after a second. The file's own wind, disturbances, failures and noise are left out.

use crate::vehicle_file::VehicleFile;
use controller_core::reference::harmonic::{Harmonic, HarmonicParameters, HeadingParameters};
use host_sim::commands::certify::may_fly::{CIRCLE_RADIUS_M, circle};
use host_sim::flight::tasks::{hover, in_still_air, in_wind, of_mass_and_thrust, recovery};
use nalgebra::Vector3;
use scenario::Scenario;
use serde::Deserialize;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;
use toml_edit::{DocumentMut, InlineTable, value};

/// The longest flights, s.
const RECOVERY_S: f64 = 30.0;
const WIND_S: f64 = 10.0;
const STEP_S: f64 = 10.0;
const CIRCLE_MAX_S: f64 = 30.0;
const OWN_MAX_S: f64 = 120.0;

/// Where the step begins.
const STEP_START_M: Vector3<f64> = Vector3::new(-1.0, 0.0, 0.0);
/// Laps of the circle, the share of the certified speed, and the greatest speed: faster is hard to watch.
const CIRCLE_LAPS: f64 = 2.0;
const SPEED_SHARE: f64 = 0.6;
const SPEED_MAX_M_PER_S: f64 = 5.0;
/// The slowest circle that is flown.
const SPEED_MIN_M_PER_S: f64 = 0.1;

/// What the sliders may say.
const WIND_MAX_M_PER_S: f64 = 20.0;
const MASS_FACTORS: [f64; 2] = [0.5, 2.0];
const WEAK_SHARES: [f64; 2] = [0.1, 1.0];

/// A task.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Task {
    /// From upside down.
    UpsideDown,
    /// Hover in wind.
    Wind,
    /// A circle.
    Circle,
    /// A step of 1 m.
    Step,
    /// A trajectory file.
    Own,
}

/// What is to fly.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FlightRequest {
    /// The task.
    pub task: Task,
    /// m/s, along world x.
    pub wind: f64,
    /// The real mass, as a factor of the file's.
    pub mass: f64,
    /// The weak rotor, numbered from 1; 0: none.
    pub weak_rotor: usize,
    /// The share of its command that it delivers.
    pub weak_share: f64,
    /// A trajectory file's text, for the task own.
    #[serde(default)]
    pub trajectory: String,
    /// Its name, for messages.
    #[serde(default)]
    pub trajectory_file: String,
    /// Which laws fly.
    pub laws: Vec<LawName>,
}

/// A law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LawName {
    /// The file's.
    Ours,
    /// INDI.
    Indi,
}

/// The vehicle of a file, in still air.
///
/// # Errors
/// One line: the file, the field, and what is wrong.
pub fn vehicle(VehicleFile { file, text }: &VehicleFile) -> Result<Scenario, String> {
    Ok(in_still_air(&Scenario::parse(text, file).map_err(|error| error.to_string())?))
}

/// The flight of that vehicle; whether it ends in a place to hold.
///
/// # Errors
/// One line: the file or the slider, and what is wrong.
pub fn scenario(
    vehicle: &Scenario,
    VehicleFile { file, text }: &VehicleFile,
    request: &FlightRequest,
) -> Result<(Scenario, bool), String> {
    let of_parameter = |error: controller_core::error::ParameterError| format!("{file}: {error}");
    let (flight, holds) = match request.task {
        Task::UpsideDown => (recovery(vehicle, RECOVERY_S).map_err(of_parameter)?, true),
        Task::Wind => (hover(vehicle, Vector3::zeros(), WIND_S).map_err(of_parameter)?, false),
        Task::Step => (hover(vehicle, STEP_START_M, STEP_S).map_err(of_parameter)?, true),
        Task::Circle => (round(vehicle).map_err(|what| format!("{file}: {what}"))?, false),
        Task::Own => {
            let along = Scenario::parse(&along(text, request)?, &request.trajectory_file);
            (own(vehicle, &along.map_err(|error| error.to_string())?)?, false)
        }
    };
    Ok((circumstances(flight, request)?, holds))
}

/// The sliders' circumstances.
fn circumstances(flight: Scenario, request: &FlightRequest) -> Result<Scenario, String> {
    let FlightRequest { wind, mass, weak_rotor, weak_share, .. } = *request;
    let within = |name: &str, value: f64, [least, greatest]: [f64; 2]| {
        let fits = (least..=greatest).contains(&value);
        if fits { Ok(()) } else { Err(format!("{name}: must be from {least} to {greatest}, found {value}")) }
    };
    within("wind", wind, [0.0, WIND_MAX_M_PER_S])?;
    within("mass", mass, MASS_FACTORS)?;
    within("weak_share", weak_share, WEAK_SHARES)?;
    let rotors = flight.configuration.rotors().map_or(0, |rotors| rotors.len());
    if weak_rotor > rotors {
        return Err(format!("weak_rotor: the vehicle has {rotors} rotors, found {weak_rotor}"));
    }
    let mut flight = if wind > 0.0 { in_wind(&flight, wind) } else { flight };
    if mass != 1.0 || weak_rotor > 0 {
        flight = of_mass_and_thrust(&flight, mass, 1.0);
    }
    if let Some(truth) = flight.reality.truth.as_mut().filter(|_| weak_rotor > 0) {
        truth.rotor_scales = (1..=rotors).map(|rotor| if rotor == weak_rotor { weak_share } else { 1.0 }).collect();
    }
    Ok(flight)
}

/// A circle about the origin, from rest at its first point.
fn round(vehicle: &Scenario) -> Result<Scenario, String> {
    let certified = circle(vehicle).map_or(0.0, |circle| circle.speed);
    let speed = (SPEED_SHARE * certified).min(SPEED_MAX_M_PER_S);
    if speed < SPEED_MIN_M_PER_S {
        return Err(format!("no circle of {CIRCLE_RADIUS_M} m certifies, not even a slow one"));
    }
    let turning = speed / CIRCLE_RADIUS_M;
    let start = Vector3::new(CIRCLE_RADIUS_M, 0.0, 0.0);
    let mut flight =
        hover(vehicle, start, (CIRCLE_LAPS * TAU / turning).min(CIRCLE_MAX_S)).map_err(|error| error.to_string())?;
    let reference = HarmonicParameters {
        center: [0.0; 3],
        amplitude: [CIRCLE_RADIUS_M as f32, CIRCLE_RADIUS_M as f32, 0.0].map(Into::into),
        frequency: [turning, turning, 0.0],
        phase: [0.0, -FRAC_PI_2, 0.0],
        heading: HeadingParameters { offset: 0.0, rate: 0.0, amplitude: 0.0, frequency: 0.0 },
    };
    flight.trajectory = Arc::new(Harmonic::new(reference).map_err(|error| error.to_string())?);
    Ok(flight)
}

/// The file's text with the trajectory in the place of its reference.
fn along(text: &str, request: &FlightRequest) -> Result<String, String> {
    if request.trajectory.trim().is_empty() {
        return Err("trajectory: choose a file with a path first: rows of t, x, y, z, comma separated".to_owned());
    }
    let plain = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut document: DocumentMut =
        plain.parse().map_err(|error: toml_edit::TomlError| error.message().replace('\n', " "))?;
    document.remove("initial");
    let mut reference = InlineTable::new();
    reference.insert("kind", "trajectory".into());
    reference.insert("data", request.trajectory.as_str().into());
    document["reference"] = value(reference);
    Ok(document.to_string())
}

/// The flight along the reference of `along`, from rest at its start.
fn own(vehicle: &Scenario, along: &Scenario) -> Result<Scenario, String> {
    let start = along.trajectory.at(0).position.map(f64::from);
    let duration = along.timing.duration().min(OWN_MAX_S);
    let flight = hover(vehicle, start, duration).map_err(|error| error.to_string())?;
    Ok(Scenario { trajectory: Arc::clone(&along.trajectory), ..flight })
}
