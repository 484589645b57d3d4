//! `[disturbance]`: an unmodelled force and torque.

use crate::key::{Bounds, Key, Layout};
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

/// The keys of `[disturbance]`.
pub const LAYOUT: Layout = Layout {
    name: "disturbance",
    about: "An unmodelled force and torque, constant from start on.",
    keys: &[
        Key::vector("acceleration", Bounds::between(-100.0, 100.0, "m/s^2"), "World: force over vehicle.mass.").or(0.0),
        Key::vector("torque", Bounds::between(-100.0, 100.0, "N m"), "Body.").or(0.0),
        Key::number("start", Bounds::between(0.0, 1e7, "s"), "When it begins.").or(0.0),
    ],
};

/// Reads `[disturbance]`.
///
/// # Errors
/// Names the field that is refused.
pub fn read(root: &Section) -> Result<Option<Disturbance>, FieldError> {
    let Some(section) = root.open(&LAYOUT)? else {
        return Ok(None);
    };
    Ok(Some(Disturbance {
        acceleration: section.vector("acceleration")?,
        torque: section.vector("torque")?,
        start: section.number("start")?,
    }))
}
