//! `[truth]`: the true vehicle, where it differs from its controller's model.
//!
//! The state that a flight reports and its controller gets is that of the body's origin, the *model's* centre of
//! mass, from which the rotors' positions are measured: it is where the markers and the flight controller are.

use crate::inertia;
use crate::key::{Bounds, Key, Layout, Values};
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
    /// a of the thrust a u + (1 - a) u^2 that a motor command u gives; none for the model's.
    pub thrust_curve: Option<f64>,
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
    pub fn model(vehicle: &Vehicle) -> Self {
        Self {
            mass: f64::from(vehicle.mass),
            inertia: vehicle.inertia.map(f64::from),
            centre_of_mass: Vector3::zeros(),
            thrust_scale: 1.0,
            rotor_scales: Vec::new(),
            thrust_curve: None,
            lag: None,
            rotor_inertia: 0.0,
            deadband: 0.0,
            rotor_radius: 0.0,
        }
    }
}

const SCALE_BOUNDS: Bounds = Bounds::between(0.0, 10.0, "");

/// How many keys of [`LAYOUT`] come before those of the rotors.
const BODY_KEYS: usize = 4;

/// The keys of `[truth]`.
pub const LAYOUT: Layout = Layout {
    name: "truth",
    about: "The true vehicle, where it differs from its controller's model.",
    keys: &[
        Key::number("mass", Bounds::physical("kg"), "Left out: vehicle.mass.").optional(),
        Key::new("inertia", inertia::VALUES, "About the true centre of mass, kg m^2; left out: vehicle.inertia.")
            .optional(),
        Key::vector("centre_of_mass", Bounds::between(-100.0, 100.0, "m"), "Body, from the model's.").or(0.0),
        Key::number("thrust_scale", SCALE_BOUNDS, "Of every rotor's thrust and drag torque.").or(1.0),
        Key::new("rotor_scales", Values::List(&Values::Number(SCALE_BOUNDS)), "Of each, besides; left out: 1.")
            .optional(),
        Key::number("thrust_curve", Bounds::SHARE, "a of a command's thrust; left out: rotors.thrust_curve.")
            .optional(),
        Key::number("lag", Bounds::between(0.0, 1.0, "s"), "Of the rotors' speeds; left out: rotors.lag.").optional(),
        Key::number("rotor_inertia", Bounds::between(0.0, 1.0, "kg m^2"), "Of each rotor about its axis.").or(0.0),
        Key::number("deadband", Bounds::between(0.0, 0.5, ""), "Share of the speed that a command must differ by.")
            .or(0.0),
        Key::number("rotor_radius", Bounds::between(0.0, 10.0, "m"), "For [ground]; 0: no ground effect.").or(0.0),
    ],
};

/// Reads `[truth]` of a vehicle with so many rotors, if it has any.
///
/// # Errors
/// Names the field that is refused.
pub fn read(root: &Section, model: &Vehicle, rotors: Option<usize>) -> Result<Option<Truth>, FieldError> {
    let Some(section) = root.open(&LAYOUT)? else {
        return Ok(None);
    };
    let modelled = Truth::model(model);
    let mass = section.number_or("mass", modelled.mass)?;
    let moments = if section.has("inertia") { inertia::read(&section, "inertia")? } else { modelled.inertia };
    let parameters =
        VehicleParameters { mass: mass as f32, inertia: moments.map(|moment| moment as f32), gravity: model.gravity };
    Vehicle::new(parameters).map_err(|error| {
        let impossible = inertia::impossible("truth.inertia", &moments, &error);
        impossible.unwrap_or_else(|| root.refused(&in_truth(error)))
    })?;
    let needs_rotors = LAYOUT.keys[BODY_KEYS..].iter().find(|key| section.has(key.name) && rotors.is_none());
    if let Some(Key { name, .. }) = needs_rotors {
        let problem = "needs [rotors]: add that section or leave this key out";
        return Err(FieldError::new(section.path_of(name), problem));
    }
    Ok(Some(Truth {
        mass,
        inertia: moments,
        centre_of_mass: section.vector("centre_of_mass")?,
        thrust_scale: section.number("thrust_scale")?,
        rotor_scales: read_rotor_scales(&section, rotors.unwrap_or(0))?,
        thrust_curve: section.optional_number("thrust_curve")?,
        lag: section.optional_number("lag")?,
        rotor_inertia: section.number("rotor_inertia")?,
        deadband: section.number("deadband")?,
        rotor_radius: section.number("rotor_radius")?,
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

fn read_rotor_scales(section: &Section, rotors: usize) -> Result<Vec<f64>, FieldError> {
    const KEY: &str = "rotor_scales";
    if !section.has(KEY) {
        return Ok(Vec::new());
    }
    let elements = section.elements(KEY, "a list of numbers, one for each rotor")?;
    if elements.len() != rotors {
        let problem = format!("must have one element for each of {rotors} rotors, found {}", elements.len());
        return Err(FieldError::new(section.path_of(KEY), problem));
    }
    let number = |(path, value): (String, &toml::Value)| {
        let number = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
        let found = number.ok_or_else(|| FieldError::new(&path, format!("must be a number, found {value}")))?;
        SCALE_BOUNDS.check(path, found)
    };
    elements.into_iter().map(number).collect()
}
