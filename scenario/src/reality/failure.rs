//! `[failure]`: a rotor that fails.

use crate::key::{Bounds, Key, Layout, Values};
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

/// The keys of `[failure]`.
pub const LAYOUT: Layout = Layout {
    name: "failure",
    about: "A rotor that fails. Needs [rotors].",
    keys: &[
        Key::new("rotor", Values::Whole(Bounds::between(1.0, 8.0, "")), "Which one, numbered from 1."),
        Key::number("time", Bounds::between(0.0, 1e7, "s"), "When it fails."),
        Key::number("thrust_left", Bounds::SHARE, "Share of its commanded thrust; 0: it stops.").or(0.0),
    ],
};

/// Reads `[failure]` of one of so many rotors.
///
/// # Errors
/// Names the field that is missing or refused.
pub fn read(root: &Section, rotors: usize) -> Result<Option<Failure>, FieldError> {
    let Some(section) = root.open(&LAYOUT)? else {
        return Ok(None);
    };
    let number = section.number("rotor")?;
    if number.fract() != 0.0 || !(1.0..=rotors as f64).contains(&number) {
        let problem = format!("must be a rotor's number, 1 to {rotors}, found {number}");
        return Err(FieldError::new(section.path_of("rotor"), problem));
    }
    Ok(Some(Failure {
        rotor: number as usize - 1,
        time: section.number("time")?,
        thrust_left: section.number("thrust_left")?,
    }))
}
