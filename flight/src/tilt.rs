//! How an attitude leans, and where it points.

use controller_core::heading::Heading;
use controller_core::math;
use nalgebra::{Quaternion, Vector2};

/// e3 . R e3: the cosine of the tilt.
pub(super) fn tilt_cosine(q: &Quaternion<f32>) -> f32 {
    1.0 - 2.0 * (q.i * q.i + q.j * q.j)
}

/// Which way body x points, seen from above, whatever the length of `q`; none straight up or down.
pub(super) fn heading(q: &Quaternion<f32>) -> Option<Heading> {
    let along = q.w * q.w + q.i * q.i - q.j * q.j - q.k * q.k;
    let forward = Vector2::new(along, 2.0 * (q.i * q.j + q.w * q.k));
    Heading::new(forward / math::sqrt(forward.norm_squared()), 0.0, 0.0).ok()
}
