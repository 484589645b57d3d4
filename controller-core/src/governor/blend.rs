//! From the averages of a stream onto the stream itself, without a jump in any derivative up to snap.
//!
//! The averages go on with their own head, p. With s the stream and beta a smooth step from 0 to 1 that takes T_b,
//!
//! ```text
//! T = p + beta f,  f = s - p,  T^(k) = p^(k) + sum over i of C(k, i) beta^(i) f^(k-i)
//! ```
//!
//! is followed instead of s. At the beginning it is p in every derivative, and the head is on it; in the end it is s.
//! In between p'' + beta f'' lies between p'' and s'', inside their bounds, which are convex; what comes on top has a
//! factor of beta', so it is as small as T_b is long. With u = t/T_b, q = u (1 - u) and r = 1 - 2 u,
//!
//! beta = u^5 (126 - 420 u + 540 u^2 - 315 u^3 + 70 u^4), beta' = 630 q^4, beta'' = 2520 q^3 r,
//! beta''' = 2520 q^2 (3 - 14 q), beta'''' = 15120 q r (1 - 7 q),
//!
//! over powers of T_b. The head is steered, so p is kept as what it is ahead of the head by.

use super::envelope::{Envelope, HeadMotion};
use super::stream::{Point, StreamTarget};
use crate::math;
use nalgebra::Vector3;

/// The greatest beta' to beta'''', times powers of T_b.
const STEP_DERIVATIVES_MAX: [f32; 4] = [2.461, 9.373, 78.75, 622.0];

/// The share of the bounds left by a stream that blending may need. More than one: each term counts with its greatest
/// value, and these do not come together.
const BLENDING_SHARE: f32 = 1.2;

/// T_b: the longest, s; from one span of the averages on it is tried this much longer.
const DURATION_MAX_S: f32 = 40.0;
const DURATION_FACTOR: f32 = 1.15;

/// How far a stream was from the averages, and what it took of the bounds, at most, for some ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Watched {
    pub ticks: u32,
    /// f to f''', SI units, and the first two with the vertical as [`super::stream_follower`] counts it.
    max: [f32; 4],
    flat: [f32; 2],
    /// The share of the bounds.
    used: f32,
}

impl Watched {
    /// Nothing yet.
    pub const NONE: Self = Self { ticks: 0, max: [0.0; 4], flat: [0.0; 2], used: 0.0 };

    /// A tick later.
    pub fn later(&self) -> Self {
        Self { ticks: self.ticks.saturating_add(1), ..*self }
    }

    /// A tick later, in which the stream `used` this share of the bounds.
    pub fn with(&self, error: &Point, flat: [f32; 2], used: f32) -> Self {
        let Point { position, velocity, acceleration, jerk, .. } = error;
        let [f, f1, f2, f3] = self.max;
        let length = |max: f32, y: &Vector3<f32>| math::max(max, math::sqrt(y.norm_squared()));
        let max = [length(f, position), length(f1, velocity), length(f2, acceleration), length(f3, jerk)];
        let ([across, along], [now, moving]) = (self.flat, flat);
        Self {
            max,
            flat: [math::max(across, now), math::max(along, moving)],
            used: math::max(self.used, used),
            ..self.later()
        }
    }

    /// The shortest T_b, s, from one `span` on, whose terms fit into what is left of the bounds.
    fn duration(&self, envelope: &Envelope, span: f32) -> Option<f32> {
        let left = BLENDING_SHARE * (1.0 - self.used);
        let [b1, b2, b3, b4] = STEP_DERIVATIVES_MAX;
        let ([f, f1, f2, f3], [across, along]) = (self.max, self.flat);
        let fits = |duration: f32| {
            let x = 1.0 / duration;
            let along_x = |size: f32| Vector3::new(size, 0.0, 0.0);
            let speed = along_x(b1 * across * x);
            let acceleration = along_x((2.0 * b1 * along + b2 * across * x) * x);
            let jerk = along_x((3.0 * b1 * f2 + (3.0 * b2 * f1 + b3 * f * x) * x) * x);
            let snap = along_x((4.0 * b1 * f3 + (6.0 * b2 * f2 + (4.0 * b3 * f1 + b4 * f * x) * x) * x) * x);
            let speed = math::sqrt(envelope.share_of_speed(&speed));
            math::max(envelope.used([&acceleration, &jerk, &snap]), speed) <= left
        };
        let mut duration = span;
        while !fits(duration) {
            duration *= DURATION_FACTOR;
            if duration > DURATION_MAX_S {
                return None;
            }
        }
        Some(duration)
    }

