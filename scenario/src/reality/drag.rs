//! `[drag]`: the air's forces on a vehicle that moves through it. `host-sim` has the equations.

use crate::key::{Bounds, Key, Layout};
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

const COEFFICIENT: Bounds = Bounds::between(0.0, 1e3, "");

/// The keys of `[drag]`; those from the third on are the rotors'.
pub const LAYOUT: Layout = Layout {
    name: "drag",
    about: "The air's forces on a vehicle that moves through it.",
    keys: &[
        Key::vector("linear", COEFFICIENT, "kg/s, body axes: the whole vehicle at hover, N per m/s.").or(0.0),
        Key::vector("frame", COEFFICIENT, "N/(m/s)^2, body axes: RotorPy's c_Dx, c_Dy, c_Dz.").or(0.0),
        Key::number("rotor_across", COEFFICIENT, "kg/rad, each rotor, across its axis: k_d.").or(0.0),
        Key::number("rotor_along", COEFFICIENT, "kg/rad, each rotor, along its axis: k_z.").or(0.0),
        Key::number("translational_lift", COEFFICIENT, "N/(m/s)^2, each rotor: k_h.").or(0.0),
        Key::number("flapping", COEFFICIENT, "N m per (rad/s)(m/s), each rotor: k_flap.").or(0.0),
    ],
};

/// Reads `[drag]`.
///
/// # Errors
/// Names the field that is refused.
pub fn read(root: &Section, has_rotors: bool) -> Result<Option<Drag>, FieldError> {
    let Some(section) = root.open(&LAYOUT)? else {
        return Ok(None);
    };
    if let Some(Key { name, .. }) = LAYOUT.keys[2..].iter().find(|key| section.has(key.name) && !has_rotors) {
        let problem = "needs [rotors]: add that section or say drag.linear instead";
        return Err(FieldError::new(section.path_of(name), problem));
    }
    Ok(Some(Drag {
        linear: section.vector("linear")?,
        frame: section.vector("frame")?,
        rotor_across: section.number("rotor_across")?,
        rotor_along: section.number("rotor_along")?,
        translational_lift: section.number("translational_lift")?,
        flapping: section.number("flapping")?,
    }))
}
