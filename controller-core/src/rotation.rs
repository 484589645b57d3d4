//! The rotation by a vector: exactly what a body rate that is constant for a while does to an attitude.

use crate::math;
use crate::reference::phase::swing;
use nalgebra::{Quaternion, Vector3};

/// The unit quaternion (cos |x|, sin |x| x/|x|) of the half angle x, rad.
pub fn half_rotation(x: &Vector3<f32>) -> Quaternion<f32> {
    /// Below this, |x|^2 and |x|^4 of the series suffice: the next term is under 2e-9.
    const SERIES_SQUARE_MAX: f32 = 0.01;
    let square = x.norm_squared();
    if square < SERIES_SQUARE_MAX {
        let cos = 1.0 - square * (0.5 - square * (1.0 / 24.0));
        let sinc = 1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0));
        return Quaternion::from_parts(cos, x * sinc);
    }
    let angle = math::sqrt(square);
    let (sin, cos) = math::sin_cos_turns(swing(angle));
    Quaternion::from_parts(cos, x * (sin / angle))
}
