//! `[battery]`: a voltage that sags under load and falls as the battery empties.

use crate::key::{Bounds, Key, Layout};
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

const VOLTAGE: Bounds = Bounds::between(0.1, 1e3, "V");

/// The keys of `[battery]`.
pub const LAYOUT: Layout = Layout {
    name: "battery",
    about: "A voltage that sags under load and falls as the battery empties. Needs [rotors].",
    keys: &[
        Key::number("full_voltage", VOLTAGE, "Open circuit, full."),
        Key::number("empty_voltage", VOLTAGE, "Open circuit, empty."),
        Key::number("resistance", Bounds::between(0.0, 10.0, "ohm"), "Of battery and leads."),
        Key::number("capacity", Bounds::between(1e-3, 1e3, "A h"), "Of the full battery."),
        Key::number("charge", Bounds::SHARE, "At the start, as a share of the capacity.").or(1.0),
        Key::number("efficiency", Bounds::between(0.01, 1.0, ""), "Shaft power over electrical power.").or(1.0),
        Key::number("nominal_voltage", VOLTAGE, "At which [rotors] holds; left out: full_voltage.").optional(),
    ],
};

/// Reads `[battery]`.
///
/// # Errors
/// Names the field that is missing or refused.
pub fn read(root: &Section) -> Result<Option<Battery>, FieldError> {
    const SECONDS_PER_HOUR: f64 = 3600.0;
    let Some(section) = root.open(&LAYOUT)? else {
        return Ok(None);
    };
    let full_voltage = section.number("full_voltage")?;
    let empty_voltage = section.number("empty_voltage")?;
    if empty_voltage > full_voltage {
        let problem = format!("must be at most battery.full_voltage = {full_voltage} V, found {empty_voltage}");
        return Err(FieldError::new(section.path_of("empty_voltage"), problem));
    }
    Ok(Some(Battery {
        full_voltage,
        empty_voltage,
        resistance: section.number("resistance")?,
        capacity: SECONDS_PER_HOUR * section.number("capacity")?,
        charge: section.number("charge")?,
        efficiency: section.number("efficiency")?,
        nominal_voltage: section.number_or("nominal_voltage", full_voltage)?,
    }))
}
