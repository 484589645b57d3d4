//! The bounds that a head is kept in, tick by tick, whatever snap is desired.
//!
//! The head is a velocity v, an acceleration a, its difference d a tick, and the second difference q that is chosen
//! each tick (d+ = d + q, a+ = a + d+). Required always: a in the cylinder C, |d| <= D, |q| <= Q, v in another
//! cylinder. A head inside may be lost nevertheless: too fast to be stopped before the wall. So a *retreat* is kept at
//! hand: a turn of some ticks with one constant q, then braking of d, straight, then a brought to zero, straight.
//!
//! - **Braking**: q = -Q d/|d|, at the end -d. The ticks that it takes add up to at most d |d|/(2 Q), so a moves along
//!   a segment, and C is convex: where a and r = a + d |d|/(2 Q) are in C it stays there, and ends with d = 0.
//! - **To zero**: from d = 0, along the segment from r to zero, at any d and q along it that are small enough.
//! - **The turn**: with n ticks of q, a runs along a parabola, which lies in the hull of its three control points a,
//!   a + n (d + q/2)/2 and a + n d + n(n+1)/2 q; d runs along a segment. Where these are inside, all of the turn is.
//! - **Speed**: until d is zero at most t_1 passes, and a is in the hull of these points p and r; then r fades to zero
//!   evenly, which adds at most r t_2. So v stays in the hull of v, v + t_1 p and these moved by r t_2.
//!
//! A q is taken only if from where it leads there is a retreat, and that one is kept. Otherwise the retreat at hand is
//! followed. So the bounds hold for ever, by induction, however poor the guess of a turn; a poor guess gives way too
//! early.

use super::braking::{BRAKING_SHARE, approach_speed};
use crate::math;
use nalgebra::Vector3;

/// Relative room for rounding, of the head to whole units and of all this to single precision.
const ROUNDING_MARGIN: f32 = 1e-4;

/// The turn's direction: so much inwards, so much back.
const TURN_INWARDS_WEIGHT: f32 = 0.8;
const TURN_BACK_WEIGHT: f32 = 0.6;

/// How often the desired snap is halved towards the retreat's before that is taken.
const HALVINGS_MAX: u32 = 3;

/// A cylinder about the vertical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cylinder {
    pub horizontal: f32,
    pub vertical: f32,
}

impl Cylinder {
    const NONE: Self = Self { horizontal: 0.0, vertical: 0.0 };

    fn holds(&self, y: &Vector3<f32>) -> bool {
        y.x * y.x + y.y * y.y <= self.horizontal * self.horizontal && y.z.abs() <= self.vertical
    }

    /// The square of the share that `y` takes of it.
    fn share(&self, y: &Vector3<f32>) -> f32 {
        let share = |square: f32, bound: f32| square / (bound * bound);
        math::max(share(y.xy().norm_squared(), self.horizontal), share(y.z * y.z, self.vertical))
    }

    /// The same with other measures.
    fn map(&self, change: impl Fn(f32) -> f32) -> Self {
        Self { horizontal: change(self.horizontal), vertical: change(self.vertical) }
    }
}

/// What an envelope is made of. World frame, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    pub speed: Cylinder,
    pub acceleration: Cylinder,
    pub jerk: f32,
    pub snap: f32,
}

/// The head at hand: m/s, m/s^2, m/s^2 per tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HeadMotion {
    pub velocity: Vector3<f32>,
    pub acceleration: Vector3<f32>,
    pub difference: Vector3<f32>,
}

impl HeadMotion {
    /// A tick later.
    fn after(&self, snap: &Vector3<f32>, period: f32) -> Self {
        let difference = self.difference + snap;
        let acceleration = self.acceleration + difference;
        Self { velocity: self.velocity + acceleration * period, acceleration, difference }
    }
}

/// The bounds: m/s^2 and ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Envelope {
    period: f32,
    speed: Cylinder,
    acceleration: Cylinder,
    jerk: f32,
    snap: f32,
    /// Ticks of a turn.
    turn: f32,
    /// t_1 and t_2, s.
    stopping: f32,
    fading: f32,
}

/// A retreat: a snap for some ticks, then braking, then a to zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Retreat {
    snap: Vector3<f32>,
    ticks: u32,
    /// Whether braking has ended.
    braked: bool,
}

impl Retreat {
    /// Braking at once.
    const STRAIGHT: Self = Self { snap: Vector3::new(0.0, 0.0, 0.0), ticks: 0, braked: false };
}

impl Envelope {
    /// Not designed yet: nothing is inside but rest.
    pub const NONE: Self = Self {
        period: 0.0,
        speed: Cylinder::NONE,
        acceleration: Cylinder::NONE,
        jerk: 0.0,
        snap: 0.0,
        turn: 0.0,
        stopping: 0.0,
        fading: 0.0,
    };

    /// For positive bounds. The head's velocity is known to `blur`, m/s.
    pub fn new(bounds: &Bounds, blur: f32, period: f32) -> Self {
        let Bounds { speed, acceleration, jerk, snap } = bounds;
        let turn = (0.25 * jerk / (snap * period)).max(1.0) as u32 as f32;
        let max = acceleration.horizontal + acceleration.vertical;
        let few = 4.0 * period;
        Self {
            period,
            speed: speed.map(|speed| (speed * (1.0 - ROUNDING_MARGIN) - blur).max(0.0)),
            acceleration: acceleration.map(|acceleration| acceleration * (1.0 - ROUNDING_MARGIN)),
            jerk: jerk * period * (1.0 - ROUNDING_MARGIN),
            snap: snap * period * period * (1.0 - ROUNDING_MARGIN),
            turn,
            stopping: turn * period + jerk / snap + few,
            fading: (max / jerk + jerk / snap) / (2.0 * BRAKING_SHARE * BRAKING_SHARE) + few,
        }
    }

