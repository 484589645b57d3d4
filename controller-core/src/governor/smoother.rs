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

use super::HISTORY;
use super::windows::Windows;
use nalgebra::Vector3;

/// One knot of the spline. World frame, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Knot {
    pub position: Vector3<f32>,
    pub velocity: Vector3<f32>,
    pub acceleration: Vector3<f32>,
    pub jerk: Vector3<f32>,
    pub snap: Vector3<f32>,
}

/// What turns the integers into SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Scales {
    metre: f32,
    velocity: f32,
    acceleration: f32,
    jerk: f32,
    snap: f32,
}

/// The filter's memory. Sums carry the factor N_1 N_2 N_3; lengths are in units, times in ticks.
#[derive(Debug, PartialEq)]
pub(super) struct Smoother<'m> {
    history: &'m mut [Vector3<i32>; HISTORY],
    newest: usize,
    taps: [(usize, i64); 8],
    product: i64,
    total: i64,
    scales: Scales,
    /// Command: position x_0 and velocity u.
    commanded: Vector3<i64>,
    speed: Vector3<i64>,
    /// N (x_0 - P) of the newest control point.
    trail: Vector3<i64>,
    /// N times the newest difference, second difference and so on of the control points.
    difference: [Vector3<i64>; 4],
}

impl<'m> Smoother<'m> {
    /// At rest at the origin.
    #[inline]
    pub fn new(windows: &Windows, period: f32, history: &'m mut [Vector3<i32>; HISTORY]) -> Self {
        let [first, second, third] = windows.lengths;
        let unit = 1.0 / (windows.per_metre * windows.product() as f32);
        let rate = 1.0 / period;
        history.fill(Vector3::zeros());
        Self {
            history,
            newest: 0,
            taps: [
                (0, 1),
                (first, -1),
                (second, -1),
                (third, -1),
                (first + second, 1),
                (first + third, 1),
                (second + third, 1),
                (first + second + third, -1),
            ],
            product: windows.product(),
            total: windows.lengths.iter().map(|&length| length as i64).sum(),
            scales: Scales {
                metre: 1.0 / windows.per_metre,
                velocity: unit * rate / 24.0,
                acceleration: unit * rate * rate / 6.0,
                jerk: 0.5 * unit * rate * rate * rate,
                snap: unit * rate * rate * rate * rate,
            },
            commanded: Vector3::zeros(),
            speed: Vector3::zeros(),
            trail: Vector3::zeros(),
            difference: [Vector3::zeros(); 4],
        }
    }

    /// Starts as if always in steady motion: the knot at hand has `position` (units) and `speed` (units a tick).
    #[inline]
    pub fn start(&mut self, position: Vector3<i64>, speed: Vector3<i64>) {
        self.history.fill(Vector3::zeros());
        self.speed = speed;
        // N_3 is even, so is the product, and the halving is exact.
        self.trail = speed * (self.product / 2 * (self.total - 3));
        self.difference = [speed * self.product, Vector3::zeros(), Vector3::zeros(), Vector3::zeros()];
        // trail / N, rounded to the nearest, and the two ticks that the control points are ahead.
        self.commanded = position + speed.map(|speed| (speed * (self.total + 1) + 1) >> 1);
    }

    /// Advances by one tick of commanded acceleration, in units per tick squared.
    #[inline]
    pub fn push(&mut self, acceleration: Vector3<i32>) {
        self.newest = (self.newest + 1) % HISTORY;
        if let Some(slot) = self.history.get_mut(self.newest) {
            *slot = acceleration;
        }
        let mut comb = Vector3::zeros();
        for (delay, sign) in self.taps {
            if let Some(past) = self.history.get((self.newest + HISTORY - delay) % HISTORY) {
                comb += past.map(i64::from) * sign;
            }
        }
        let [first, second, third, fourth] = &mut self.difference;
        *fourth += comb;
        *third += *fourth;
        *second += *third;
        *first += *second;
        self.speed += acceleration.map(i64::from);
        self.commanded += self.speed;
        self.trail += self.speed * self.product - *first;
    }

    /// The commanded position x_0, units.
    #[inline]
    pub fn commanded(&self) -> &Vector3<i64> {
        &self.commanded
    }

    /// The commanded velocity u, units a tick.
    #[inline]
    pub fn speed(&self) -> &Vector3<i64> {
        &self.speed
    }

    /// Whether nothing moves, nor will unless commanded.
    #[inline]
    pub fn at_rest(&self) -> bool {
        self.speed == Vector3::zeros() && self.trail == Vector3::zeros() && self.difference == [Vector3::zeros(); 4]
    }

