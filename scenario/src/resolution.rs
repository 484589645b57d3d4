//! How finely a position is known: the law counts in single precision, which becomes coarser away from the origin.

use crate::section::FieldError;
use nalgebra::Vector3;

/// From here on neighbouring numbers are 1 mm apart or more: 2^14 of 2^-10.
pub const DISTANCE_MAX_M: f64 = 16_384.0;

/// The way between neighbouring numbers of single precision at a distance, m.
fn step(distance: f64) -> f64 {
    let number = distance as f32;
    f64::from(number.next_up()) - f64::from(number)
}

/// Refuses a position at which single precision is too coarse; `remedy` says what to do.
///
/// # Errors
/// Names the `field`, the position, and how coarse.
pub fn check(field: &str, position: &Vector3<f64>, remedy: &str) -> Result<(), FieldError> {
    let distance = position.amax();
    if distance < DISTANCE_MAX_M {
        return Ok(());
    }
    let [x, y, z] = (*position).into();
    let problem = format!(
        "must be within {:.0} km of the origin, found ({x}, {y}, {z}) m, where single precision is {:.0} mm coarse; \
         {remedy}",
        (DISTANCE_MAX_M / 1e3).floor(),
        1e3 * step(distance)
    );
    Err(FieldError::new(field, problem))
}
