//! A stream of positions, velocities and accelerations between two setpoints: its present point and motion.
//!
//! The turning model: the acceleration across the horizontal velocity turns with it, at w = (v x a)_3 /
//! |v|^2; the rest changes at the rate c, which changes at the rate b. With a = a_w + a_c in that sense, R(w t) the
//! turn about the vertical and J a quarter turn,
//!
//! ```text
//! a(t) = R(w t) a_w + a_c + c t + b t^2/2,  jerk = w J R(w t) a_w + c + b t,  snap = -w^2 R(w t) a_w + b
//! ```
//!
//! and velocity and position are its integrals. A point on a circle has c = b = 0, one on a line w = 0. Each setpoint
//! says what acceleration has become. What it is other than expected, over the time since the last, corrects the jerk,
//! and slowly the snap; of both c and b are what turning leaves.

use crate::math;
use crate::reference::phase::swing;
use nalgebra::Vector3;

/// Turns slower than this, rad/s, are zero to within single precision; faster ones are those of points that nearly
/// rest, and do not last.
const TURNING_RATE_MIN_RAD_PER_S: f32 = 1e-2;
const TURNING_RATE_MAX_RAD_PER_S: f32 = 5.0;

/// Speeds squared below this, m^2/s^2, have no direction to turn.
const SPEED_SQUARED_MIN_M2_PER_S2: f32 = 1e-6;

/// The time in which b settles, s, and the longest between two setpoints that say something of c: not much longer, so
/// that corrections die out however the two change.
const SNAP_SETTLING_S: f32 = 0.1;
const INTERVAL_MAX_S: f32 = 0.3;

/// Velocity and acceleration of a setpoint, c and b. World frame, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stream {
    pub velocity: Vector3<f32>,
    pub acceleration: Vector3<f32>,
    pub change: Vector3<f32>,
    pub bend: Vector3<f32>,
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

/// A stream's point, and what it is ahead of the head by; SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StreamTarget {
    pub point: Point,
    pub error: Point,
}

impl Stream {
    /// No motion.
    pub const STILL: Self = {
        let zero = Vector3::new(0.0, 0.0, 0.0);
        Self { velocity: zero, acceleration: zero, change: zero, bend: zero }
    };

    /// A first setpoint: c and b are not known.
    pub fn new(velocity: Vector3<f32>, acceleration: Vector3<f32>) -> Self {
        Self { velocity, acceleration, ..Self::STILL }
    }

    /// The setpoint `time` seconds (positive) after this one.
    pub fn followed_by(&self, velocity: Vector3<f32>, acceleration: Vector3<f32>, time: f32) -> Self {
        let (turned, across) = turning(&self.velocity, &self.acceleration);
        let rests = self.velocity == Vector3::zeros() && self.acceleration == Vector3::zeros();
        if rests || time > INTERVAL_MAX_S {
            return Self::new(velocity, acceleration);
        }
        let expected = self.ahead(time);
        // What jerk and snap were other than expected.
        let missing = (acceleration - expected.acceleration) / time;
        let is_known = self.change != Vector3::zeros();
        let bent = if is_known { missing / math::max(time, SNAP_SETTLING_S) } else { Vector3::zeros() };
        let jerk = expected.jerk + missing + bent * (0.5 * time);
        // Turned as far as turning explains the jerk.
        let turn = math::sin_cos_turns(swing(expected.rate * time));
        let snap = rotated(&(self.bend - across * (turned * turned)), turn) + bent;
        let (rate, across) = turning(&velocity, &acceleration);
        Self { velocity, acceleration, change: jerk - quarter(&across) * rate, bend: snap + across * (rate * rate) }
    }

    /// Where the point is `time` seconds later.
    pub fn ahead(&self, time: f32) -> Point {
        let Self { velocity: v, acceleration: a, change, bend } = self;
        let (rate, across) = turning(v, a);
        let along = a - across;
        let turn = math::sin_cos_turns(swing(rate * time));
        let (v_turned, across_turned) = (rotated(v, turn), rotated(&across, turn));
        // The integral of the turned velocity; as w goes to zero, v t.
        let path = if rate == 0.0 { v * time } else { level(&(quarter(&(v - v_turned)) / rate), v.z * time) };
        let changing = change + bend * time;
        let jerk = quarter(&across_turned) * rate + changing;
        let unexplained = 4.0 * changing.norm_squared() / jerk.norm_squared();
        let half = 0.5 * time * time;
        let sixth = time * half / 3.0;
        Point {
            position: path + along * half + change * sixth + bend * (0.25 * time * sixth),
            velocity: v_turned + along * time + change * half + bend * sixth,
            acceleration: across_turned + along + change * time + bend * half,
            jerk,
            snap: across_turned * (-rate * rate) + bend,
            rate: if unexplained < 1.0 { rate * (1.0 - math::sqrt(unexplained)) } else { 0.0 },
        }
    }
}

/// w, and the acceleration that it explains.
fn turning(v: &Vector3<f32>, a: &Vector3<f32>) -> (f32, Vector3<f32>) {
    let square = v.xy().norm_squared();
    let turning = v.x * a.y - v.y * a.x;
    let turns = square > SPEED_SQUARED_MIN_M2_PER_S2
        && turning.abs() > TURNING_RATE_MIN_RAD_PER_S * square
        && turning.abs() < TURNING_RATE_MAX_RAD_PER_S * square;
    let rate = if turns { turning / square } else { 0.0 };
    (rate, quarter(v) * rate)
}

/// Turned about the vertical, by an angle of this sine and cosine.
fn rotated(y: &Vector3<f32>, (sine, cosine): (f32, f32)) -> Vector3<f32> {
    Vector3::new(y.x * cosine - y.y * sine, y.x * sine + y.y * cosine, y.z)
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
