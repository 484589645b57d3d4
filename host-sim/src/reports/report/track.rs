//! Columns over one time axis.
//!
//! Numbers travel as base64 of little-endian single precision: five and a third bytes each, and the bits that the law
//! itself works with. Times are not stored: rows are evenly spaced.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value, json};

/// What was recorded over time, once for all plots and replays of a page.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Track {
    /// What or who it is about.
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
    pub fn column(&self, name: &str) -> Option<&[f32]> {
        self.columns.iter().find(|(found, _)| found == name).map(|(_, values)| values.as_slice())
    }

    /// One row after the last, s: a flight of 40 s ends at 40.
    pub fn end(&self) -> f64 {
        self.start + self.step * self.columns.iter().map(|(_, values)| values.len()).max().unwrap_or(0) as f64
    }

    /// The same without what comes after `end`, s.
    pub fn until(&self, end: f64) -> Self {
        let rows = ((end - self.start) / self.step + 1e-6).max(0.0) as usize;
        let cut = |(name, values): &(String, Vec<f32>)| (name.clone(), values[..rows.min(values.len())].to_vec());
        Self { columns: self.columns.iter().map(cut).collect(), name: self.name.clone(), ..*self }
    }

    /// Columns of points (s, value) that are evenly spaced and begin together.
    pub fn of_points(columns: Vec<(String, Vec<(f64, f64)>)>) -> Self {
        let longest = columns.iter().map(|(_, points)| points.as_slice()).max_by_key(|points| points.len());
        let (start, step) = match longest.unwrap_or_default() {
            [first, second, ..] => (first.0, second.0 - first.0),
            [only] => (only.0, 1.0),
            [] => (0.0, 1.0),
        };
        let values = |points: Vec<(f64, f64)>| points.into_iter().map(|(_, value)| value as f32).collect();
        let columns = columns.into_iter().map(|(name, points)| (name, values(points))).collect();
        Self { name: String::new(), start, step, columns }
    }

    /// What the page's program reads.
    pub fn json(&self) -> Value {
        let columns: Map<String, Value> =
            self.columns.iter().map(|(name, values)| (name.clone(), Value::from(encoded(values)))).collect();
        json!({ "name": self.name, "start": self.start, "step": self.step, "columns": columns })
    }
}

/// Base64 of little-endian single precision.
pub fn encoded(values: &[f32]) -> String {
    STANDARD.encode(values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>())
}
