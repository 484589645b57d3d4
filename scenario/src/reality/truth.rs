//! `[truth]`: the true vehicle, where it differs from its controller's model.
//!
//! ```toml
//! [truth]
//! mass = 0.55                          # kg;            left out: vehicle.mass
//! inertia = [3.9e-3, 3.9e-3, 7.5e-3]   # kg m^2, about the true centre of mass; left out: vehicle.inertia
//! centre_of_mass = [0.005, 0.0, 0.0]   # m, body, from the model's; left out: zero
//! thrust_scale = 0.8                   # scale of every rotor's thrust and drag torque; left out: 1
//! rotor_scales = [1.0, 0.95, 1.0, 1.0] # the same for each rotor, besides; left out: 1
//! thrust_curve = 0.3                   # a of the thrust a u + (1 - a) u^2 of a motor command u; left out: 0
//! lag = 0.015                          # s, of the rotors' speeds; left out: rotors.lag
//! rotor_inertia = 6e-7                 # kg m^2, of each rotor about its axis; left out: none
//! deadband = 0.02                      # of a rotor's speed: a nearer command changes nothing; left out: 0
//! rotor_radius = 0.1                   # m: [ground] lifts rotors of this radius; left out: no ground effect
//! ```
//!
//! The state that a flight reports and its controller gets is that of the body's origin, the *model's* centre of
//! mass, from which the rotors' positions are measured: it is where the markers and the flight controller are.

use super::numbers::Allowed;
use crate::inertia;
use crate::section::{FieldError, Section};
use controller_core::error::ParameterError;
use controller_core::vehicle::{Vehicle, VehicleParameters};
use nalgebra::Vector3;

/// The true vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// kg.
    pub mass: f64,
    /// Diagonal, about the true centre of mass, kg m^2.
    pub inertia: Vector3<f64>,
    /// The true centre of mass, m, body, from the model's.
    pub centre_of_mass: Vector3<f64>,
    /// The scale of every rotor's thrust and drag torque at its speed.
    pub thrust_scale: f64,
    /// The same for each rotor, besides; empty for 1.
    pub rotor_scales: Vec<f64>,
    /// a of the thrust a u + (1 - a) u^2 that a motor command u gives; the controller's model has a = 0.
    pub thrust_curve: f64,
    /// Lag of the rotors' speeds, s; none for the model's.
    pub lag: Option<f64>,
    /// Of each rotor about its axis, kg m^2.
    pub rotor_inertia: f64,
    /// Part of a rotor's commanded speed by which a new command must differ to be taken.
    pub deadband: f64,
    /// Of each rotor, m; zero without ground effect.
    pub rotor_radius: f64,
}

impl Truth {
    /// The model itself.
    #[must_use]
    pub fn of_model(vehicle: &Vehicle) -> Self {
        Self {
            mass: f64::from(vehicle.mass),
            inertia: vehicle.inertia.map(f64::from),
            centre_of_mass: Vector3::zeros(),
            thrust_scale: 1.0,
            rotor_scales: Vec::new(),
            thrust_curve: 0.0,
            lag: None,
            rotor_inertia: 0.0,
            deadband: 0.0,
            rotor_radius: 0.0,
        }
    }
}

/// Reads `[truth]` of a vehicle with so many rotors, if it has any.
///
/// # Errors
/// Names the field that is refused.
pub fn read(root: &Section, model: &Vehicle, rotors: Option<usize>) -> Result<Option<Truth>, FieldError> {
    let Some(section) = root.optional_section("truth")? else {
        return Ok(None);
    };
    const OF_ROTORS: [&str; 6] = ["rotor_scales", "thrust_curve", "lag", "rotor_inertia", "deadband", "rotor_radius"];
    section.allow(&[&["mass", "inertia", "centre_of_mass", "thrust_scale"][..], &OF_ROTORS].concat())?;
    let modelled = Truth::of_model(model);
    let mass = section.number_or("mass", modelled.mass)?;
    let moments = if section.has("inertia") { inertia::read(&section, "inertia")? } else { modelled.inertia };
    let parameters =
        VehicleParameters { mass: mass as f32, inertia: moments.map(|moment| moment as f32), gravity: model.gravity };
    Vehicle::new(parameters).map_err(|error| {
        let impossible = inertia::impossible("truth.inertia", &moments, &error);
        impossible.unwrap_or_else(|| root.refused(&in_truth(error)))
    })?;
    let scale = Allowed::new(0.0..=10.0, "");
    let rotor_scales = read_rotor_scales(&section, rotors, &scale)?;
    if let Some(key) = OF_ROTORS[1..].iter().find(|key| section.has(key) && rotors.is_none()) {
        return Err(without_rotors(&section, key));
    }
    let lag = section.has("lag").then(|| Allowed::new(0.0..=1.0, "s").number(&section, "lag")).transpose()?;
    Ok(Some(Truth {
        mass,
        inertia: moments,
        centre_of_mass: Allowed::new(-100.0..=100.0, "m").vector_or_zero(&section, "centre_of_mass")?,
        thrust_scale: scale.number_or(&section, "thrust_scale", 1.0)?,
        rotor_scales,
        thrust_curve: Allowed::new(0.0..=1.0, "").number_or(&section, "thrust_curve", 0.0)?,
        lag,
        rotor_inertia: Allowed::new(0.0..=1.0, "kg m^2").number_or(&section, "rotor_inertia", 0.0)?,
        deadband: Allowed::new(0.0..=0.5, "").number_or(&section, "deadband", 0.0)?,
        rotor_radius: Allowed::new(0.0..=10.0, "m").number_or(&section, "rotor_radius", 0.0)?,
    }))
}

/// The model's checks speak of `[vehicle]`; here they are about this section.
fn in_truth(error: ParameterError) -> ParameterError {
    let field = match error.field {
        "vehicle.mass" => "truth.mass",
        "vehicle.inertia[0]" => "truth.inertia[0]",
        "vehicle.inertia[1]" => "truth.inertia[1]",
        "vehicle.inertia[2]" => "truth.inertia[2]",
        "vehicle.inertia" => "truth.inertia",
        other => other,
    };
    ParameterError { field, ..error }
}

fn read_rotor_scales(section: &Section, rotors: Option<usize>, scale: &Allowed) -> Result<Vec<f64>, FieldError> {
    const KEY: &str = "rotor_scales";
    if !section.has(KEY) {
        return Ok(Vec::new());
    }
    let Some(rotors) = rotors else {
        return Err(without_rotors(section, KEY));
    };
    let elements = section.elements(KEY, "a list of numbers, one for each rotor")?;
    if elements.len() != rotors {
        let problem = format!("must have one element for each of {rotors} rotors, found {}", elements.len());
        return Err(FieldError::new(section.path_of(KEY), problem));
    }
    let number = |(path, value): (String, &toml::Value)| {
        let number = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
        let found = number.ok_or_else(|| FieldError::new(&path, format!("must be a number, found {value}")))?;
        scale.check(path, found)
    };
    elements.into_iter().map(number).collect()
}

fn without_rotors(section: &Section, key: &str) -> FieldError {
    FieldError::new(section.path_of(key), "needs [rotors]: add that section or leave this key out")
}
