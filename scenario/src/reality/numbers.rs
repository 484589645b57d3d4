//! Numbers within a range, for sections that have many of them.

use crate::section::{FieldError, Section};
use nalgebra::Vector3;
use std::ops::RangeInclusive;

/// A range of numbers and their unit.
#[derive(Debug, Clone)]
pub struct Allowed {
    range: RangeInclusive<f64>,
    unit: &'static str,
}

impl Allowed {
    /// A number in `range`; `unit` is for messages, empty without one.
    #[must_use]
    pub fn new(range: RangeInclusive<f64>, unit: &'static str) -> Self {
        Self { range, unit }
    }

    /// Refuses `value`, found at the path `field`, if it is outside.
    ///
    /// # Errors
    /// Names the field, what is allowed and what was found.
    pub fn check(&self, field: impl Into<String>, value: f64) -> Result<f64, FieldError> {
        if self.range.contains(&value) {
            return Ok(value);
        }
        let (least, greatest) = (self.range.start(), self.range.end());
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        Err(FieldError::new(field, format!("must be from {least} to {greatest}{unit}, found {value}")))
    }

    /// The number at `key`, which must be there.
    ///
    /// # Errors
    /// If it is missing, no number or outside.
    pub fn number(&self, section: &Section, key: &str) -> Result<f64, FieldError> {
        self.check(section.path_of(key), section.number(key)?)
    }

    /// The number at `key`, or `default` where it is left out.
    ///
    /// # Errors
    /// If it is no number or outside.
    pub fn number_or(&self, section: &Section, key: &str, default: f64) -> Result<f64, FieldError> {
        if section.has(key) { self.number(section, key) } else { Ok(default) }
    }

    /// The three numbers at `key`, zero where they are left out.
    ///
    /// # Errors
    /// If they are not three numbers, or one is outside.
    pub fn vector_or_zero(&self, section: &Section, key: &str) -> Result<Vector3<f64>, FieldError> {
        let vector = section.vector_or(key, Vector3::zeros())?;
        for (index, value) in vector.iter().enumerate() {
            self.check(format!("{}[{index}]", section.path_of(key)), *value)?;
        }
        Ok(vector)
    }
}

/// A whole number from 0 to 2^53 that seeds a random generator, or 0 where it is left out.
///
/// # Errors
/// If it is anything else.
pub fn seed(section: &Section) -> Result<u64, FieldError> {
    /// Whole numbers beyond this are not exact in double precision.
    const GREATEST: f64 = 9_007_199_254_740_992.0;
    let seed = section.number_or("seed", 0.0)?;
    if seed.fract() == 0.0 && (0.0..=GREATEST).contains(&seed) {
        Ok(seed as u64)
    } else {
        Err(FieldError::new(
            section.path_of("seed"),
            format!("must be a whole number from 0 to {GREATEST}, found {seed}"),
        ))
    }
}
