//! `[drag]`: the air's forces on a vehicle that moves through it.
//!
//! ```toml
//! [drag]
//! linear = [0.3, 0.3, 0.1]             # kg/s: the whole vehicle at hover, N per m/s, body axes
//! frame = [5e-3, 5e-3, 1e-2]           # N/(m/s)^2, body axes: RotorPy's c_Dx, c_Dy, c_Dz
//! rotor_across = 1.19e-4               # kg/rad, each rotor, across its axis: k_d
//! rotor_along = 2.32e-4                # kg/rad, each rotor, along its axis: k_z
//! translational_lift = 3.39e-3         # N/(m/s)^2, each rotor: k_h
//! flapping = 0.0                       # N m per (rad/s)(m/s), each rotor: k_flap
//! ```
//!
//! Every key may be left out: zero. `host-sim` has the equations. The rotors' coefficients need `[rotors]`.

use super::numbers::Allowed;
use crate::section::{FieldError, Section};
use nalgebra::Vector3;

/// Coefficients of drag.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Drag {
    /// Linear drag of the whole vehicle along the body axes, kg/s.
    pub linear: Vector3<f64>,
    /// Quadratic drag of the frame along the body axes, N/(m/s)^2.
    pub frame: Vector3<f64>,
    /// k_d, kg/rad.
    pub rotor_across: f64,
    /// k_z, kg/rad.
    pub rotor_along: f64,
    /// k_h, N/(m/s)^2.
    pub translational_lift: f64,
    /// k_flap, kg m/rad.
    pub flapping: f64,
}

/// Reads `[drag]`.
///
/// # Errors
/// Names the field that is refused.
pub fn read(root: &Section, has_rotors: bool) -> Result<Option<Drag>, FieldError> {
    const OF_ROTORS: [&str; 4] = ["rotor_across", "rotor_along", "translational_lift", "flapping"];
    let Some(section) = root.optional_section("drag")? else {
        return Ok(None);
    };
    section.allow(&[["linear", "frame"].as_slice(), OF_ROTORS.as_slice()].concat())?;
    if let Some(key) = OF_ROTORS.into_iter().find(|key| section.has(key) && !has_rotors) {
        let problem = "needs [rotors]: add that section or say drag.linear instead";
        return Err(FieldError::new(section.path_of(key), problem));
    }
    let coefficient = Allowed::new(0.0..=1e3, "");
    let number = |key| coefficient.number_or(&section, key, 0.0);
    Ok(Some(Drag {
        linear: coefficient.vector_or_zero(&section, "linear")?,
        frame: coefficient.vector_or_zero(&section, "frame")?,
        rotor_across: number("rotor_across")?,
        rotor_along: number("rotor_along")?,
        translational_lift: number("translational_lift")?,
        flapping: number("flapping")?,
    }))
}
