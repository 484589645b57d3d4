//! `[initial]`: where a flight starts. Left out, in whole or in part: on the reference, at rest, level, facing world x.

use crate::body::{BodyState, GREATEST_TURN_PER_STEP, attitude_from_euler};
use crate::resolution;
use crate::section::{FieldError, Section};
use controller_core::state::STATE_RANGE;
use nalgebra::Vector3;

/// Reads `[initial] position`, m; none where it is left out.
///
/// # Errors
/// If it is not three numbers, or out of the law's range.
pub fn read_position(root: &Section) -> Result<Option<Vector3<f64>>, FieldError> {
    let section = root.optional_section("initial")?.filter(|section| section.has("position"));
    section.map(|section| position(&section, Vector3::zeros())).transpose()
}

fn position(section: &Section, default: Vector3<f64>) -> Result<Vector3<f64>, FieldError> {
    let position = section.vector_or("position", default)?;
    resolution::check(&section.path_of("position"), &position, "start nearer")?;
    Ok(position)
}

/// Reads `[initial]`; `on_reference` is the reference's first position, m.
///
/// # Errors
/// Names the field that is not finite, out of the law's range, or turns too fast for the plant's `step` (s).
pub fn read_initial(root: &Section, on_reference: Vector3<f64>, step: f64) -> Result<BodyState, FieldError> {
    let rest = Vector3::zeros();
    let Some(section) = root.optional_section("initial")? else {
        let attitude = attitude_from_euler(0.0, 0.0, 0.0);
        return Ok(BodyState { position: on_reference, velocity: rest, attitude, angular_velocity: rest });
    };
    section.allow(&["position", "velocity", "euler_deg", "angular_velocity"])?;
    let position = position(&section, on_reference)?;
    let velocity = within_range(&section, "velocity", rest)?;
    let euler = section.vector_or("euler_deg", rest)?.map(f64::to_radians);
    let angular_velocity = section.vector_or("angular_velocity", rest)?;
    let greatest = GREATEST_TURN_PER_STEP / step;
    if angular_velocity.norm() > greatest {
        let problem = format!("must be at most {greatest:.4} rad/s for plant.step = {step} s (or take a smaller step)");
        return Err(FieldError::new(section.path_of("angular_velocity"), problem));
    }
    let attitude = attitude_from_euler(euler.x, euler.y, euler.z);
    Ok(BodyState { position, velocity, attitude, angular_velocity })
}

/// The vector at `key` if the law can work with it, or `default` where it is left out.
fn within_range(section: &Section, key: &str, default: Vector3<f64>) -> Result<Vector3<f64>, FieldError> {
    let vector = section.vector_or(key, default)?;
    if vector.amax() > f64::from(STATE_RANGE) {
        return Err(FieldError::new(section.path_of(key), format!("must be within ±{STATE_RANGE:e}")));
    }
    Ok(vector)
}
