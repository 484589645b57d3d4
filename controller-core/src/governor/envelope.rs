//! The bounds that a head is kept in, tick by tick, whatever snap is wanted of it.
//!
//! The head is an acceleration a, its difference d a tick, and the second difference q that is chosen each tick (d+ = d + q,
//! a+ = a + d+). Required always: a in the cylinder C, |d| <= D, |q| <= Q. A head in C may be lost nevertheless: too fast to be
//! stopped before the wall. So a *way out* is kept in hand: a turn of some ticks with one constant q, then braking straight.
//!
//! - **Braking straight**: q = -Q d/|d|, at the end -d. The ticks that it takes add up to at most d |d|/(2 Q), so a moves along a
//!   segment, and C is convex: where a and a + d |d|/(2 Q) are in C it stays there, and ends with d = 0.
//! - **The turn**: with n ticks of q, a runs along a parabola, which lies in the hull of its three control points a,
//!   a + n (d + q/2)/2 and a + n d + n(n+1)/2 q; d runs along a segment. Where these are inside, all of the turn is.
//!
//! A q is taken only if from where it leads there is a way out, and that one is kept. Otherwise the way out in hand is followed.
//! So the bounds hold for ever, by induction, however poor the guess of a turn; a poor guess gives way too early.

use super::braking::{BRAKING_SHARE, approach_speed};
use crate::math;
use nalgebra::Vector3;

/// Relative room for rounding, of the head to whole units and of all this to single precision.
const ROOM: f32 = 1e-4;

/// The turn's direction: so much inwards, so much back.
const INWARDS: f32 = 0.8;
const BACK: f32 = 0.6;

/// How often what is wanted is halved towards the way out before that is taken.
const HALVINGS: u32 = 3;

/// The bounds: m/s^2 and ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Envelope {
    per_horizontal: f32,
    per_vertical: f32,
    jerk: f32,
    snap: f32,
    /// Ticks of a turn.
    turn: f32,
}

/// A way out: a snap for some ticks, then braking straight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WayOut {
    snap: Vector3<f32>,
    ticks: u32,
}

impl WayOut {
    /// Braking straight.
    pub const STRAIGHT: Self = Self { snap: Vector3::new(0.0, 0.0, 0.0), ticks: 0 };
}

impl Envelope {
    /// Not designed yet: nothing is inside.
    pub const NONE: Self = Self { per_horizontal: f32::INFINITY, per_vertical: f32::INFINITY, jerk: 0.0, snap: 0.0, turn: 0.0 };

    /// For bounds in m/s^2, m/s^3 and m/s^4.
    pub fn new(horizontal: f32, vertical: f32, jerk: f32, snap: f32, period: f32) -> Self {
        let share = 1.0 - ROOM;
        Self {
            per_horizontal: 1.0 / (horizontal * share),
            per_vertical: 1.0 / (vertical * share),
            jerk: jerk * period * share,
            snap: snap * period * period * share,
            turn: (0.25 * jerk / (snap * period)).max(1.0) as u32 as f32,
        }
    }

    /// Whether an acceleration is in C.
    pub fn holds(&self, a: &Vector3<f32>) -> bool {
        let horizontal = math::sqrt(a.x * a.x + a.y * a.y) * self.per_horizontal;
        horizontal <= 1.0 && a.z.abs() * self.per_vertical <= 1.0
    }

    /// Whether a difference is within D.
    pub fn allows_difference(&self, d: &Vector3<f32>) -> bool {
        d.norm_squared() <= self.jerk * self.jerk
    }

    /// Whether a snap is within Q.
    pub fn allows(&self, snap: &Vector3<f32>) -> bool {
        snap.norm_squared() <= self.snap * self.snap
    }

    /// Whether braking straight from here stays inside.
    fn stops(&self, a: &Vector3<f32>, d: &Vector3<f32>) -> bool {
        let length = math::sqrt(d.norm_squared());
        let reach = a + d * (length / (2.0 * (1.0 - ROOM) * self.snap));
        length <= self.jerk && self.holds(&reach) && self.holds(a)
    }

    /// A way out from here, if one is known.
    pub fn way_out(&self, a: &Vector3<f32>, d: &Vector3<f32>) -> Option<WayOut> {
        if self.stops(a, d) {
            return Some(WayOut::STRAIGHT);
        }
        let level = Vector3::new(a.x, a.y, 0.0);
        let snap = unit(&(unit(&level) * -INWARDS - unit(d) * BACK)) * ((1.0 - ROOM) * self.snap);
        let n = self.turn;
        let middle = a + (d + snap * 0.5) * (0.5 * n);
        let (turned, left) = (a + d * n + snap * (0.5 * n * (n + 1.0)), d + snap * n);
        let inside = self.allows_difference(d) && self.holds(a) && self.holds(&middle) && self.stops(&turned, &left);
        inside.then_some(WayOut { snap, ticks: n as u32 })
    }

    /// The snap nearest to `wanted` that leaves a way out, and that way; with the way `out` in hand.
    pub fn step(&self, a: &Vector3<f32>, d: &Vector3<f32>, wanted: &Vector3<f32>, out: &WayOut) -> (Vector3<f32>, WayOut) {
        let mut snap = self.limited(wanted);
        let (fallback, after) = self.follow(d, out);
        for _ in 0..HALVINGS {
            let there = d + snap;
            if let Some(way) = self.way_out(&(a + there), &there) {
                return (snap, way);
            }
            snap = (snap + fallback) * 0.5;
        }
        (fallback, after)
    }

    /// The greatest share of a bound that these take.
    pub fn used(&self, a: &Vector3<f32>, d: &Vector3<f32>, q: &Vector3<f32>) -> f32 {
        let [horizontal, d, q] = [a.x * a.x + a.y * a.y, d.norm_squared(), q.norm_squared()].map(math::sqrt);
        let a = (horizontal * self.per_horizontal).max(a.z.abs() * self.per_vertical);
        a.max(d / self.jerk).max(q / self.snap)
    }

    /// The snap wanted to bring the acceleration to zero, straight and as soon as the bounds allow.
    pub fn levelling(&self, a: &Vector3<f32>, d: &Vector3<f32>) -> Vector3<f32> {
        let length = math::sqrt(a.norm_squared());
        let steps = length / (BRAKING_SHARE * self.snap);
        let fastest = if steps > 1.0 { (BRAKING_SHARE * self.snap * approach_speed(steps)).min(BRAKING_SHARE * self.jerk) } else { length };
        unit(a) * -fastest - d
    }

    /// Whether there is next to no acceleration.
    pub fn is_level(&self, a: &Vector3<f32>) -> bool {
        self.allows(a)
    }

    /// A tick of a way out, and what is left of it.
    pub fn follow(&self, d: &Vector3<f32>, out: &WayOut) -> (Vector3<f32>, WayOut) {
        if out.ticks > 0 {
            return (out.snap, WayOut { ticks: out.ticks - 1, ..*out });
        }
        (-self.limited(d), WayOut::STRAIGHT)
    }

    /// A snap brought down to Q along its own direction.
    fn limited(&self, snap: &Vector3<f32>) -> Vector3<f32> {
        let length = math::sqrt(snap.norm_squared());
        if length <= self.snap { *snap } else { snap * (self.snap / length) }
    }
}

/// The direction of a vector; none of zero.
fn unit(y: &Vector3<f32>) -> Vector3<f32> {
    let length = math::sqrt(y.norm_squared());
    if length > 0.0 { y / length } else { Vector3::zeros() }
}

