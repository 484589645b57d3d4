//! What flies a path, as far as the path's times depend on it.

use controller_core::configuration::Configuration;

/// The vehicle that is to fly a path.
#[derive(Debug, Clone)]
pub struct PathVehicle {
    /// What it is certified for, beside this path.
    pub configuration: Configuration,
    /// Whether the file has `[reference_bounds]`.
    pub has_bounds: bool,
    /// The force per mass that is kept free along a path, m/s^2.
    pub force_kept: f32,
}
