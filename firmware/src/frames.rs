//! Frames: MAVLink's conventions to the law's and back, used at the edges of the vehicle and nowhere else.
//!
//! | | world | body |
//! |---|---|---|
//! | here | x east, y north, z up (ENU) | x forward, y left, z up (FLU) |
//! | MAVLink | x north, y east, z down (NED) | x forward, y right, z down (FRD) |
//!
//! Turning a vector between the worlds swaps x with y and reverses z; between the bodies it reverses y and z. Both are
//! half turns, so each is its own inverse and one function serves both directions. An attitude R (body to world)
//! becomes W R B, with W and B those two half turns: as quaternions w = (0, 1, 1, 0) / sqrt(2) and b = (0, -1, 0, 0),
//! and w q b has only sums and differences of q's components over sqrt(2).
//!
//! The law itself takes any world with z up; ENU fixes which of its headings MAVLink calls north. A heading psi,
//! counted from x towards y, becomes pi/2 - psi, which is also its own inverse.

use core::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI, TAU};
use nalgebra::{Quaternion, Vector3};

/// A vector of the world: ENU to NED, or NED to ENU.
pub fn world(v: &Vector3<f32>) -> Vector3<f32> {
    Vector3::new(v.y, v.x, -v.z)
}

/// A vector of the body: FLU to FRD, or FRD to FLU. Angular velocities are vectors like any other here: no mirror is
/// involved.
pub fn body(v: &Vector3<f32>) -> Vector3<f32> {
    Vector3::new(v.x, -v.y, -v.z)
}

/// An attitude: FLU to ENU becomes FRD to NED, or the other way round. Keeps the length.
pub fn attitude(q: &Quaternion<f32>) -> Quaternion<f32> {
    Quaternion::new(q.w + q.k, q.i + q.j, q.i - q.j, q.w - q.k) * FRAC_1_SQRT_2
}

/// A heading, rad: counted from x towards y of one world, to the same in the other, within (-pi, pi] for any in [-pi,
/// pi].
pub fn heading(psi: f32) -> f32 {
    let turned = FRAC_PI_2 - psi;
    if turned > PI { turned - TAU } else { turned }
}

/// A heading's rate, rad/s.
pub fn heading_rate(rate: f32) -> f32 {
    -rate
}

#[cfg(test)]
mod tests;
