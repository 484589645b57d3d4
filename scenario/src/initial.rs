//! `[initial]`: where a flight starts. Left out, in whole or in part: on the reference, at rest, level, facing world x.

use crate::body::{BodyState, ROTATION_PER_STEP_MAX_RAD, attitude_from_euler};
use crate::key::{Bounds, Key, Layout};
use crate::resolution;
use crate::section::{FieldError, Section};
use controller_core::state::STATE_RANGE;
use nalgebra::Vector3;

/// The keys of `[initial]`.
pub const LAYOUT: Layout = Layout {
    name: "initial",
    about: "Where a flight starts.",
    keys: &[
        Key::vector("position", Bounds::any("m"), "World; left out: the reference's first.").optional(),
        Key::vector("velocity", Bounds::any("m/s"), "World.").or(0.0),
        Key::vector("euler_deg", Bounds::any("degrees"), "Roll, pitch, yaw of R = Rz(yaw) Ry(pitch) Rx(roll).").or(0.0),
        Key::vector("angular_velocity", Bounds::any("rad/s"), "Body.").or(0.0),
    ],
};

/// Reads `[initial] position`, m; none where it is left out.
///
/// # Errors
/// If it is not three numbers, or out of the law's range.
pub fn read_position(root: &Section) -> Result<Option<Vector3<f64>>, FieldError> {
    let section = root.open(&LAYOUT)?.filter(|section| section.has("position"));
    section.map(|section| position(&section)).transpose()
}

fn position(section: &Section) -> Result<Vector3<f64>, FieldError> {
    let position = section.vector("position")?;
    resolution::check(&section.path_of("position"), &position, "start nearer")?;
    Ok(position)
}

/// Reads `[initial]`; `on_reference` is the reference's first position, m.
///
/// # Errors
/// Names the field that is not finite, out of the law's range, or turns too fast for the plant's `step` (s).
pub fn read_initial(root: &Section, on_reference: Vector3<f64>, step: f64) -> Result<BodyState, FieldError> {
    let rest = Vector3::zeros();
    let Some(section) = root.open(&LAYOUT)? else {
        let attitude = attitude_from_euler(0.0, 0.0, 0.0);
        return Ok(BodyState { position: on_reference, velocity: rest, attitude, angular_velocity: rest });
    };
    let position = if section.has("position") { position(&section)? } else { on_reference };
    let velocity = section.vector("velocity")?;
    if velocity.amax() > f64::from(STATE_RANGE) {
        return Err(FieldError::new(section.path_of("velocity"), format!("must be within ±{STATE_RANGE:e}")));
    }
    let euler = section.vector("euler_deg")?.map(f64::to_radians);
    let angular_velocity = section.vector("angular_velocity")?;
    let greatest = ROTATION_PER_STEP_MAX_RAD / step;
    if angular_velocity.norm() > greatest {
        let problem = format!("must be at most {greatest:.4} rad/s for plant.step = {step} s (or take a smaller step)");
        return Err(FieldError::new(section.path_of("angular_velocity"), problem));
    }
    let attitude = attitude_from_euler(euler.x, euler.y, euler.z);
    Ok(BodyState { position, velocity, attitude, angular_velocity })
}
