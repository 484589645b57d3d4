//! Friction between the ground and what touches it, by Coulomb's law.
//!
//! ```text
//! at rest      |f| <= mu N                 f: friction, N: what the ground carries, both N
//! sliding      f = -mu N v / |v|           against the motion, however fast
//! an impact    |change of m v| <= mu x the impulse that stops the fall
//! ```
//!
//! So over a time, friction takes at most a speed of mu N t / m from a motion, all of a slower one, and never turns it
//! round.

use nalgebra::Vector3;

/// mu, of rubber feet on a floor: between 0.4 and 0.9, as a rule.
pub const FRICTION_COEFFICIENT: f64 = 0.6;

/// The part of a vector along the ground.
pub fn across(vector: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(vector.x, vector.y, 0.0)
}

/// What is left along the ground of a velocity, m/s, where friction may take so much of it, m/s.
pub fn slowed(velocity: &Vector3<f64>, most: f64) -> Vector3<f64> {
    let velocity = across(velocity);
    let speed = velocity.norm();
    if speed <= most { Vector3::zeros() } else { velocity * (1.0 - most / speed) }
}
