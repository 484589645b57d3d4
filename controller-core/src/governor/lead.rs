//! Where the command must be for the averages to come out on a moving point.
//!
//! Averages with mean delay d and variance sigma^2 turn e^(i w t) into H(w) e^(i w (t-d)), H = 1 - w^2 sigma^2/2 + ...,
//! and a parabola q into q - d q' + (d^2 + sigma^2) q''/2. Inverted, with L = d plus the age of the last report of the
//! point:
//!
//! - a point on a circle, a = i w v in the horizontal plane: ahead = (v/w) (g sin(wL) + i (1 - g cos(wL))), feed = g
//!   e^(i w L) v, with g = 1/H, or as much as the acceleration bound allows: then the circle comes out smaller, in
//!   phase;
//! - what else accelerates it, along its path or vertically: ahead = v L + a (L^2 - sigma^2)/2, feed = v + a L.
//!
//! As w -> 0 the first becomes the second. Motions that change otherwise within d (a second or so) come out smoothed.

use crate::math;
use crate::reference::phase::swing;
use nalgebra::Vector3;

/// Turns slower than this, rad/s, are parabolas to within single precision.
const TURNING_RATE_MIN_RAD_PER_S: f32 = 1e-2;

/// Speeds squared below this, m^2/s^2, have no direction to turn.
const SPEED_SQUARED_MIN_M2_PER_S2: f32 = 1e-6;

/// The share of the acceleration bound that following a circle may take; the rest is for getting onto it.
const CIRCLING_SHARE: f32 = 0.9;

/// What the averages and the bounds do to a moving point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lead {
    /// d, s.
    pub delay: f32,
    /// sigma^2, s^2.
    pub variance: f32,
    /// The horizontal acceleration there is, m/s^2.
    pub acceleration: f32,
}

impl Lead {
    /// Not designed yet.
    pub const NONE: Self = Self { delay: 0.0, variance: 0.0, acceleration: 0.0 };

    /// How far ahead of where a point was `age` seconds ago the command must be (m), and how fast it must move (m/s).
    pub fn ahead_and_velocity(
        &self,
        velocity: &Vector3<f32>,
        acceleration: &Vector3<f32>,
        age: f32,
    ) -> (Vector3<f32>, Vector3<f32>) {
        let lead = self.delay + age;
        let spread = 0.5 * (lead * lead - self.variance);
        let (v, a) = (velocity.xy(), acceleration.xy());
        let speed_squared = v.norm_squared();
        let turning = v.x * a.y - v.y * a.x;
        if speed_squared < SPEED_SQUARED_MIN_M2_PER_S2 || turning.abs() <= TURNING_RATE_MIN_RAD_PER_S * speed_squared {
            return (velocity * lead + acceleration * spread, velocity + acceleration * lead);
        }
        // Faster than 1/sigma the averages leave too little of a circle to make up for.
        let fastest = 1.0 / math::sqrt(self.variance);
        let rate = (turning / speed_squared).min(fastest).max(-fastest);
        let x = rate * rate * self.variance;
        let needed = math::sqrt(speed_squared) * rate.abs();
        let gain = (1.0 + 0.5 * x + 0.125 * x * x).min(CIRCLING_SHARE * self.acceleration / needed);
        let (sin, cos) = math::sin_cos_turns(swing(rate * lead));
        let turned = |cos: f32, sin: f32, rise: f32| Vector3::new(v.x * cos - v.y * sin, v.x * sin + v.y * cos, rise);
        let along = v * (v.dot(&a) / speed_squared);
        let along = Vector3::new(along.x, along.y, acceleration.z);
        let ahead = turned(gain * sin / rate, (1.0 - gain * cos) / rate, velocity.z * lead) + along * spread;
        let feed = turned(gain * cos, gain * sin, velocity.z) + along * lead;
        (ahead, feed)
    }
}

#[cfg(test)]
mod tests;
