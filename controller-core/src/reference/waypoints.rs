//! Polynomials through given points, smooth to snap.
//!
//! At rest before the first point, after the last, and between two equal points in a row, which is how to wait; through
//! the others without stopping, on the path of degree 9 that minimises the squared fifth derivative between one rest
//! and the next ([`super::spline`]). A heading belongs to every point; between two points it
//! turns the shorter way round, an exact half turn counter-clockwise, as smoothly as the position moves.
//!
//! World frame; m, s, rad. At most [`POINTS_MAX`] points, without allocation; [`super::path::Path`] takes any number.
//!
//! Such a path may swing out between points, most of all where legs differ much in duration, because bending a long one
//! costs little. [`Waypoints::inside`] takes another one that never does ([`super::inside`]), at the cost of more
//! acceleration. What neither can do: choose the times. About 10 kB in memory.

use super::knot::{Knot, REST};
use super::path::Path;
use super::segment::Segment;
use super::{Reference, ReferenceBounds, Trajectory, inside, spline};
use crate::error::{ParameterError, Reason, require};
use crate::math;
use crate::state::STATE_RANGE;
use nalgebra::Vector3;

/// Largest number of waypoints.
pub const POINTS_MAX: usize = 16;

/// Largest time of a waypoint, s: beyond 285 years a double no longer counts microseconds.
pub const TIME_MAX_S: f64 = 9e9;

/// A point to pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint {
    /// When, s after the start; rounded to a microsecond.
    pub time: f64,
    /// Where, m.
    pub position: [f64; 3],
    /// Pointing where, rad, modulo a full turn.
    pub heading: f64,
}

/// The names of one field of every waypoint, for errors.
macro_rules! names {
    ($field:literal) => {
        names!($field, 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15)
    };
    ($field:literal, $($index:literal)+) => {
        [$(concat!("reference.points[", $index, "].", $field)),+]
    };
}

const TIME_FIELDS: [&str; POINTS_MAX] = names!("t");
const POSITION_FIELDS: [&str; POINTS_MAX] = names!("position");
const HEADING_FIELDS: [&str; POINTS_MAX] = names!("heading_deg");

impl Waypoint {
    /// In the units flown; not known yet how it is passed. `before` is the knot before it, or none for the first.
    ///
    /// # Errors
    /// Names one of the `fields` of time, position and heading: a number that is not finite or out of range; a first
    /// time that is not zero, or one that is not a microsecond later than the one before.
    pub fn knot(&self, before: Option<&Knot>, fields: [&'static str; 3]) -> Result<Knot, ParameterError> {
        let [time, position, heading] = fields;
        require(self.time.is_finite(), time, Reason::NotFinite)?;
        require(self.time < TIME_MAX_S, time, Reason::NotBelow(TIME_MAX_S as f32))?;
        for component in self.position {
            require(component.is_finite(), position, Reason::NotFinite)?;
            require(component.abs() < f64::from(STATE_RANGE), position, Reason::NotBelow(STATE_RANGE))?;
        }
        require(self.heading.is_finite(), heading, Reason::NotFinite)?;
        let time_us = math::round(self.time * 1e6) as u64;
        match before {
            None => require(time_us == 0 && self.time > -1e-6, time, Reason::NotZero)?,
            Some(before) => require(time_us > before.time_us, time, Reason::NotIncreasing)?,
        }
        Ok(Knot { time_us, position: Vector3::from(self.position), heading: self.heading, derivatives: REST })
    }
}

/// A reference through waypoints.
#[derive(Debug, Clone, PartialEq)]
pub struct Waypoints(Path<heapless::Vec<Segment, { POINTS_MAX - 1 }>>);

impl Waypoints {
    /// The smoothest path through `points`, times strictly increasing from zero; a single point is a hover.
    ///
    /// # Errors
    /// Names the field, as in the scenario file: no point or more than [`POINTS_MAX`]; what [`Waypoint::knot`] refuses;
    /// points so far apart in so short a time that a derivative leaves the range of the law.
    pub fn new(points: &[Waypoint]) -> Result<Self, ParameterError> {
        Self::through(points, |knots| spline::solve(knots, &mut [spline::Stage::EMPTY; POINTS_MAX]))
    }

    /// As [`Self::new`], on a path that stays on every leg inside the box of the leg's two points.
    ///
    /// # Errors
    /// As [`Self::new`]'s.
    pub fn inside(points: &[Waypoint]) -> Result<Self, ParameterError> {
        Self::through(points, inside::solve)
    }

    fn through(points: &[Waypoint], solve: impl FnOnce(&mut [Knot])) -> Result<Self, ParameterError> {
        let mut knots: heapless::Vec<Knot, POINTS_MAX> = heapless::Vec::new();
        let names = TIME_FIELDS.into_iter().zip(POSITION_FIELDS).zip(HEADING_FIELDS);
        for (point, ((time, position), heading)) in points.iter().zip(names) {
            let knot = point.knot(knots.last(), [time, position, heading])?;
            // There is room: the names ran out first.
            let _ = knots.push(knot);
        }
        require(points.len() <= POINTS_MAX, "reference.points", Reason::TooMany(POINTS_MAX))?;
        solve(&mut knots);
        let too_few = ParameterError { field: "reference.points", reason: Reason::TooFew(1) };
        let last = knots.last().ok_or(too_few)?;
        let mut segments = heapless::Vec::new();
        for (knot, next) in knots.iter().zip(knots.iter().skip(1)) {
            let _ = segments.push(Segment::between(knot, next));
        }
        Path::new(segments, last).map(Self)
    }
}

impl Trajectory for Waypoints {
    fn at(&self, time_us: u64) -> Reference {
        self.0.at(time_us)
    }

    fn bounds(&self) -> ReferenceBounds {
        self.0.bounds()
    }

    fn fifth_derivative(&self, from_us: u64, to_us: u64) -> f64 {
        self.0.fifth_derivative(from_us, to_us)
    }
}
