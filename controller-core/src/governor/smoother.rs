//! The last moving average and a quintic spline, in integers: from snap, tick by tick, to position and derivatives.
//!
//! What comes in is the second difference c of the *head*: an acceleration whose own bounds hold already, jerk and snap
//! included (by [`super::averages`] or by [`super::tracker`]). It is averaged once more, over N_3 ticks: so snap is
//! continuous. The averaged head is the second difference of control points P_m, one a tick, of a uniform quintic
//! B-spline. The reference *is* that spline, a function of continuous time with continuous snap, sampled at its knots:
//!
//! p = P + D2/4 + D4/120,  T p' = D1 + D3/12,  T^2 p'' = D2 + D4/6,  T^3 p''' = D3,  T^4 p'''' = D4
//!
//! with T the period and D1..D4 the central differences of P at the knot (D1 and D3 the mean of the two beside it). An
//! average is a convex combination of the head, and each derivative of a B-spline is one of the like differences of its
//! control points. So the bounds of the head are those of the reference, between ticks as well.
//!
//! All sums carry the factor N = N_1 N_2 N_3 of the averages: nothing is divided, nothing rounds, nothing drifts.

use super::limits::LAST_AVERAGE_MAX_TICKS;
use super::steady::{Outcome, Steady};
use super::windows::Windows;
use crate::math::{f32_to_i64, i64_to_f32};
use nalgebra::Vector3;

/// Position and derivatives at a knot of the spline: of one axis, or of all three.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Derivatives<T> {
    pub position: T,
    pub velocity: T,
    pub acceleration: T,
    pub jerk: T,
    pub snap: T,
}

/// One knot of the spline. World frame, SI units.
pub(super) type Knot = Derivatives<Vector3<f32>>;

impl Knot {
    /// At rest at the origin.
    pub const NONE: Self = {
        let zero = Vector3::new(0.0, 0.0, 0.0);
        Self { position: zero, velocity: zero, acceleration: zero, jerk: zero, snap: zero }
    };

    /// The spline `back` seconds before the knot, at most the time between two, with its fifth derivative in there,
    /// m/s^5: p - s (v - s/2 (a - s/3 (j - s/4 (snap - s/5 crackle)))), and its derivatives.
    pub fn earlier(&self, back: f32, crackle: &Vector3<f32>) -> Self {
        if back == 0.0 {
            return *self;
        }
        let Self { position, velocity, acceleration, jerk, snap } = self;
        let from = |to: &Vector3<f32>, rate: Vector3<f32>, order: f32| to - rate * (back / order);
        Self {
            position: from(
                position,
                from(velocity, from(acceleration, from(jerk, from(snap, *crackle, 5.0), 4.0), 3.0), 2.0),
                1.0,
            ),
            velocity: from(velocity, from(acceleration, from(jerk, from(snap, *crackle, 4.0), 3.0), 2.0), 1.0),
            acceleration: from(acceleration, from(jerk, from(snap, *crackle, 3.0), 2.0), 1.0),
            jerk: from(jerk, from(snap, *crackle, 2.0), 1.0),
            snap: from(snap, *crackle, 1.0),
        }
    }
}

/// The head: acceleration and its difference, times N_1 N_2, units per tick squared (cubed).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Head {
    pub acceleration: i64,
    pub jerk: i64,
}

/// One axis of the filter's memory. Lengths are in units, times in ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Axis {
    head: Head,
    /// N times the newest difference, second difference and so on of the control points.
    difference: [i64; 4],
    /// The control point at the knot, two ticks old: whole units, and N times the rest, which is a few units at most.
    place: i64,
    part: i64,
}

impl Axis {
    /// At rest at the origin.
    const AT_REST: Self = Self { head: Head { acceleration: 0, jerk: 0 }, difference: [0; 4], place: 0, part: 0 };

    fn push(&mut self, snap: i32, dropped: i32, scales: &Scales) {
        let Head { acceleration, jerk } = &mut self.head;
        *jerk += i64::from(snap);
        *acceleration += *jerk;
        let [first, second, third, fourth] = &mut self.difference;
        *fourth += i64::from(snap) - i64::from(dropped);
        *third += *fourth;
        *second += *third;
        *first += *second;
        self.part += *first - 2 * *second + *third;
        // Whole units go over to the place. How many need not be exact: what is left goes over in the next ticks.
        let units = f32_to_i64(i64_to_f32(self.part) * scales.per_product);
        self.place += units;
        self.part -= units * scales.product;
    }

    fn knot(&self, scales: &Scales) -> Derivatives<f32> {
        let [first, second, third, fourth] = self.difference.map(i64_to_f32);
        let here = second - third;
        // The central third difference.
        let around = third - 0.5 * fourth;
        let part = (i64_to_f32(self.part) + 0.25 * here + fourth / 120.0) * scales.per_product;
        let Derivatives { position, velocity, acceleration, jerk, snap } = &scales.knot;
        Derivatives {
            position: i64_to_f32(self.place) * position + part * position,
            velocity: (first - second - 0.5 * here + around / 12.0) * velocity,
            acceleration: (here + fourth / 6.0) * acceleration,
            jerk: around * jerk,
            snap: fourth * snap,
        }
    }
}

