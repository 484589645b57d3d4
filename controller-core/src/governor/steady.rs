//! A command in steady acceleration, and what the averages and the spline make of it: where both begin, and begin again.
//!
//! The averages weigh the command's past with mean mu and variance sigma^2 (ticks). With x_0, u and alpha now, alpha always the
//! same, the newest control point P, its difference D1 and the control point at the knot P_-2 are
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

/// N mu, and 4 N (sigma^2 + mu^2 - mu) / 2.
fn moments(windows: &Windows) -> (i64, i64) {
    let product = windows.product();
    let total = windows.span();
    let spread: i64 = windows.lengths.iter().map(|length| (*length * *length) as i64 - 1).map(|s| product * s / 6).sum();
    (product / 2 * (total - 3), spread + product / 2 * (total - 3) * (total - 5))
}

impl Steady {
    /// What the averages make of it.
    pub fn outcome(&self, windows: &Windows) -> Outcome {
        let (mean, square) = moments(windows);
        let first = windows.product() * self.speed - mean * self.acceleration;
        let second = windows.product() * self.acceleration;
        let part = self.acceleration / 4 * square - mean * self.speed - 2 * first + second;
        // A product of zero: never designed, so nothing trails.
        let units = part.checked_div(windows.product()).unwrap_or(0);
        Outcome { place: self.commanded + units, part: part - units * windows.product(), first, second }
    }

    /// The command that comes out as nearly like `outcome` as whole units can.
    pub fn of(outcome: &Outcome, windows: &Windows) -> Self {
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
