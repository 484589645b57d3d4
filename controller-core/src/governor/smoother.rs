//! Three moving averages and a quintic spline, in integers: from commanded accelerations to position and derivatives.
//!
//! The averages' output A_m is the second difference of control points P_m, one a tick, of a uniform quintic B-spline.
//! The reference *is* that spline, a function of continuous time with continuous snap, sampled at its knots:
//!
//! p = P + D2/4 + D4/120,  T p' = D1 + D3/12,  T^2 p'' = D2 + D4/6,  T^3 p''' = D3,  T^4 p'''' = D4
//!
//! with T the period and D1..D4 the central differences of P at the knot (D1 and D3 the mean of the two beside it). Each
//! derivative of a B-spline is a convex combination of the like differences of its control points, so what the windows
//! guarantee for the differences (see [`super::windows`]) holds for the derivatives, between ticks as well.
//!
//! The averages are run as one comb and a row of sums (a CIC filter): with lengths N_1, N_2, N_3 the third difference of
//! N_1 N_2 N_3 A is alpha at eight delays with signs, all in integers. Nothing rounds, so nothing drifts, ever, and one
//! short history serves all three. The position is kept as the command's, x_0, less what the averages trail behind.

use super::limits::HISTORY;
use super::windows::Windows;
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

/// One axis of the filter's memory. Sums carry the factor N = N_1 N_2 N_3; lengths are in units, times in ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Axis {
    /// Command: position x_0 and velocity u.
    commanded: i64,
    speed: i64,
    /// N (x_0 - P) of the newest control point.
    trail: i64,
    /// N times the newest difference, second difference and so on of the control points.
    difference: [i64; 4],
}

impl Axis {
    /// At rest at the origin.
    const AT_REST: Self = Self { commanded: 0, speed: 0, trail: 0, difference: [0; 4] };

    /// Always in steady motion, with averages that span `total` ticks together.
    fn steady(position: i64, speed: i64, product: i64, total: i64) -> Self {
        Self {
            // The trail, rounded to the nearest unit, and the two ticks that the control points are ahead.
            commanded: position + ((speed * (total + 1) + 1) >> 1),
            speed,
            // N_3 is even, so is the product, and the halving is exact.
            trail: speed * ((product >> 1) * (total - 3)),
            difference: [speed * product, 0, 0, 0],
        }
    }

    fn push(&mut self, acceleration: i32, comb: i32, product: i64) {
        let [first, second, third, fourth] = &mut self.difference;
        *fourth += i64::from(comb);
        *third += *fourth;
        *second += *third;
        *first += *second;
        self.speed += i64::from(acceleration);
        self.commanded += self.speed;
        self.trail += self.speed * product - *first;
    }

    fn knot(&self, product: i64, scales: &Derivatives<f32>) -> Derivatives<f32> {
        let [first, second, third, fourth] = self.difference;
        let behind = self.trail + 2 * first - second;
        let (first, second, third, fourth) = (first as f32, second as f32, third as f32, fourth as f32);
        let here = second - third;
        // The central third difference.
        let around = third - 0.5 * fourth;
        let bend = 0.25 * here + fourth / 120.0;
        // A product of zero: never designed, so nothing trails.
        let behind = (behind - bend as i64).checked_div(product).unwrap_or(0);
        Derivatives {
            position: (self.commanded - behind) as f32 * scales.position,
            velocity: (first - second - 0.5 * here + around / 12.0) * scales.velocity,
            acceleration: (here + fourth / 6.0) * scales.acceleration,
            jerk: around * scales.jerk,
            snap: fourth * scales.snap,
        }
    }
}

/// The filter's memory.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Smoother {
    history: [Vector3<i32>; HISTORY],
    newest: usize,
    taps: [(usize, i32); 8],
    product: i64,
    total: i64,
    /// What turns the integers into SI units.
    scales: Derivatives<f32>,
    axes: [Axis; 3],
}

impl Smoother {
    /// Not designed yet, at rest at the origin.
    pub const NONE: Self = Self {
        history: [Vector3::new(0, 0, 0); HISTORY],
        newest: 0,
        taps: [(0, 0); 8],
        product: 0,
        total: 0,
        scales: Derivatives { position: 0.0, velocity: 0.0, acceleration: 0.0, jerk: 0.0, snap: 0.0 },
        axes: [Axis::AT_REST; 3],
    };

    /// Prepares for `windows`.
    pub fn design(&mut self, windows: &Windows, period: f32) {
        let [first, second, third] = windows.lengths;
        self.product = windows.product();
        self.total = (first + second + third) as i64;
        self.taps = [
            (0, 1),
            (first, -1),
            (second, -1),
            (third, -1),
            (first + second, 1),
            (first + third, 1),
            (second + third, 1),
            (first + second + third, -1),
        ];
        let unit = 1.0 / (windows.per_metre * self.product as f32);
        let rate = 1.0 / period;
        self.scales = Derivatives {
            position: 1.0 / windows.per_metre,
            velocity: unit * rate,
            acceleration: unit * rate * rate,
            jerk: unit * rate * rate * rate,
            snap: unit * rate * rate * rate * rate,
        };
    }

    /// Starts as if always in steady motion: the knot at hand has `position` (units) and `speed` (units a tick).
    pub fn start(&mut self, position: &Vector3<i64>, speed: &Vector3<i64>) {
        self.history.fill(Vector3::zeros());
        let steady = |position: i64, speed: i64| Axis::steady(position, speed, self.product, self.total);
        self.axes = [steady(position.x, speed.x), steady(position.y, speed.y), steady(position.z, speed.z)];
    }

    /// Advances by one tick of commanded acceleration, in units per tick squared.
    pub fn push(&mut self, acceleration: &Vector3<i32>) {
        self.newest = (self.newest + 1) % HISTORY;
        if let Some(slot) = self.history.get_mut(self.newest) {
            *slot = *acceleration;
        }
        let mut comb = Vector3::zeros();
        for (delay, sign) in self.taps {
            if let Some(past) = self.history.get((self.newest + HISTORY - delay) % HISTORY) {
                comb += past * sign;
            }
        }
        let [x, y, z] = &mut self.axes;
        x.push(acceleration.x, comb.x, self.product);
        y.push(acceleration.y, comb.y, self.product);
        z.push(acceleration.z, comb.z, self.product);
    }

    /// The commanded position x_0, units.
    pub fn commanded(&self) -> Vector3<i64> {
        let [x, y, z] = &self.axes;
        Vector3::new(x.commanded, y.commanded, z.commanded)
    }

    /// The commanded velocity u, units a tick.
    pub fn speed(&self) -> Vector3<i64> {
        let [x, y, z] = &self.axes;
        Vector3::new(x.speed, y.speed, z.speed)
    }

    /// Whether nothing moves, nor will unless commanded.
    pub fn at_rest(&self) -> bool {
        self.axes.iter().all(|axis| *axis == Axis { commanded: axis.commanded, ..Axis::AT_REST })
    }

    /// The knot at hand: one behind the newest control point but one, the last with all differences known.
    pub fn knot(&self) -> Knot {
        let [x, y, z] = &self.axes;
        let knot = |axis: &Axis| axis.knot(self.product, &self.scales);
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
