//! What is wrong with an argument, as Python's `ValueError`: the field and the reason.

use pyo3::PyErr;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use std::fmt::Display;

/// Of an input that cannot be used; `error` names the field and the reason.
pub fn refused(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// The same for `field`.
pub fn refused_field(field: &str, problem: impl Display) -> PyErr {
    PyValueError::new_err(format!("{field}: {problem}"))
}

/// Of an object of this `class` that is to be pickled in the middle of a flight.
pub fn in_flight(class: &str) -> PyErr {
    refused_field(class, "is in flight: pickle it as after a reset; copy.deepcopy copies it as it is, within a process")
}

/// Of output that cannot be written: an `OSError`.
pub fn unwritable(error: impl Display) -> PyErr {
    PyOSError::new_err(error.to_string())
}

/// Of well-posed work that came to nothing.
pub fn failed(error: impl Display) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}
