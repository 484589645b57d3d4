//! Whole numbers as arguments: Python's are of any size, and what is beyond a machine's is refused by name too.

use crate::errors::refused_field;
use pyo3::exceptions::PyOverflowError;
use pyo3::prelude::*;
use std::fmt;
use std::ops::RangeInclusive;

/// A whole number that is not judged yet.
pub struct Whole(Result<u64, String>);

impl Whole {
    /// What an argument is where it is left out.
    pub const fn new(value: u64) -> Self {
        Self(Ok(value))
    }

    /// The number.
    ///
    /// # Errors
    /// Names `field` if it is not in `allowed`.
    pub fn within(&self, field: &str, allowed: RangeInclusive<u64>) -> PyResult<u64> {
        let (least, most) = (allowed.start(), allowed.end());
        let refused = || refused_field(field, format!("must be a whole number from {least} to {most}, found {self}"));
        self.value().filter(|value| allowed.contains(value)).ok_or_else(refused)
    }

    /// The number, if a machine's are as great.
    pub fn value(&self) -> Option<u64> {
        self.0.as_ref().ok().copied()
    }
}

impl fmt::Display for Whole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Ok(value) => write!(f, "{value}"),
            Err(text) => f.write_str(text),
        }
    }
}

impl<'py> FromPyObject<'_, 'py> for Whole {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match given.extract::<u64>() {
            Ok(value) => Ok(Self(Ok(value))),
            Err(error) if error.is_instance_of::<PyOverflowError>(given.py()) => {
                // Python writes no integer of more than some thousand digits.
                let shown =
                    given.str().map_or_else(|_| "one of thousands of digits".to_owned(), |text| text.to_string());
                Ok(Self(Err(shown)))
            }
            Err(error) => Err(error),
        }
    }
}