    /// The knot at hand: one behind the newest control point but one, the last with all differences known.
    #[inline]
    pub fn knot(&self) -> Knot {
        let [first, second, third, fourth] = &self.difference;
        let here = second - third;
        // Twice the central third difference.
        let around = third * 2 - fourth;
        let behind = self.trail + first * 2 - second - here.map(|d| d >> 2) - fourth.map(|d| i64::from(d as i32 / 120));
        let position = self.commanded - behind.map(|sum| divided(sum, self.product));
        let single = |sum: Vector3<i64>, scale: f32| sum.map(|component| component as f32) * scale;
        Knot {
            position: single(position, self.scales.metre),
            velocity: single(first * 24 - second * 24 - here * 12 + around, self.scales.velocity),
            acceleration: single(here * 6 + fourth, self.scales.acceleration),
            jerk: single(around, self.scales.jerk),
            snap: single(*fourth, self.scales.snap),
        }
    }
}

/// `sum` / `count` to a unit or to 2^-44 of it, whichever is more: each pass of single precision leaves 2^-22 of what there was.
#[inline]
pub(super) fn divided(sum: i64, count: i64) -> i64 {
    let share = 1.0 / count as f32;
    let (mut quotient, mut rest) = (0, sum);
    for _ in 0..2 {
        let part = (rest as f32 * share) as i64;
        quotient += part;
        rest -= part * count;
    }
    quotient
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::super::tests::TYPICAL;
    use super::super::{GovernorLimits, tests::Random};
    use super::*;
    use std::vec::Vec;

    fn windows() -> Windows {
        Windows::design(&TYPICAL, &GovernorLimits::default(), 0.01).unwrap()
    }

    /// Three averages of the commands, run one after another in floating point.
    fn averaged(commands: &[f64], lengths: [usize; 3]) -> Vec<f64> {
        let mut signal = commands.to_vec();
        for length in lengths {
            signal = (0..signal.len())
                .map(|k| (0..length).map(|i| if k >= i { signal[k - i] } else { 0.0 }).sum::<f64>() / length as f64)
                .collect();
        }
        signal
    }

    #[test]
    fn the_comb_and_its_sums_are_three_moving_averages() {
        let windows = windows();
        let mut history = [Vector3::zeros(); HISTORY];
        let mut smoother = Smoother::new(&windows, 0.01, &mut history);
        let mut random = Random::new(5);
        let commands: Vec<i32> = (0..1_500).map(|_| (random.signed() * 60_000.0) as i32).collect();
        let expected = averaged(&commands.iter().map(|&c| f64::from(c)).collect::<Vec<_>>(), windows.lengths);
        for (command, expected) in commands.iter().zip(&expected) {
            smoother.push(Vector3::new(*command, -command, 0));
            let average = smoother.difference[1].x as f64 / windows.product() as f64;
            assert!((average - expected).abs() < 1e-6, "{average} against {expected}");
        }
    }

    #[test]
    fn a_steady_motion_comes_out_as_it_went_in() {
        let windows = windows();
        let mut history = [Vector3::zeros(); HISTORY];
        let mut smoother = Smoother::new(&windows, 0.01, &mut history);
        let unit = windows.per_metre;
        smoother.start(Vector3::new(unit as i64 * 3, 0, -(unit as i64)), Vector3::new(0, (unit * 0.02) as i64, 0));
        for tick in 0..2_000 {
            let knot = smoother.knot();
            assert_eq!((knot.position.x, knot.position.z), (3.0, -1.0));
            assert!((knot.position.y - 0.02 * tick as f32).abs() < 1e-5, "{} at {tick}", knot.position.y);
            assert!((knot.velocity.y - 2.0).abs() < 1e-6 && knot.acceleration.norm() == 0.0);
            smoother.push(Vector3::zeros());
        }
    }

    #[test]
    fn a_quotient_is_off_by_a_unit_or_by_next_to_nothing() {
        let mut random = Random::new(7);
        for _ in 0..100_000 {
            let sum = (random.signed() * 2.0_f32.powf(62.0 * random.unit())) as i64;
            let count = (2.0_f32.powf(23.0 * random.unit())) as i64;
            let miss = (divided(sum, count) - sum / count).abs();
            assert!(miss <= 1 + ((sum / count).abs() >> 44), "{sum} by {count}: off by {miss}");
        }
    }

    #[test]
    fn a_million_ticks_of_noise_leave_no_trace() {
        let windows = windows();
        let mut history = [Vector3::zeros(); HISTORY];
        let mut smoother = Smoother::new(&windows, 0.01, &mut history);
        let mut random = Random::new(6);
        for _ in 0..1_000_000 {
            let speed = smoother.speed().x as f32 / 1e7;
            smoother.push(Vector3::new(((random.signed() - speed) * 30_000.0) as i32, 0, 0));
        }
        let steps = 100;
        let (whole, rest) = (smoother.speed().x / steps, smoother.speed().x % steps);
        for step in 0..steps {
            smoother.push(Vector3::new(-(whole + i64::from(step == 0) * rest) as i32, 0, 0));
        }
        for _ in 0..HISTORY {
            smoother.push(Vector3::zeros());
        }
        assert!(smoother.at_rest());
    }
}
