//! `[vehicle]`, `[limits]` and `[gains]`: what the law and its certificate are about. All their fields are required.
//!
//! `[control] law` is `"paper"` (also where it is left out) or `"extended"` ([`crate::extended`]); `[control] thrust_floor` (N) is an
//! option of the paper's law: see [`controller_core::projection`].

use crate::extended::read_extended;
use crate::inertia;
use crate::section::{FieldError, Section};
use controller_core::certificate::configuration::Configuration;
use controller_core::extended::actuators::ActuatorParameters;
use controller_core::gains::{GainParameters, Gains};
use controller_core::reference::ReferenceBounds;
use controller_core::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};

/// Reads the three sections, the law and its options, for references within `bounds`. The extended law's estimates count on
/// rotors that respond as `actuators` says.
///
/// # Errors
/// Names the field that is missing, not physical, of another law, or leaves the law undefined: M_p >= g - K_a3.
pub fn read_configuration(
    root: &Section,
    bounds: &ReferenceBounds,
    actuators: ActuatorParameters,
    period: f64,
) -> Result<Configuration, FieldError> {
    let vehicle = read_vehicle(root)?;
    let limits = read_limits(root, &vehicle)?;
    let configuration = if is_extended(root)? {
        let law = read_extended(root, &vehicle, actuators, period)?;
        Configuration::extended(vehicle, limits, law, *bounds)
    } else if root.has("estimates") {
        let problem = "only the extended law estimates: set control.law = \"extended\", or leave the section out";
        return Err(FieldError::new("estimates", problem));
    } else {
        Configuration::new(vehicle, limits, read_gains(root, &vehicle)?, *bounds)
    };
    let configuration = configuration.map_err(|error| {
        let refused = root.refused(&error);
        let problem = format!(
            "{} (vehicle.gravity less the reference's vertical acceleration K_a3 = {})",
            refused.problem, bounds.vertical_acceleration
        );
        FieldError::new(refused.field, problem)
    })?;
    match root.optional_section("control")? {
        Some(control) if control.has("thrust_floor") => {
            let floor = control.number("thrust_floor")? as f32;
            configuration.with_thrust_floor(floor).map_err(|error| root.refused(&error))
        }
        _ => Ok(configuration),
    }
}

/// `[control] law`: whether it is the extended one.
fn is_extended(root: &Section) -> Result<bool, FieldError> {
    let law = match root.optional_section("control")? {
        Some(control) if control.has("law") => control.text("law")?,
        _ => "paper",
    };
    match law {
        "paper" => Ok(false),
        "extended" => Ok(true),
        other => Err(FieldError::new("control.law", format!("must be \"paper\" or \"extended\", found {other:?}"))),
    }
}

/// Reads `[vehicle]`.
fn read_vehicle(root: &Section) -> Result<Vehicle, FieldError> {
    let section = root.section("vehicle")?;
    section.allow(&["mass", "inertia", "gravity"])?;
    let mass = section.number("mass")? as f32;
    let moments = inertia::read(&section, "inertia")?;
    let gravity = section.number("gravity")? as f32;
    let parameters = VehicleParameters { mass, inertia: moments.map(|moment| moment as f32), gravity };
    let vehicle = Vehicle::new(parameters).map_err(|error| {
        let impossible = inertia::impossible("vehicle.inertia", &moments, &error);
        impossible.unwrap_or_else(|| root.refused(&error))
    })?;
    if !(mass * gravity).is_finite() {
        let problem =
            format!("must have a weight, with vehicle.gravity = {gravity}, within {:e} N, found {mass:e}", f32::MAX);
        return Err(FieldError::new("vehicle.mass", problem));
    }
    Ok(vehicle)
}

/// Reads `[limits]`.
fn read_limits(root: &Section, vehicle: &Vehicle) -> Result<Limits, FieldError> {
    let section = root.section("limits")?;
    section.allow(&["thrust_max", "torque_max"])?;
    let parameters = LimitParameters {
        thrust_max: section.number("thrust_max")? as f32,
        torque_max: section.vector("torque_max")?.map(|torque| torque as f32),
    };
    Limits::new(parameters, vehicle).map_err(|error| root.refused(&error))
}

/// Reads `[gains]`.
fn read_gains(root: &Section, vehicle: &Vehicle) -> Result<Gains, FieldError> {
    let section = root.section("gains")?;
    section
        .allow(&["k_p", "k_v", "k_f", "k_s", "k_theta", "k_omega", "m_p", "m_theta", "m_omega", "delta", "alpha"])?;
    let gain = |key: &str| section.number(key).map(|value| value as f32);
    let parameters = GainParameters {
        k_p: gain("k_p")?,
        k_v: gain("k_v")?,
        k_f: gain("k_f")?,
        k_s: gain("k_s")?,
        k_theta: gain("k_theta")?,
        k_omega: gain("k_omega")?,
        m_p: gain("m_p")?,
        m_theta: gain("m_theta")?,
        m_omega: gain("m_omega")?,
        delta: gain("delta")?,
        alpha: gain("alpha")?,
    };
    Gains::new(parameters, vehicle).map_err(|error| root.refused(&error))
}
