//! A vehicle's file, as the page has it.

use serde::Deserialize;

/// A vehicle's file.
#[derive(Debug, Clone, Deserialize)]
pub struct VehicleFile {
    /// Its name, for messages.
    pub file: String,
    /// Its text.
    pub text: String,
}
