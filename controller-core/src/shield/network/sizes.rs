//! How large a network may be, and its numbers.

use crate::error::{ParameterError, Reason, require, require_finite};

/// The number of inputs.
pub const INPUT_COUNT: usize = 22;

/// The number of outputs.
pub const OUTPUT_COUNT: usize = 4;

/// The greatest number of outputs of a layer.
pub const WIDTH_MAX: usize = 64;

/// The greatest number of layers.
pub const LAYERS_MAX: usize = 4;

/// The greatest number of values that recurrent layers remember together.
pub const MEMORY_MAX: usize = 64;

/// The greatest magnitude of a weight, a bias, a scale, or a value that is remembered at first.
pub const WEIGHT_MAX: f32 = 1e4;

/// A number that a network may have.
pub fn checked(value: f32, field: &'static str) -> Result<(), ParameterError> {
    require_finite(value, field)?;
    require(value.abs() <= WEIGHT_MAX, field, Reason::Above(WEIGHT_MAX))
}