/// What turns the integers into SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Scales {
    /// N, and one over it.
    product: i64,
    per_product: f32,
    knot: Derivatives<f32>,
}

/// The filter's memory.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Smoother {
    history: [Vector3<i32>; LAST_AVERAGE_MAX_TICKS],
    newest: usize,
    /// N_3.
    length: usize,
    scales: Scales,
    axes: [Axis; 3],
}

impl Smoother {
    /// Not designed yet, at rest at the origin.
    pub const NONE: Self = Self {
        history: [Vector3::new(0, 0, 0); LAST_AVERAGE_MAX_TICKS],
        newest: 0,
        length: 0,
        scales: Scales {
            product: 0,
            per_product: 0.0,
            knot: Derivatives { position: 0.0, velocity: 0.0, acceleration: 0.0, jerk: 0.0, snap: 0.0 },
        },
        axes: [Axis::AT_REST; 3],
    };

    /// Prepares for `windows`.
    pub fn design(&mut self, windows: &Windows, period: f32) {
        self.length = windows.lengths[2];
        let product = windows.product();
        let unit = 1.0 / (windows.per_metre * product as f32);
        let rate = 1.0 / period;
        self.scales = Scales {
            product,
            // Not too small: so what is a whole number of units goes over to the place, all of it.
            per_product: (1.0 / product as f32).next_up(),
            knot: Derivatives {
                position: 1.0 / windows.per_metre,
                velocity: unit * rate,
                acceleration: unit * rate * rate,
                jerk: unit * rate * rate * rate,
                snap: unit * rate * rate * rate * rate,
            },
        };
    }

    /// Goes on as if each axis' command had always been in the same steady acceleration.
    pub fn start(&mut self, commands: &[Steady; 3], windows: &Windows) {
        self.history.fill(Vector3::zeros());
        for (axis, command) in self.axes.iter_mut().zip(commands) {
            let Outcome { place, part, first, second } = command.outcome(windows);
            let head = Head { acceleration: command.acceleration * windows.head(), jerk: 0 };
            *axis = Axis { head, difference: [first, second, 0, 0], place, part };
        }
    }

    /// The commands whose averages go on as what is at hand does, where that has been in steady acceleration for N_3
    /// ticks.
    pub fn steady(&self, windows: &Windows) -> [Steady; 3] {
        self.axes.map(|Axis { difference: [first, second, ..], place, part, .. }| {
            Steady::from_outcome(&Outcome { place, part, first, second }, windows)
        })
    }

    /// Advances by one tick of the head's snap: its second difference.
    pub fn push(&mut self, snap: &Vector3<i32>) {
        self.newest = (self.newest + 1) % LAST_AVERAGE_MAX_TICKS;
        let oldest = (self.newest + LAST_AVERAGE_MAX_TICKS - self.length) % LAST_AVERAGE_MAX_TICKS;
        // Read first: a window as long as the history drops what is about to be overwritten.
        let dropped = self.history.get(oldest).copied().unwrap_or_default();
        if let Some(slot) = self.history.get_mut(self.newest) {
            *slot = *snap;
        }
        let [x, y, z] = &mut self.axes;
        x.push(snap.x, dropped.x, &self.scales);
        y.push(snap.y, dropped.y, &self.scales);
        z.push(snap.z, dropped.z, &self.scales);
    }

    /// Each axis' head.
    pub fn head(&self) -> Vector3<Head> {
        let [x, y, z] = &self.axes;
        Vector3::new(x.head, y.head, z.head)
    }

    /// Where the knot at hand is, to a few units.
    pub fn place(&self) -> Vector3<i64> {
        let [x, y, z] = &self.axes;
        Vector3::new(x.place, y.place, z.place)
    }

    /// Whether nothing moves, nor will while the command stays where it is.
    pub fn at_rest(&self, commanded: &Vector3<i64>) -> bool {
        let rests = |(axis, commanded): (&Axis, &i64)| {
            let behind = (commanded - axis.place).wrapping_mul(self.scales.product) - axis.part;
            behind == 0 && *axis == Axis { place: axis.place, part: axis.part, ..Axis::AT_REST }
        };
        self.axes.iter().zip(commanded).all(rests)
    }

    /// The knot at hand: one behind the newest control point but one, the last with all differences known.
    pub fn knot(&self) -> Knot {
        let [x, y, z] = &self.axes;
        let knot = |axis: &Axis| axis.knot(&self.scales);
        let (x, y, z) = (knot(x), knot(y), knot(z));
        Knot {
            position: Vector3::new(x.position, y.position, z.position),
            velocity: Vector3::new(x.velocity, y.velocity, z.velocity),
            acceleration: Vector3::new(x.acceleration, y.acceleration, z.acceleration),
            jerk: Vector3::new(x.jerk, y.jerk, z.jerk),
            snap: Vector3::new(x.snap, y.snap, z.snap),
        }
    }
}

#[cfg(test)]
mod tests;
