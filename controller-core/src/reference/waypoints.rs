//! Polynomials through given points, smooth to snap.
//!
//! At rest before the first point, after the last, and between two equal points in a row, which is how to wait; through
//! the others without stopping, on the path of degree 9 that minimises the squared fifth derivative between one rest
//! and the next (`reference::spline`). A heading belongs to every point; between two points it
//! turns the shorter way round, an exact half turn counter-clockwise, as smoothly as the position moves.
//!
//! World frame; m, s, rad. Bounds come from the polynomials' convex hulls (`reference::bernstein`), so they hold at
//! every instant, not only at sampled ones; they are tight within 1e-3 unless a segment's control points lie a hundred
//! times further out than its curve does.
//!
//! Such a path may swing out between points, most of all where legs differ much in duration, because bending a long one
//! costs little. [`Waypoints::inside`] takes another one that never does (`reference::inside`), at the cost of more
//! acceleration. What neither can do: choose the times. About 10 kB in memory.

use super::inside;
use super::segment::{Anchor, Segment, Suprema};
use super::spline::{self, Derivatives, REST, Span};
use super::{DERIVATIVE_RANGE, Reference, ReferenceBounds, Trajectory, outwards, phase};
use crate::error::{ParameterError, Reason, require};
use crate::heading::Heading;
use crate::math;
use crate::state::STATE_RANGE;
use core::f64::consts::{PI, TAU};
use nalgebra::{Vector3, Vector4};

/// Largest number of waypoints.
pub const CAPACITY: usize = spline::SEGMENTS + 1;

/// Largest time of a waypoint, s: beyond 285 years a double no longer counts microseconds.
pub const GREATEST_TIME: f64 = 9e9;

/// Turns this close (rad) to half a turn count as exactly half: degrees become radians with errors of 1e-16.
const HALF_TURN_ROOM: f64 = 1e-9;

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

const TIME: [&str; CAPACITY] = names!("t");
const POSITION: [&str; CAPACITY] = names!("position");
const HEADING: [&str; CAPACITY] = names!("heading_deg");

/// A waypoint in the units flown.
struct Knot {
    time_us: u64,
    position: Vector3<f64>,
    heading: f64,
}

impl Knot {
    fn new(
        point: &Waypoint,
        time: &'static str,
        position: &'static str,
        heading: &'static str,
    ) -> Result<Self, ParameterError> {
        require(point.time.is_finite(), time, Reason::NotFinite)?;
        require(point.time < GREATEST_TIME, time, Reason::NotBelow(GREATEST_TIME as f32))?;
        for component in point.position {
            require(component.is_finite(), position, Reason::NotFinite)?;
            require(component.abs() < f64::from(STATE_RANGE), position, Reason::NotBelow(STATE_RANGE))?;
        }
        require(point.heading.is_finite(), heading, Reason::NotFinite)?;
        let time_us = math::round(point.time * 1e6) as u64;
        Ok(Self { time_us, position: Vector3::from(point.position), heading: point.heading })
    }

    fn anchor(&self) -> Anchor {
        Anchor { position: self.position.map(|x| x as f32), phase: phase::turns(self.heading) }
    }

    /// The way to the next point, heading the shorter way round.
    fn span(&self, next: &Self) -> Span {
        let difference = next.position - self.position;
        let turn = next.heading - self.heading;
        let shorter = turn - TAU * math::round(turn / TAU);
        let shorter = if shorter <= HALF_TURN_ROOM - PI { shorter + TAU } else { shorter };
        Span {
            duration: next.time_us.saturating_sub(self.time_us) as f64 * 1e-6,
            difference: Vector4::new(difference.x, difference.y, difference.z, shorter),
        }
    }
}

/// A reference through waypoints.
#[derive(Debug, Clone, PartialEq)]
pub struct Waypoints {
    segments: heapless::Vec<Segment, { spline::SEGMENTS }>,
    last: Anchor,
    bounds: ReferenceBounds,
}

impl Waypoints {
    /// The smoothest path through `points`, times strictly increasing from zero; a single point is a hover.
    ///
    /// # Errors
    /// Names the field, as in the scenario file: no point or more than [`CAPACITY`]; a number that is not finite or out
    /// of range; a first time that is not zero, or one that is not a microsecond later than the one before; points so
    /// far apart in so short a time that a derivative leaves the range of the law.
    pub fn new(points: &[Waypoint]) -> Result<Self, ParameterError> {
        Self::through(points, spline::solve)
    }

    /// As [`Self::new`], on a path that stays on every leg inside the box of the leg's two points.
    ///
    /// # Errors
    /// As [`Self::new`]'s.
    pub fn inside(points: &[Waypoint]) -> Result<Self, ParameterError> {
        Self::through(points, inside::solve)
    }

