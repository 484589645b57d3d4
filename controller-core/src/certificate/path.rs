//! A known reference judged along itself: force, jerk and snap as they belong together, at every instant. Section 11 of
//! `docs/extended-law.md`.
//!
//! - [`PathJudge`] says what a [`PathMotion`] takes of what limits and rotors leave, row by row: below one, nothing is
//!   limited near the target;
//! - [`along`] finds the most that a trajectory takes, with every peak between the instants looked at.

pub mod along;
mod judge;

pub use judge::PathJudge;

use crate::math;
use crate::math::real::Real;
use crate::reference::Reference;

/// D where the user does not say: the force per mass, in any direction, that a path keeps free, m/s^2.
pub const FORCE_KEPT_M_PER_S2: f32 = 1.0;

/// The part of the tilt's torque that a path keeps for a torque bias and for the tilt's feedback.
pub const TORQUE_KEPT_SHARE: f64 = 0.05;

/// A row of the judgement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathRow {
    /// How fast the reference falls.
    Fall,
    /// The greatest thrust.
    Thrust,
    /// How fast the thrust direction turns.
    TurningRate,
    /// The torque about the tilt's axes.
    Torque,
    /// The thrust below which no torque is left.
    Floor,
    /// The greatest tilt.
    Cone,
}

impl PathRow {
    /// All of them, in the order of the table.
    pub const ALL: [Self; 6] = [Self::Fall, Self::Thrust, Self::TurningRate, Self::Torque, Self::Floor, Self::Cone];
}

/// What moves at an instant. World frame, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathMotion<R = f64> {
    /// p_d', m/s.
    pub velocity: [R; 3],
    /// p_d'', m/s^2.
    pub acceleration: [R; 3],
    /// p_d''', m/s^3.
    pub jerk: [R; 3],
    /// p_d'''', m/s^4.
    pub snap: [R; 3],
    /// psi', rad/s.
    pub heading_rate: R,
}

impl<R: Real> From<&Reference> for PathMotion<R> {
    fn from(reference: &Reference) -> Self {
        let Reference { velocity, acceleration, jerk, snap, heading, .. } = reference;
        let [velocity, acceleration, jerk, snap] =
            [velocity, acceleration, jerk, snap].map(|vector| [vector.x, vector.y, vector.z].map(R::from));
        Self { velocity, acceleration, jerk, snap, heading_rate: R::from(heading.rate()) }
    }
}

/// How far each derivative may be from a [`PathMotion`]'s, Euclidean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread<R = f64> {
    /// m/s.
    pub velocity: R,
    /// m/s^2.
    pub acceleration: R,
    /// m/s^3.
    pub jerk: R,
    /// m/s^4.
    pub snap: R,
    /// rad/s.
    pub heading_rate: R,
}

impl<R: Real> Spread<R> {
    /// A motion that is known.
    pub fn none() -> Self {
        let zero = R::from(0.0);
        Self { velocity: zero, acceleration: zero, jerk: zero, snap: zero, heading_rate: zero }
    }
}

/// What is taken of each row, as shares of what is left, in the order of [`PathRow::ALL`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RowShares<R = f64> {
    /// The shares; infinite where nothing is left.
    pub each: [R; PathRow::ALL.len()],
}

impl<R: Real> RowShares<R> {
    /// The greatest share: below one nothing is limited.
    pub fn worst(&self) -> f64 {
        self.each.iter().map(|share| share.upper()).fold(0.0, math::max_f64)
    }

    /// The row of which most is taken.
    pub fn row(&self) -> PathRow {
        let first = (PathRow::Fall, f64::NEG_INFINITY);
        let rows = PathRow::ALL.into_iter().zip(self.each.iter().map(|share| share.upper()));
        rows.fold(first, |worst, row| if row.1 > worst.1 { row } else { worst }).0
    }
}
