//! `[failure]`: a rotor that fails.
//!
//! ```toml
//! [failure]
//! rotor = 2                            # numbered from 1
//! time = 5.0                           # s
//! thrust_left = 0.0                    # share of its command; left out: 0, it stops
//! ```

use super::numbers::Allowed;
use crate::section::{FieldError, Section};

/// A rotor that fails.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Failure {
    /// Which one, counted from 0.
    pub rotor: usize,
    /// When, s.
    pub time: f64,
    /// The share of its commanded thrust that it then settles at, at least 0 and below 1.
    pub thrust_left: f64,
}

/// Reads `[failure]` of one of so many rotors.
///
/// # Errors
/// Names the field that is missing or refused.
pub fn read(root: &Section, rotors: usize) -> Result<Option<Failure>, FieldError> {
    let Some(section) = root.optional_section("failure")? else {
        return Ok(None);
    };
    section.allow(&["rotor", "time", "thrust_left"])?;
    let number = section.number("rotor")?;
    if number.fract() != 0.0 || !(1.0..=rotors as f64).contains(&number) {
        let problem = format!("must be a rotor's number, 1 to {rotors}, found {number}");
        return Err(FieldError::new(section.path_of("rotor"), problem));
    }
    Ok(Some(Failure {
        rotor: number as usize - 1,
        time: Allowed::new(0.0..=1e7, "s").number(&section, "time")?,
        thrust_left: Allowed::new(0.0..=1.0, "").number_or(&section, "thrust_left", 0.0)?,
    }))
}
