//! Constants as sections of a scenario file: one declaration ([`controller_core::constants`]), read and written here.

use crate::number::Number;
use crate::section::{FieldError, Section};
use controller_core::constants::Constant;
use std::fmt::Write;

/// The keys of `section` among the constants of `table`.
#[must_use]
pub fn keys(table: &[Constant], section: &str) -> Vec<&'static str> {
    table.iter().filter(|constant| constant.section == section).map(|constant| constant.key).collect()
}

/// Reads the constants of `table` that stand in `section`; a constant that is left out has no value.
///
/// # Errors
/// Names the key that is unknown, or whose value is outside its range.
pub fn read<const N: usize>(
    root: &Section,
    section: &Section,
    name: &str,
    table: &[Constant; N],
) -> Result<[Option<f32>; N], FieldError> {
    section.allow(&keys(table, name))?;
    let mut values = [None; N];
    for (value, constant) in values.iter_mut().zip(table) {
        if constant.section == name && section.has(constant.key) {
            let number = section.number(constant.key)? as f32;
            constant.range.check(number, constant.path).map_err(|error| root.refused(&error))?;
            *value = Some(number);
        }
    }
    Ok(values)
}

/// Constants with their values as sections of a scenario file, each with its meaning.
#[must_use]
pub fn written(entries: impl Iterator<Item = (Constant, f32)>) -> String {
    let mut text = String::new();
    let mut before = "";
    for (constant, value) in entries {
        if constant.section != before {
            let _ = writeln!(text, "{}[{}]", if before.is_empty() { "" } else { "\n" }, constant.section);
            before = constant.section;
        }
        let _ = writeln!(text, "{:37} #{}", format!("{} = {}", constant.key, Number(value)), constant.about);
    }
    text
}
