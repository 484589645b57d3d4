//! The approach: how fast an error of position comes to zero. Section 1 of `docs/extended-law.md`.
//!
//! A vehicle that needs a time t to answer, and then brakes with an acceleration a, covers z = v t + v^2 / (2 a) on its
//! way from the speed v to rest. So at a distance z it may have
//!
//! | here | equation |
//! |---|---|
//! | v(z) | 2 z / (t + sqrt(t^2 + 2 z / a)), t = k_v / k_p |
//! | the velocity of approach | s(v(\|z_1\|); v_c) along -z_1, at most v_c long |
//!
//! Near the target that is k_p z_1 / k_v; far away it grows with sqrt(2 a z), until v_c.

use super::saturation::Saturation;
use crate::math;

/// How fast errors along one direction come to zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Approach {
    /// t, s, and t^2.
    answering: f32,
    answering_squared: f32,
    /// v_c.
    speed: Saturation,
}

impl Approach {
    /// For k_p, 1/s^2, k_v, 1/s, and v_c, m/s.
    pub fn new(k_p: f32, k_v: f32, speed: f32) -> Self {
        let answering = k_v / k_p;
        Self { answering, answering_squared: answering * answering, speed: Saturation::new(1.0, speed) }
    }

    /// The velocity of approach over -z_1, 1/s, for |z_1|^2 = `square`, m^2, and a = `braking`, m/s^2, not zero.
    #[inline(always)] // into the law's step
    pub fn factor(&self, square: f32, braking: f32) -> f32 {
        let root = math::sqrt(self.answering_squared + 2.0 * math::sqrt(square) / braking);
        let factor = 2.0 / (self.answering + root);
        factor * self.speed.factor(factor * factor * square)
    }
}
