//! `[battery]`: a voltage that sags under load and falls as the battery empties.
//!
//! ```toml
//! [battery]
//! full_voltage = 12.6                  # V, open circuit, full
//! empty_voltage = 10.5                 # V, open circuit, empty
//! resistance = 0.03                    # ohm, battery and leads
//! capacity = 2.2                       # A h
//! charge = 1.0                         # of the capacity, at the start; left out: 1
//! efficiency = 0.6                     # of motors and controllers: shaft power over electrical power; left out: 1
//! nominal_voltage = 12.6               # V, at which [rotors] holds; left out: full_voltage
//! ```

use super::numbers::Allowed;
use crate::section::{FieldError, Section};

/// A battery.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Battery {
    /// Open circuit, full, V.
    pub full_voltage: f64,
    /// Open circuit, empty, V.
    pub empty_voltage: f64,
    /// Ohm.
    pub resistance: f64,
    /// A s.
    pub capacity: f64,
    /// Of the capacity, at the start.
    pub charge: f64,
    /// Shaft power over electrical power.
    pub efficiency: f64,
    /// At which the rotors' data hold, V.
    pub nominal_voltage: f64,
}

/// Reads `[battery]`.
///
/// # Errors
/// Names the field that is missing or refused.
pub fn read(root: &Section) -> Result<Option<Battery>, FieldError> {
    const SECONDS_PER_HOUR: f64 = 3600.0;
    let Some(section) = root.optional_section("battery")? else {
        return Ok(None);
    };
    section.allow(&[
        "full_voltage",
        "empty_voltage",
        "resistance",
        "capacity",
        "charge",
        "efficiency",
        "nominal_voltage",
    ])?;
    let voltage = Allowed::new(0.1..=1e3, "V");
    let full_voltage = voltage.number(&section, "full_voltage")?;
    let empty_voltage = voltage.number(&section, "empty_voltage")?;
    if empty_voltage > full_voltage {
        let problem = format!("must be at most battery.full_voltage = {full_voltage} V, found {empty_voltage}");
        return Err(FieldError::new(section.path_of("empty_voltage"), problem));
    }
    Ok(Some(Battery {
        full_voltage,
        empty_voltage,
        resistance: Allowed::new(0.0..=10.0, "ohm").number(&section, "resistance")?,
        capacity: SECONDS_PER_HOUR * Allowed::new(1e-3..=1e3, "A h").number(&section, "capacity")?,
        charge: Allowed::new(0.0..=1.0, "").number_or(&section, "charge", 1.0)?,
        efficiency: Allowed::new(0.01..=1.0, "").number_or(&section, "efficiency", 1.0)?,
        nominal_voltage: voltage.number_or(&section, "nominal_voltage", full_voltage)?,
    }))
}
