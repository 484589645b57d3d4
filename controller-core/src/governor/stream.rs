//! A stream of positions, velocities and accelerations between two setpoints: its present point and motion.
//!
//! The turning model: the acceleration across the horizontal velocity turns with it, at w = (v x a)_3 /
//! |v|^2; the rest changes at the rate c, and c is what turning leaves unexplained of the last
//! change of acceleration. With a = a_w + a_c in that sense, R(w t) the turn about the vertical and J a quarter turn,
//!
//! ```text
//! a(t) = R(w t) a_w + a_c + c t,  jerk = w J R(w t) a_w + c,  snap = -w^2 R(w t) a_w
//! ```
//!
//! and velocity and position are its integrals. A point on a circle has c = 0, one on a line w = 0.

use crate::math;
use crate::reference::phase::swing;
use nalgebra::Vector3;

/// Turns slower than this, rad/s, are zero to within single precision.
const SLOWEST: f32 = 1e-2;

/// Speeds squared below this, m^2/s^2, have no direction to turn.
const STILL: f32 = 1e-6;

/// Velocity and acceleration of a setpoint, and c. World frame, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stream {
    pub velocity: Vector3<f32>,
    pub acceleration: Vector3<f32>,
    pub change: Vector3<f32>,
}

/// A point and its derivatives; the position is from where the setpoint was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    pub position: Vector3<f32>,
    pub velocity: Vector3<f32>,
    pub acceleration: Vector3<f32>,
    pub jerk: Vector3<f32>,
    pub snap: Vector3<f32>,
    /// w, rad/s, as far as it explains the jerk: none where c is half of that or more.
    pub rate: f32,
}

impl Stream {
    /// No motion.
    pub const STILL: Self = {
        let zero = Vector3::new(0.0, 0.0, 0.0);
        Self { velocity: zero, acceleration: zero, change: zero }
    };

    /// A first setpoint: c is not known.
    pub fn new(velocity: Vector3<f32>, acceleration: Vector3<f32>) -> Self {
        Self { velocity, acceleration, change: Vector3::zeros() }
    }

    /// The setpoint `time` seconds (positive) after this one.
    pub fn followed_by(&self, velocity: Vector3<f32>, acceleration: Vector3<f32>, time: f32) -> Self {
        let turned = Self { change: Vector3::zeros(), ..*self }.ahead(time).acceleration;
        Self { velocity, acceleration, change: (acceleration - turned) / time }
    }

    /// Where the point is `time` seconds later.
    pub fn ahead(&self, time: f32) -> Point {
        let Self { velocity: v, acceleration: a, change } = self;
        let square = v.xy().norm_squared();
        let turning = v.x * a.y - v.y * a.x;
        let rate = if square < STILL || turning.abs() <= SLOWEST * square { 0.0 } else { turning / square };
        let across = quarter(v) * rate;
        let along = a - across;
        let (sine, cosine) = math::sin_cos_turns(swing(rate * time));
        let turned = |y: &Vector3<f32>| Vector3::new(y.x * cosine - y.y * sine, y.x * sine + y.y * cosine, y.z);
        let (v_turned, across_turned) = (turned(v), turned(&across));
        // The integral of the turned velocity; as w goes to zero, v t.
        let path = if rate == 0.0 { v * time } else { level(&(quarter(&(v - v_turned)) / rate), v.z * time) };
        let jerk = quarter(&across_turned) * rate + change;
        let unexplained = 4.0 * change.norm_squared() / jerk.norm_squared();
        let (half, sixth) = (0.5 * time * time, time * time * time / 6.0);
        Point {
            position: path + along * half + change * sixth,
            velocity: v_turned + along * time + change * half,
            acceleration: across_turned + along + change * time,
            jerk,
            snap: across_turned * (-rate * rate),
            rate: if unexplained < 1.0 { rate * (1.0 - math::sqrt(unexplained)) } else { 0.0 },
        }
    }
}

/// A horizontal quarter turn; what is vertical is dropped.
pub(super) fn quarter(y: &Vector3<f32>) -> Vector3<f32> {
    Vector3::new(-y.y, y.x, 0.0)
}

/// The horizontal part, at a height.
fn level(y: &Vector3<f32>, height: f32) -> Vector3<f32> {
    Vector3::new(y.x, y.y, height)
}

#[cfg(test)]
mod tests;
