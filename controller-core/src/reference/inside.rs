//! A way through given points that never swings out: on every leg each coordinate goes from one point's to the next
//! one's and never back, so the leg stays inside the box of its two points.
//!
//! A point is passed with acceleration, jerk and snap zero, and on each axis with the lesser of the mean speeds of the
//! two legs, or with none where they lead opposite ways. With v and w such speeds at the ends of a leg of duration T
//! and length D, the ten control points of degree 9 are
//!
//! 0, v T / 9, …, 4 v T / 9, D - 4 w T / 9, …, D - w T / 9, D,
//!
//! which never turn back, because 4 (v + w) T / 9 <= 8 D / 9; nor does the curve, whose velocity has their differences
//! as control points. Through points in a line, evenly spaced in time, the speed is constant.

use super::knot::{Knot, REST, runs};

/// Finds how to pass each of the `knots`, whose times increase.
pub fn solve(knots: &mut [Knot]) {
    runs(knots, |run| {
        for i in 1..run.len() {
            let Some([before, knot, after]) = run.get_mut(i - 1..i + 2) else { return };
            let arriving = before.difference_to(knot) / before.duration_to(knot);
            let leaving = knot.difference_to(after) / knot.duration_to(after);
            let slower = |v: f64, w: f64| if v * w > 0.0 { v.signum() * v.abs().min(w.abs()) } else { 0.0 };
            let [_, acceleration, jerk, snap] = REST;
            knot.derivatives = [arriving.zip_map(&leaving, slower), acceleration, jerk, snap];
        }
    });
}
