//! `[disturbance]`: an unmodelled force and torque.
//!
//! ```toml
//! [disturbance]
//! acceleration = [1.0, 0.0, 0.0]       # m/s^2, world: a force on the centre of mass, over vehicle.mass
//! torque = [0.0, 0.0, 0.002]           # N m, body
//! start = 5.0                          # s; left out: 0
//! ```
//!
//! Constant from `start` on. Left out, acceleration and torque are zero.

use super::numbers::Allowed;
use crate::section::{FieldError, Section};
use nalgebra::Vector3;

/// A constant force and torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disturbance {
    /// The force over the model's mass, m/s^2, world.
    pub acceleration: Vector3<f64>,
    /// N m, body.
    pub torque: Vector3<f64>,
    /// When it begins, s.
    pub start: f64,
}

/// Reads `[disturbance]`.
///
/// # Errors
/// Names the field that is refused.
pub fn read(root: &Section) -> Result<Option<Disturbance>, FieldError> {
    let Some(section) = root.optional_section("disturbance")? else {
        return Ok(None);
    };
    section.allow(&["acceleration", "torque", "start"])?;
    Ok(Some(Disturbance {
        acceleration: Allowed::new(-100.0..=100.0, "m/s^2").vector_or_zero(&section, "acceleration")?,
        torque: Allowed::new(-100.0..=100.0, "N m").vector_or_zero(&section, "torque")?,
        start: Allowed::new(0.0..=1e7, "s").number_or(&section, "start", 0.0)?,
    }))
}
