//! What a motion takes of what it may, row by row, as shares: one is all.
//!
//! | rows | of |
//! |---|---|
//! | those of [`PathJudge`] | what the vehicle has left along a path; none under the paper's law |
//! | squares of speed, accelerations, jerk, snap and the heading's two | `[reference_bounds]`, where it binds |
//! | the square of the speed | the speed that the points are to be passed with at most |
//!
//! A search needs the shares' slopes, and shares without edges ([`Sloped`]); what certifies is the exact ones, at every
//! instant.

use super::piece::Motion;
use super::sloped::Sloped;
use crate::judge::judge;
use crate::trajectory::stretch;
use crate::trajectory::vehicle::Vehicle;
use controller_core::certificate::path::along::MaxShare;
use controller_core::certificate::path::{self, PathJudge, PathRow};
use controller_core::configuration::Configuration;
use controller_core::reference::ReferenceBounds;
use controller_core::reference::knot::Knot;

const JUDGED_ROWS: usize = PathRow::ALL.len();
/// Rows of a motion.
pub const ROW_COUNT: usize = JUDGED_ROWS + ReferenceBounds::COUNT + 1;
/// What the rows depend on: velocity, acceleration, jerk and snap along x, y and z, and the heading's first two
/// derivatives.
pub const VARIABLE_COUNT: usize = 14;
const HEADING_VARIABLE: usize = 12;
/// The share of the bounds that is used; the rest is for rounding.
const BOUNDS_SHARE: f64 = 0.9995;

/// What motions may take.
#[derive(Debug, Clone)]
pub struct Limits {
    /// What the vehicle has left, if its law is the extended one.
    judges: Option<Judges>,
    /// What bounds it besides; infinite where nothing does.
    bounds: ReferenceBounds,
}

/// One judge in numbers that are exact, that have no edges, and that have slopes.
type Judges = (PathJudge, PathJudge<Sloped<0>>, PathJudge<Sloped<VARIABLE_COUNT>>);

fn judges(configuration: &Configuration, force_kept: f32) -> Option<Judges> {
    let exact = judge(configuration, force_kept)?;
    Some((exact, judge(configuration, force_kept)?, judge(configuration, force_kept)?))
}

impl Limits {
    /// Those of a vehicle; the heading keeps within its bounds in any case, all else where the file has them.
    pub fn for_vehicle(vehicle: &Vehicle) -> Self {
        let Vehicle { configuration, has_bounds, force_kept } = vehicle;
        let bounds = *configuration.bounds();
        let judges = judges(configuration, *force_kept);
        if judges.is_none() || *has_bounds {
            return Self { judges, bounds };
        }
        let ReferenceBounds { heading_rate, heading_second_derivative, .. } = bounds;
        let nothing = ReferenceBounds::from_values([f32::INFINITY; ReferenceBounds::COUNT]);
        Self { judges, bounds: ReferenceBounds { heading_rate, heading_second_derivative, ..nothing } }
    }

    /// What bounds a path besides the vehicle.
    pub fn bounds(&self) -> &ReferenceBounds {
        &self.bounds
    }

    /// The shares of a motion that may have a `speed`, m/s.
    pub fn shares(&self, motion: &Motion, speed: f64) -> [f64; ROW_COUNT] {
        let judge = self.judges.as_ref().map(|(_, judge, _)| judge);
        self.rows(judge, motion, speed).map(|share| share.value)
    }

    /// The same with their slopes.
    pub fn sloped(&self, motion: &Motion, speed: f64) -> [Sloped<VARIABLE_COUNT>; ROW_COUNT] {
        self.rows(self.judges.as_ref().map(|(_, _, judge)| judge), motion, speed)
    }

    fn rows<const N: usize>(
        &self,
        judge: Option<&PathJudge<Sloped<N>>>,
        motion: &Motion,
        speed: f64,
    ) -> [Sloped<N>; ROW_COUNT] {
        let variable = |order: usize, axis: usize| {
            let place = if axis == 3 { HEADING_VARIABLE + order - 1 } else { 3 * (order - 1) + axis };
            Sloped::variable(motion[order][axis], place)
        };
        let [velocity, acceleration, jerk, snap] =
            [1, 2, 3, 4].map(|order| [0, 1, 2].map(|axis| variable(order, axis)));
        let [heading_rate, heading_acceleration] = [1, 2].map(|order| variable(order, 3));
        let mut rows = [Sloped::from(0.0); ROW_COUNT];
        let (judged, others) = rows.split_at_mut(JUDGED_ROWS);
        if let Some(judge) = judge {
            judged.copy_from_slice(
                &judge.shares(&path::PathMotion { velocity, acceleration, jerk, snap, heading_rate }).each,
            );
        }
        let square = |parts: &[Sloped<N>]| parts.iter().fold(Sloped::from(0.0), |sum, part| sum + *part * *part);
        let turned = heading_rate * heading_rate;
        let squares = [
            square(&velocity[..2]),
            square(&acceleration[..2]),
            square(&acceleration[2..]),
            square(&jerk),
            square(&snap),
            turned,
            square(&[heading_acceleration, turned]),
        ];
        let all = squares.into_iter().chain([square(&velocity)]);
        let bounds = self.bounds.values().map(f64::from).into_iter().chain([speed]);
        for ((row, square), bound) in others.iter_mut().zip(all).zip(bounds) {
            *row = square * (1.0 / (bound * bound));
        }
        rows
    }

    /// Whether a path takes no more than it may, at any instant.
    pub fn allow(&self, knots: &[Knot]) -> bool {
        let Ok(Some(path)) = stretch::path(knots) else { return false };
        let end = knots.last().map_or(0, |last| last.time_us);
        let is_bounded =
            stretch::taken(knots).is_ok_and(|taken| stretch::stretch(&taken, &self.bounds) <= BOUNDS_SHARE);
        let fits = |judge: &PathJudge| MaxShare::along(judge, &path, end).share < 1.0;
        is_bounded && self.judges.as_ref().is_none_or(|(judge, ..)| fits(judge))
    }
}
