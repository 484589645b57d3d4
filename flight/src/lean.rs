//! Gravity alone, of a vehicle whose motors are off: how it leans.
//!
//! ```text
//! specific force f at rest -> up = f / |f| -> q, of unknown heading -> law, level reference -> allocation -> shares
//! ```
//!
//! A person on the bench tilts the frame by hand, and sees from the [shares](super::chain) which rotors would speed up:
//! a wrong sign of the sensor's axes, of a rotor's place or of its direction shows without a motor that turns. Nothing
//! of it is flown: the flight rules do not see it, and every flight begins with a law that is reset.

use controller_core::math;
use nalgebra::{Quaternion, Vector3};

/// The specific force between which a vehicle is taken to be at rest: gravity within a fifth.
const REST_MIN_M_PER_S2: f32 = 7.85;
const REST_MAX_M_PER_S2: f32 = 11.77;

/// Up along body z below which the vehicle lies on its back: within 2 degrees the way there is not known.
const UPSIDE_DOWN_COSINE: f32 = -0.999_4;

/// How the vehicle leans.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lean {
    /// q, body to world, unit. Its heading means nothing: it is turned from level no further than it leans.
    pub attitude: Quaternion<f32>,
    /// The body rate, rad/s, as the sensor has it.
    pub angular_velocity: Vector3<f32>,
}

impl Lean {
    /// By a specific force, m/s^2, and a body rate, rad/s; none where the force is not gravity's alone.
    pub(super) fn felt(force: &Vector3<f32>, rate: &Vector3<f32>) -> Option<Self> {
        let magnitude = math::sqrt(force.norm_squared());
        // Written so that NaN is refused.
        if !(magnitude > REST_MIN_M_PER_S2 && magnitude < REST_MAX_M_PER_S2) {
            return None;
        }
        let up = force / magnitude;
        let attitude = if up.z < UPSIDE_DOWN_COSINE {
            Quaternion::new(0.0, 1.0, 0.0, 0.0)
        } else {
            // The shortest turn from up to e3: (1 + up . e3, up x e3), of length sqrt(2 (1 + up . e3)).
            let half = 1.0 / math::sqrt(2.0 * (1.0 + up.z));
            Quaternion::new((1.0 + up.z) * half, up.y * half, -up.x * half, 0.0)
        };
        Some(Self { attitude, angular_velocity: *rate })
    }
}

#[cfg(test)]
mod tests;