    /// The greatest share of a bound that acceleration, jerk and snap take, SI units.
    pub fn used(&self, derivatives: [&Vector3<f32>; 3]) -> f32 {
        math::sqrt(self.shares(derivatives).into_iter().fold(0.0, math::max))
    }

    /// The squares of the shares of the bounds that acceleration, jerk and snap take, SI units.
    pub fn shares(&self, [acceleration, jerk, snap]: [&Vector3<f32>; 3]) -> [f32; 3] {
        let t = self.period;
        let share = |square: f32, bound: f32| square / (bound * bound);
        [
            self.acceleration.share(acceleration),
            share(jerk.norm_squared() * (t * t), self.jerk),
            share(snap.norm_squared() * (t * t) * (t * t), self.snap),
        ]
    }

    /// The square of the share of the speed that a velocity takes.
    pub fn share_of_speed(&self, velocity: &Vector3<f32>) -> f32 {
        self.speed.share(velocity)
    }

    /// Whether v keeps the speed on the way through these points, which ends in r.
    fn is_slow(&self, v: &Vector3<f32>, points: &[&Vector3<f32>], r: &Vector3<f32>) -> bool {
        let fading = r * self.fading;
        let both = |v: &Vector3<f32>| self.speed.holds(v) && self.speed.holds(&(v + fading));
        both(v) && points.iter().all(|p| both(&(v + *p * self.stopping)))
    }

    /// Where braking ends, and whether it stays inside.
    fn braked(&self, a: &Vector3<f32>, d: &Vector3<f32>) -> Option<Vector3<f32>> {
        let square = d.norm_squared();
        let reach = a + d * (math::sqrt(square) / (2.0 * (1.0 - ROUNDING_MARGIN) * self.snap));
        let inside = square <= self.jerk * self.jerk && self.acceleration.holds(&reach) && self.acceleration.holds(a);
        inside.then_some(reach)
    }

    /// A retreat, if one is known.
    pub fn retreat(&self, head: &HeadMotion) -> Option<Retreat> {
        let HeadMotion { velocity: v, acceleration: a, difference: d } = head;
        if let Some(reach) = self.braked(a, d) {
            return self.is_slow(v, &[a, &reach], &reach).then_some(Retreat::STRAIGHT);
        }
        let inwards = -Vector3::new(a.x, a.y, 0.0);
        let snap = unit(&(unit(&inwards) * TURN_INWARDS_WEIGHT - unit(d) * TURN_BACK_WEIGHT))
            * ((1.0 - ROUNDING_MARGIN) * self.snap);
        let n = self.turn;
        let middle = a + (d + snap * 0.5) * (0.5 * n);
        let turned = a + d * n + snap * (0.5 * n * (n + 1.0));
        let inside =
            d.norm_squared() <= self.jerk * self.jerk && self.acceleration.holds(a) && self.acceleration.holds(&middle);
        let reach = self.braked(&turned, &(d + snap * n)).filter(|_| inside)?;
        self.is_slow(v, &[a, &middle, &turned, &reach], &reach).then_some(Retreat {
            snap,
            ticks: n as u32,
            braked: false,
        })
    }

    /// The snap nearest to `desired` that leaves a retreat, and that one; with `retreat` at hand.
    pub fn step(&self, head: &HeadMotion, desired: &Vector3<f32>, retreat: &Retreat) -> (Vector3<f32>, Retreat) {
        let mut snap = self.limited(desired);
        let (fallback, after) = self.follow(head, retreat);
        for _ in 0..HALVINGS_MAX {
            if let Some(way) = self.retreat(&head.after(&snap, self.period)) {
                return (snap, way);
            }
            snap = (snap + fallback) * 0.5;
        }
        (fallback, after)
    }

    /// A tick of a retreat, and what is left of it. It ends at rest from acceleration, and stays there.
    pub fn follow(&self, head: &HeadMotion, retreat: &Retreat) -> (Vector3<f32>, Retreat) {
        let HeadMotion { acceleration: a, difference: d, .. } = head;
        if retreat.ticks > 0 {
            return (retreat.snap, Retreat { ticks: retreat.ticks - 1, ..*retreat });
        }
        let braked = retreat.braked || *d == Vector3::zeros();
        let step = BRAKING_SHARE * self.snap;
        let distance = math::sqrt(a.norm_squared()) / step;
        let snap = if !braked || distance == 0.0 {
            -d
        } else {
            let fastest = (step * approach_speed(distance)).min(BRAKING_SHARE * self.jerk);
            a * (-fastest / (distance * step)) - d
        };
        (self.limited(&snap), Retreat { braked, ..*retreat })
    }

    /// A snap brought down to Q along its own direction.
    fn limited(&self, snap: &Vector3<f32>) -> Vector3<f32> {
        let square = snap.norm_squared();
        if square <= self.snap * self.snap { *snap } else { snap * (self.snap / math::sqrt(square)) }
    }
}

/// The direction of a vector; none of zero.
fn unit(y: &Vector3<f32>) -> Vector3<f32> {
    let length = math::sqrt(y.norm_squared());
    if length > 0.0 { y / length } else { Vector3::zeros() }
}

#[cfg(test)]
mod tests;
