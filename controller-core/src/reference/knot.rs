//! A point of a path, with how it is passed: what [`super::spline`] and [`super::inside`] find, and what
//! [`super::segment`] connects.

use super::phase;
use crate::math;
use core::f64::consts::{PI, TAU};
use nalgebra::{Vector3, Vector4};

/// Turns this close (rad) to half a turn count as exactly half: degrees become radians with errors of 1e-16.
const HALF_TURN_TOLERANCE_RAD: f64 = 1e-9;

/// Velocity, acceleration, jerk and snap of x, y, z (m) and heading (rad), per second to the first to fourth.
pub type Derivatives = [Vector4<f64>; 4];

/// At rest.
pub const REST: Derivatives = [Vector4::new(0.0, 0.0, 0.0, 0.0); 4];

/// A point to pass. World frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knot {
    /// When, microseconds after the start.
    pub time_us: u64,
    /// Where, m.
    pub position: Vector3<f64>,
    /// Pointing where, rad, modulo a full turn: between two knots the heading turns the shorter way round, an exact
    /// half turn counter-clockwise.
    pub heading: f64,
    /// How it is passed.
    pub derivatives: Derivatives,
}

/// A place in space and on the circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Anchor {
    /// m, world.
    pub position: Vector3<f32>,
    /// Heading in 2^-64 turns.
    pub phase: u64,
}

impl Knot {
    /// Where it is, as flown.
    pub(super) fn anchor(&self) -> Anchor {
        Anchor { position: self.position.map(|x| x as f32), phase: phase::turns(self.heading) }
    }

    /// From here to `next`, s.
    pub(super) fn duration_to(&self, next: &Self) -> f64 {
        next.time_us.saturating_sub(self.time_us) as f64 * 1e-6
    }

    /// From here to `next`: m, and rad the shorter way round.
    pub(super) fn difference_to(&self, next: &Self) -> Vector4<f64> {
        let difference = next.position - self.position;
        let turn = next.heading - self.heading;
        let shorter = turn - TAU * math::round(turn / TAU);
        let shorter = if shorter <= HALF_TURN_TOLERANCE_RAD - PI { shorter + TAU } else { shorter };
        Vector4::new(difference.x, difference.y, difference.z, shorter)
    }
}

/// Hands `solve` one run of knots after the other, each from rest to rest: two equal points in a row are a wait, and a
/// wait begins and ends at rest.
pub(super) fn runs(knots: &mut [Knot], mut solve: impl FnMut(&mut [Knot])) {
    let mut rest = knots;
    while !rest.is_empty() {
        let moving = rest.windows(2).take_while(|pair| match pair {
            [knot, next] => knot.difference_to(next) != Vector4::zeros(),
            _ => false,
        });
        let length = 1 + moving.count();
        let Some((run, others)) = rest.split_at_mut_checked(length) else { return };
        if let [first, .., last] = run {
            (first.derivatives, last.derivatives) = (REST, REST);
        }
        solve(run);
        rest = others;
    }
}
