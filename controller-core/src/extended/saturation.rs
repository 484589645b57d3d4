//! The radial saturation that all feedback of the law passes: s(x; M) = M x / sqrt(M^2 + |x|^2), shorter than M, along
//! x.
//!
//! A gain k acts before it, and both together are one number times x:
//!
//! s(k x; M) = x k M / sqrt(M^2 + k^2 |x|^2).
//!
//! It is monotone and has a slope of at most k.

use crate::math;

/// A gain and the level behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Saturation {
    /// k M.
    product: f32,
    /// M^2.
    level_squared: f32,
    /// k^2.
    gain_squared: f32,
}

impl Saturation {
    /// For k and M.
    pub fn new(gain: f32, level: f32) -> Self {
        Self { product: gain * level, level_squared: level * level, gain_squared: gain * gain }
    }

    /// What a vector or a number whose square is `square` is multiplied by.
    pub fn factor(&self, square: f32) -> f32 {
        self.product / math::sqrt(self.level_squared + self.gain_squared * square)
    }
}
