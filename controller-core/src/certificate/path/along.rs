//! The most that a trajectory takes, at any instant: cells of time, and enclosures of the motion in each.
//!
//! In a cell of half-width h about t, with c the greatest fifth derivative there,
//!
//! ```text
//! |p''''(s) - p''''(t)| <= h c,  |p'''(s) - p'''(t)| <= h (|p''''(t)| + h c),  and so on down to p',
//! ```
//!
//! and psi' moves by at most h times the bound of psi''. [`PathJudge::shares_within`] bounds all motions so near to the
//! one at t. A cell whose bound is above what was found at instants is halved, until the bound exceeds that by no more
//! than [`BOUND_TOLERANCE`].

use super::{PathJudge, PathMotion, PathRow, RowShares, Spread};
use crate::math::real::Real;
use crate::reference::Trajectory;

/// How far, relative, the bound may be above a share that is taken.
pub const BOUND_TOLERANCE: f64 = 2e-3;

/// The first cells, us, and how often one is halved at most: to 8 us.
const FIRST_CELL_US: u64 = 1 << 17;
const HALVINGS_MAX: u32 = 14;

/// What a trajectory takes of what is left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaxShare {
    /// No instant takes a greater share: below one, nothing is limited.
    pub share: f64,
    /// Of which row most is taken.
    pub row: PathRow,
    /// When, us: within [`BOUND_TOLERANCE`] of the greatest share.
    pub at_us: u64,
}

impl MaxShare {
    /// The most from the start to `end_us`, microseconds.
    pub fn along<R: Real>(judge: &PathJudge<R>, trajectory: &dyn Trajectory, end_us: u64) -> Self {
        let mut search = Search { judge, trajectory, attained: SampledShare::NOTHING, bound: 0.0 };
        let mut from = 0;
        loop {
            let to = end_us.min(from + FIRST_CELL_US);
            search.refine(from, to, HALVINGS_MAX);
            if to == end_us {
                let SampledShare { row, at_us, .. } = search.attained;
                return Self { share: search.bound, row, at_us };
            }
            from = to;
        }
    }
}

/// The greatest share at the instants looked at.
#[derive(Clone, Copy)]
struct SampledShare {
    share: f64,
    row: PathRow,
    at_us: u64,
}

impl SampledShare {
    const NOTHING: Self = Self { share: 0.0, row: PathRow::Fall, at_us: 0 };
}

/// A search in the making.
struct Search<'a, R> {
    judge: &'a PathJudge<R>,
    trajectory: &'a dyn Trajectory,
    attained: SampledShare,
    bound: f64,
}

impl<R: Real> Search<'_, R> {
    fn refine(&mut self, from: u64, to: u64, halvings: u32) {
        let middle = from + (to - from) / 2;
        let motion = PathMotion::from(&self.trajectory.at(middle));
        let here: RowShares<R> = self.judge.shares(&motion);
        if here.worst() > self.attained.share {
            self.attained = SampledShare { share: here.worst(), row: here.row(), at_us: middle };
        }
        let bound = self.judge.shares_within(&motion, &self.spread(&motion, from, to)).worst();
        if halvings == 0 || to - from < 2 || bound <= self.attained.share * (1.0 + BOUND_TOLERANCE) {
            self.bound = self.bound.max(bound);
        } else {
            self.refine(from, middle, halvings - 1);
            self.refine(middle, to, halvings - 1);
        }
    }

    /// How far the motions of a cell are from that in its middle.
    fn spread(&self, motion: &PathMotion<R>, from: u64, to: u64) -> Spread<R> {
        // Half of the cell, and what the middle was rounded by.
        let half = R::from((to - from + 1) as f64 * 0.5e-6);
        let fifth = R::from(self.trajectory.fifth_derivative(from, to));
        let turning = R::from(self.trajectory.bounds().heading_second_derivative);
        let [snap, jerk, acceleration] =
            [motion.snap, motion.jerk, motion.acceleration].map(|[x, y, z]| x.hypot(y).hypot(z));
        let moved_snap = half * fifth;
        let moved_jerk = half * (snap + moved_snap);
        let moved_acceleration = half * (jerk + moved_jerk);
        Spread {
            velocity: half * (acceleration + moved_acceleration),
            acceleration: moved_acceleration,
            jerk: moved_jerk,
            snap: moved_snap,
            heading_rate: half * turning,
        }
    }
}

#[cfg(test)]
mod tests;
