//! `[vehicle]`, `[limits]` and `[gains]`: what the certificate and the law are about. All fields are required.

use super::section::{FieldError, Section};
use super::refused;
use controller_core::gains::{GainParameters, Gains};
use controller_core::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};

/// Reads `[vehicle]`.
///
/// # Errors
/// Names the field that is missing or not physical.
pub fn read_vehicle(root: &Section) -> Result<Vehicle, FieldError> {
    let section = root.section("vehicle")?;
    section.allow(&["mass", "inertia", "gravity"])?;
    let parameters = VehicleParameters {
        mass: section.number("mass")? as f32,
        inertia: section.vector("inertia")?.map(|moment| moment as f32),
        gravity: section.number("gravity")? as f32,
    };
    Vehicle::new(parameters).map_err(|error| refused(root, &error))
}

/// Reads `[limits]`.
///
/// # Errors
/// Names the field that is missing, not positive, or too small to hover.
pub fn read_limits(root: &Section, vehicle: &Vehicle) -> Result<Limits, FieldError> {
    let section = root.section("limits")?;
    section.allow(&["thrust_max", "torque_max"])?;
    let parameters = LimitParameters {
        thrust_max: section.number("thrust_max")? as f32,
        torque_max: section.vector("torque_max")?.map(|torque| torque as f32),
    };
    Limits::new(parameters, vehicle).map_err(|error| refused(root, &error))
}

/// Reads `[gains]`.
///
/// # Errors
/// Names the gain that is missing or for which the law is undefined.
pub fn read_gains(root: &Section, vehicle: &Vehicle) -> Result<Gains, FieldError> {
    let section = root.section("gains")?;
    section.allow(&[
        "k_p", "k_v", "k_f", "k_s", "k_theta", "k_omega", "m_p", "m_theta", "m_omega", "delta", "alpha",
    ])?;
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
    Gains::new(parameters, vehicle).map_err(|error| refused(root, &error))
}
