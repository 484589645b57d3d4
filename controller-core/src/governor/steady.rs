//! A command in steady acceleration, and what the averages and the spline make of it: where both begin, and begin
//! again.
//!
//! The averages weigh the command's past with mean mu and variance sigma^2 (ticks). With x_0, u and alpha now, alpha
//! always the same, the newest control point P, its difference D1 and the control point at the knot P_-2 are
//!
//! D1 = u - mu alpha,  P = x_0 - mu u + (sigma^2 + mu^2 - mu) alpha / 2,  P_-2 = P - 2 D1 + alpha.
//!
//! Times N = N_1 N_2 N_3, of which N_3 is even, each is a whole number where alpha is a multiple of four.

use super::windows::Windows;

/// The command: length units and ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Steady {
    /// x_0.
    pub commanded: i64,
    /// u.
    pub speed: i64,
    /// alpha, a multiple of four.
    pub acceleration: i64,
}

/// What it comes out as: N times D1 and P_-2, the latter less N times a place in whole units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Outcome {
    pub place: i64,
    pub part: i64,
    pub first: i64,
    /// N alpha.
    pub second: i64,
}

/// N mu, and 4 N times the acceleration's factor in P_-2: (sigma^2 + mu^2 - mu)/2 + 2 mu + 1.
fn moments(windows: &Windows) -> (i64, i64) {
    let (product, total) = (windows.product(), windows.span());
    let spread: i64 =
        windows.lengths.iter().map(|length| (*length * *length) as i64 - 1).map(|s| product * s / 6).sum();
    let mean = product / 2 * (total - 3);
    (mean, spread + mean * (total - 5) + 8 * mean + 4 * product)
}

impl Steady {
    /// What the averages make of it.
    pub fn outcome(&self, windows: &Windows) -> Outcome {
        let product = windows.product();
        let (mean, bend) = moments(windows);
        // Of the speed mu + 2 ticks: in halves, as mu is.
        let halves = self.speed * (windows.span() + 1);
        let part = self.acceleration / 4 * bend - (halves & 1) * (product / 2);
        // A product of zero: never designed, so nothing trails.
        let units = part.checked_div(product).unwrap_or(0);
        Outcome {
            place: self.commanded - (halves >> 1) + units,
            part: part - units * product,
            first: product * self.speed - mean * self.acceleration,
            second: product * self.acceleration,
        }
    }

    /// The command that comes out as nearly like `outcome` as whole units can.
    pub fn from_outcome(outcome: &Outcome, windows: &Windows) -> Self {
        let product = windows.product();
        let nearest = |sum: i64| (sum + product / 2).checked_div_euclid(product).unwrap_or(0);
        let (mean, _) = moments(windows);
        let acceleration = outcome.second.checked_div(4 * product).unwrap_or(0) * 4;
        let speed = nearest(outcome.first + mean * acceleration);
        let here = Self { commanded: outcome.place, speed, acceleration };
        let there = here.outcome(windows);
        let missing = outcome.place - there.place + nearest(outcome.part - there.part);
        Self { commanded: here.commanded + missing, ..here }
    }
}
