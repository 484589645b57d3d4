//! Euler angles for reading. Approximate (`micromath`): good to 1 degree (2 near the vertical), and used nowhere in
//! flight.

use micromath::F32Ext;
use nalgebra::Quaternion;

/// Roll, pitch and yaw, degrees; R = Rz(yaw) Ry(pitch) Rx(roll), world z up.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Euler {
    /// About x, degrees.
    pub roll: f32,
    /// About y, degrees: positive is nose down.
    pub pitch: f32,
    /// About z, degrees.
    pub yaw: f32,
}

/// The angles of a unit quaternion.
pub fn euler(q: &Quaternion<f32>) -> Euler {
    let Quaternion { coords } = q;
    let (x, y, z, w) = (coords.x, coords.y, coords.z, coords.w);
    let sine = (2.0 * (w * y - z * x)).clamp(-1.0, 1.0);
    // Named in full: on a desktop, the method call would silently be the standard library's.
    let degrees = |sine: f32, cosine: f32| F32Ext::atan2(sine, cosine).to_degrees();
    Euler {
        roll: degrees(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
        pitch: degrees(sine, F32Ext::sqrt((1.0 - sine) * (1.0 + sine))),
        yaw: degrees(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
    }
}

#[cfg(test)]
mod tests;
