//! A field of a file that was refused.

use std::fmt;

/// A field that was refused, and why; `problem` also says what is allowed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldError {
    /// Dotted path in the file, e.g. `vehicle.inertia[2]`.
    pub field: String,
    /// The error and the allowed values, in one line.
    pub problem: String,
}

impl FieldError {
    /// Refuses `field`. Both texts lose their middle where a key or a value of the file makes them endless.
    pub fn new(field: impl Into<String>, problem: impl Into<String>) -> Self {
        Self { field: shortened(field.into(), 200), problem: shortened(problem.into(), 2000) }
    }
}

/// `text` without its middle where it has more than `longest` characters.
fn shortened(text: String, longest: usize) -> String {
    let length = text.chars().count();
    if length <= longest {
        return text;
    }
    let part = longest / 2;
    let head: String = text.chars().take(part).collect();
    head + "…" + &text.chars().skip(length - part).collect::<String>()
}

impl fmt::Display for FieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.field, self.problem)
    }
}
