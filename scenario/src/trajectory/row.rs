//! Where a vehicle is to be at a time.

use nalgebra::Vector3;

/// A row: where the vehicle is to be at a time, and how it moves there if the file says so.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// s; none in a file without times.
    pub time: Option<f64>,
    /// m, world.
    pub position: Vector3<f64>,
    /// rad.
    pub heading: f64,
    /// m/s.
    pub velocity: Option<Vector3<f64>>,
    /// m/s^2.
    pub acceleration: Option<Vector3<f64>>,
    /// m/s, at most up to the next row.
    pub speed: Option<f64>,
}
