//! The scenario with a vehicle's own numbers: the original text, comments kept.
//!
//! Replaced are mass, inertia, the rotors' thrust and drag coefficients (or the thrusts that stand for them), lag, the
//! delay, rounded to whole plant steps, `drag`, as linear drag in place of all its keys, and the rotors' positions,
//! which count from the centre of mass.

use super::quantities::{Quantities, Quantity};
use toml_edit::{Array, DocumentMut, Item, Table, value};

/// The numbers that a scenario takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Values {
    /// kg.
    pub mass: f64,
    /// kg m^2.
    pub inertia: [f64; 3],
    /// Of the file's rotors.
    pub thrust_scale: f64,
    /// s.
    pub lag: f64,
    /// s.
    pub delay: f64,
    /// From the file's, x and y, m.
    pub centre_of_mass: [f64; 2],
    /// kg/s.
    pub drag: [f64; 3],
}

impl Values {
    /// The estimates.
    #[must_use]
    pub fn estimates(identified: &Quantities) -> Self {
        let value = |quantity: &Quantity| quantity.value;
        Self {
            mass: identified.mass.value,
            inertia: identified.inertia.each_ref().map(value),
            thrust_scale: identified.thrust_scale.value,
            lag: identified.lag.value,
            delay: identified.delay.value,
            centre_of_mass: identified.centre_of_mass.each_ref().map(value),
            // The air takes energy, whatever noise says.
            drag: identified.drag.each_ref().map(|drag| drag.value.max(0.0)),
        }
    }
}

/// `original` with these numbers and this name; `step` is its plant step, s.
///
/// # Errors
/// If `original` is no scenario with rotors; a text that was read as one is.
pub fn rewritten(original: &str, name: &str, values: &Values, step: f64) -> Result<String, String> {
    let mut document: DocumentMut = original.parse().map_err(|error| format!("not TOML: {error}"))?;
    document["name"] = value(name);
    document["vehicle"]["mass"] = value(digits(values.mass));
    document["vehicle"]["inertia"] = list(&values.inertia);
    let rotors = document.get_mut("rotors").ok_or("rotors: is missing")?;
    // Two of them in either form, and thrust_min only where it is not zero.
    for key in ["thrust_coefficient", "drag_coefficient", "thrust_max", "thrust_min"] {
        if let Some(old) = rotors.get(key).and_then(number) {
            rotors[key] = value(digits(old * values.thrust_scale));
        }
    }
    rotors["lag"] = value(digits(values.lag));
    let positions = rotors.get_mut("position").and_then(Item::as_array_mut).ok_or("rotors.position: is missing")?;
    for position in positions.iter_mut() {
        let position = position.as_array_mut().ok_or("rotors.position: must be lists of three numbers")?;
        for (axis, centre) in values.centre_of_mass.into_iter().enumerate() {
            let old = position.get(axis).and_then(|old| number(&Item::Value(old.clone())));
            let old = old.ok_or("rotors.position: must be lists of three numbers")?;
            // Rounded to 0.01 mm.
            let mut new = toml_edit::Value::from(((old - centre) * 1e5).round() * 1e-5);
            if axis > 0 {
                new.decor_mut().set_prefix(" ");
            }
            position.replace_formatted(axis, new);
        }
    }
    if !document.contains_key("sampling") {
        document["sampling"] = Item::Table(Table::new());
    }
    document["sampling"]["delay"] = value(digits((values.delay / step).round() * step));
    document["drag"] = Item::Table(Table::new());
    document["drag"]["linear"] = list(&values.drag);
    Ok(document.to_string())
}

fn number(item: &Item) -> Option<f64> {
    item.as_float().or(item.as_integer().map(|whole| whole as f64))
}

fn list(numbers: &[f64]) -> Item {
    value(numbers.iter().map(|number| digits(*number)).collect::<Array>())
}

/// Five significant digits.
fn digits(number: f64) -> f64 {
    format!("{number:.4e}").parse().unwrap_or(number)
}