    /// A blend that begins now, if there is time for one.
    pub fn blend(&self, envelope: &Envelope, span: f32) -> Option<Blend> {
        let zero = Vector3::zeros();
        self.duration(envelope, span).map(|duration| Blend {
            elapsed: 0.0,
            duration,
            ahead: zero,
            moving: HeadMotion { velocity: zero, acceleration: zero, difference: zero },
        })
    }
}

/// A blend under way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Blend {
    /// s.
    elapsed: f32,
    duration: f32,
    /// What p is ahead of the head by, m, and how that moves.
    ahead: Vector3<f32>,
    moving: HeadMotion,
}

impl Blend {
    /// beta to beta''''.
    fn step(&self) -> [f32; 5] {
        let x = 1.0 / self.duration;
        let u = math::clamp(self.elapsed * x, 0.0, 1.0);
        let (q, r) = (u * (1.0 - u), 1.0 - 2.0 * u);
        let rate = x * x;
        // From the nearer end: the sum rounds less there.
        let w = math::min(u, 1.0 - u);
        let square = w * w;
        let risen = square * square * w * (126.0 + w * (-420.0 + w * (540.0 + w * (-315.0 + w * 70.0))));
        [
            if u > w { 1.0 - risen } else { risen },
            630.0 * q * q * q * q * x,
            2520.0 * q * q * q * r * rate,
            2520.0 * q * q * (3.0 - 14.0 * q) * rate * x,
            15120.0 * q * r * (1.0 - 7.0 * q) * rate * rate,
        ]
    }

    /// T, with the `head` at hand and the averages' `snap`, m/s^2 per tick squared.
    pub fn target(&self, head: &HeadMotion, sought: &StreamTarget, snap: &Vector3<f32>, period: f32) -> StreamTarget {
        let [b, b1, b2, b3, b4] = self.step();
        let (per_tick, StreamTarget { point, error }) = (1.0 / period, sought);
        let HeadMotion { velocity, acceleration, difference } = &self.moving;
        let jerk = difference * per_tick;
        let snap = snap * (per_tick * per_tick);
        let f = error.position - self.ahead;
        let f1 = error.velocity - velocity;
        let f2 = error.acceleration - acceleration;
        let f3 = error.jerk - jerk;
        let f4 = point.snap - snap;
        let error = Point {
            position: self.ahead + f * b,
            velocity: velocity + f1 * b + f * b1,
            acceleration: acceleration + f2 * b + f1 * (2.0 * b1) + f * b2,
            jerk: jerk + f3 * b + f2 * (3.0 * b1) + f1 * (3.0 * b2) + f * b3,
            ..*error
        };
        let point = Point {
            position: point.position,
            velocity: head.velocity + error.velocity,
            acceleration: head.acceleration + error.acceleration,
            jerk: head.difference * per_tick + error.jerk,
            snap: snap + f4 * b + f3 * (4.0 * b1) + f2 * (6.0 * b2) + f1 * (4.0 * b3) + f * b4,
            rate: point.rate * b,
        };
        StreamTarget { point, error }
    }

    /// A tick later, in which p's snap was greater than the head's by `snap`, m/s^2 per tick squared.
    pub fn after(&self, snap: &Vector3<f32>, period: f32) -> Self {
        let difference = self.moving.difference + snap;
        let acceleration = self.moving.acceleration + difference;
        let velocity = self.moving.velocity + (self.moving.acceleration + acceleration) * (0.5 * period);
        Self {
            elapsed: self.elapsed + period,
            ahead: self.ahead + (self.moving.velocity + velocity) * (0.5 * period),
            moving: HeadMotion { velocity, acceleration, difference },
            ..*self
        }
    }

    /// Whether T is the stream.
    pub fn is_over(&self) -> bool {
        self.elapsed >= self.duration
    }
}

#[cfg(test)]
mod tests;