    fn through(points: &[Waypoint], solve: Solve) -> Result<Self, ParameterError> {
        let mut knots: heapless::Vec<Knot, CAPACITY> = heapless::Vec::new();
        let names = TIME.into_iter().zip(POSITION).zip(HEADING);
        for (point, ((time, position), heading)) in points.iter().zip(names) {
            let knot = Knot::new(point, time, position, heading)?;
            match knots.last() {
                None => require(knot.time_us == 0 && point.time > -1e-6, time, Reason::NotZero)?,
                Some(before) => require(knot.time_us > before.time_us, time, Reason::NotIncreasing)?,
            }
            // There is room: the names ran out first.
            let _ = knots.push(knot);
        }
        require(points.len() <= CAPACITY, "reference.points", Reason::TooMany(CAPACITY))?;
        let too_few = ParameterError { field: "reference.points", reason: Reason::TooFew(1) };
        let last = knots.last().ok_or(too_few)?.anchor();

        let segments = connect(&knots, solve);
        let bounds = bounds(&segments)?;
        Ok(Self { segments, last, bounds })
    }
}

/// How to pass the points between legs that begin and end at rest.
type Solve = fn(&[Span]) -> heapless::Vec<Derivatives, { spline::SEGMENTS }>;

/// The polynomial pieces between the knots. All storage has room for [`CAPACITY`] of them.
fn connect(knots: &[Knot], solve: Solve) -> heapless::Vec<Segment, { spline::SEGMENTS }> {
    let pairs = || knots.iter().zip(knots.iter().skip(1));
    let mut spans: heapless::Vec<Span, { spline::SEGMENTS }> = heapless::Vec::new();
    for (knot, next) in pairs() {
        let _ = spans.push(knot.span(next));
    }
    let mut ends: heapless::Vec<Derivatives, { spline::SEGMENTS }> = heapless::Vec::new();
    // Between two waits, or the ends, one run that starts and stops at rest; a wait is a run of its own.
    for run in spans.chunk_by(|span, next| !span.waits() && !next.waits()) {
        for end in solve(run).into_iter().chain(core::iter::once(REST)) {
            let _ = ends.push(end);
        }
    }
    let mut segments = heapless::Vec::new();
    let mut start = &REST;
    for (((knot, next), span), end) in pairs().zip(&spans).zip(&ends) {
        let times = (knot.time_us, next.time_us);
        let _ = segments.push(Segment::new(times, knot.anchor(), span.difference, start, end));
        start = end;
    }
    segments
}

/// The bounds of all segments together.
fn bounds(segments: &[Segment]) -> Result<ReferenceBounds, ParameterError> {
    let mut suprema = Suprema::new();
    for segment in segments {
        require(segment.reach() < STATE_RANGE, "reference.points (position)", Reason::NotBelow(STATE_RANGE))?;
        suprema.include(segment);
    }
    let bounds = ReferenceBounds {
        horizontal_speed: outwards(suprema.horizontal_speed.bound_when_evaluated()),
        horizontal_acceleration: outwards(suprema.horizontal_acceleration.bound_when_evaluated()),
        vertical_acceleration: outwards(suprema.vertical_acceleration.bound_when_evaluated()),
        jerk: outwards(suprema.jerk.bound_when_evaluated()),
        snap: outwards(suprema.snap.bound_when_evaluated()),
        heading_rate: outwards(suprema.heading_rate.bound_when_evaluated()),
        heading_second_derivative: outwards(suprema.heading_second_derivative.bound_when_evaluated()),
    };
    for (bound, field) in [
        (bounds.horizontal_speed, "reference.points (horizontal speed)"),
        (bounds.horizontal_acceleration, "reference.points (horizontal acceleration)"),
        (bounds.vertical_acceleration, "reference.points (vertical acceleration)"),
        (bounds.jerk, "reference.points (jerk)"),
        (bounds.snap, "reference.points (snap)"),
        (bounds.heading_rate, "reference.points (heading rate)"),
        (bounds.heading_second_derivative, "reference.points (second derivative of the heading)"),
    ] {
        require(bound < DERIVATIVE_RANGE, field, Reason::NotBelow(DERIVATIVE_RANGE))?;
    }
    Ok(bounds)
}

impl Trajectory for Waypoints {
    fn at(&self, time_us: u64) -> Reference {
        match self.segments.iter().find(|segment| time_us < segment.end_us()) {
            Some(segment) => segment.at(time_us),
            None => Reference {
                position: self.last.position,
                velocity: Vector3::zeros(),
                acceleration: Vector3::zeros(),
                jerk: Vector3::zeros(),
                snap: Vector3::zeros(),
                heading: Heading::from_phase(self.last.phase, 0.0, 0.0),
            },
        }
    }

    fn bounds(&self) -> ReferenceBounds {
        self.bounds
    }
}
