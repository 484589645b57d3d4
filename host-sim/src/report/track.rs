//! Columns over one time axis.
//!
//! Numbers travel as base64 of little-endian single precision: five and a third bytes each, and the bits that the law
//! itself works with. Times are not stored: rows are evenly spaced.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value, json};

/// Columns over time, once for all plots and replays of a page.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Track {
    /// Its subject.
    pub name: String,
    /// The first row's time, s.
    pub start: f64,
    /// From one row to the next, s.
    pub step: f64,
    /// Name and values of each column, all equally long; a NaN is a gap.
    pub columns: Vec<(String, Vec<f32>)>,
}

impl Track {
    /// The values of a column.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f32]> {
        self.columns.iter().find(|(found, _)| found == name).map(|(_, values)| values.as_slice())
    }

    /// Its data for the page's program.
    #[must_use]
    pub fn json(&self) -> Value {
        let columns: Map<String, Value> =
            self.columns.iter().map(|(name, values)| (name.clone(), Value::from(encoded(values)))).collect();
        json!({ "name": self.name, "start": self.start, "step": self.step, "columns": columns })
    }
}

/// Base64 of little-endian single precision.
#[must_use]
pub fn encoded(values: &[f32]) -> String {
    STANDARD.encode(values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>())
}
