//! Values of TOML as numbers, vectors and texts.

use crate::field_error::FieldError;
use nalgebra::Vector3;
use toml::{Table, Value};

/// A value as TOML has it, in one line: a text may hold line ends and other control characters.
#[must_use]
pub fn in_line(value: &Value) -> String {
    match value {
        Value::String(text) => format!("{text:?}"),
        Value::Array(elements) => format!("[{}]", elements.iter().map(in_line).collect::<Vec<_>>().join(", ")),
        Value::Table(_) => "a table".to_owned(),
        other => other.to_string(),
    }
}

/// A table's value at `key` or, with an index, at `key[index]`.
pub fn element<'a>(table: &'a Table, key: &str) -> Option<&'a Value> {
    match key.strip_suffix(']').and_then(|key| key.split_once('[')) {
        Some((key, index)) => table.get(key)?.get(index.parse::<usize>().ok()?),
        None => table.get(key),
    }
}

/// The requirement on a vector.
pub const THREE_NUMBERS: &str = "a list of three numbers";

/// Three finite numbers at `path`.
///
/// # Errors
/// Names the element that is refused, or `path` if there are not three.
pub fn vector_at(path: &str, value: &Value) -> Result<Vector3<f64>, FieldError> {
    let Value::Array(elements) = value else {
        return Err(FieldError::new(path, format!("must be {THREE_NUMBERS}, found {}", value.type_str())));
    };
    if elements.len() != 3 {
        return Err(FieldError::new(path, format!("must be {THREE_NUMBERS}, found {}", elements.len())));
    }
    let mut vector = Vector3::zeros();
    for (index, (component, value)) in vector.iter_mut().zip(elements).enumerate() {
        *component = finite(value).map_err(|problem| FieldError::new(format!("{path}[{index}]"), problem))?;
    }
    Ok(vector)
}

/// A number that single precision can hold, or what is wrong with it.
pub fn finite(value: &Value) -> Result<f64, String> {
    let number = match value {
        Value::Float(number) => *number,
        Value::Integer(number) => *number as f64,
        other => return Err(format!("must be a number, found {}", other.type_str())),
    };
    if !number.is_finite() {
        Err(format!("must be a finite number, found {number}"))
    } else if number.abs() > f64::from(f32::MAX) {
        Err(format!("must be within ±{:e}, found {number:e}", f32::MAX))
    } else {
        Ok(number)
    }
}
