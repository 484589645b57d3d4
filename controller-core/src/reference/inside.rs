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

use super::spline::{Derivatives, REST, SEGMENTS, Span};

/// The derivatives at the points between `spans`: one entry fewer than spans.
pub(super) fn solve(spans: &[Span]) -> heapless::Vec<Derivatives, SEGMENTS> {
    let mut derivatives = heapless::Vec::new();
    for (span, next) in spans.iter().zip(spans.iter().skip(1)) {
        let [before, after] = [span, next].map(|span| span.difference / span.duration);
        let velocity = before.zip_map(&after, |v, w| if v * w > 0.0 { v.signum() * v.abs().min(w.abs()) } else { 0.0 });
        let [_, acceleration, jerk, snap] = REST;
        // There is room: no more spans than the storage they come in.
        let _ = derivatives.push([velocity, acceleration, jerk, snap]);
    }
    derivatives
}
