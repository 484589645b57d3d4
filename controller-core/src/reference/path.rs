//! A path of polynomial pieces from knot to knot, of any length: its segments lie wherever its user has room.
//!
//! At rest on the last knot afterwards. Bounds come from the pieces' convex hulls (`bernstein`), so they hold at
//! every instant, not only at sampled ones; they are tight within 1e-3 unless a piece's control points lie
//! a hundred times further out than its curve does.

use super::knot::{Anchor, Knot};
use super::segment::{Segment, Suprema};
use super::{DERIVATIVE_RANGE, Reference, ReferenceBounds, Trajectory, outwards};
use crate::error::{ParameterError, Reason, require};
use crate::heading::Heading;
use crate::state::STATE_RANGE;
use nalgebra::Vector3;

/// A reference along `segments`, which follow each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Path<S> {
    segments: S,
    last: Anchor,
    bounds: ReferenceBounds,
}

impl<S: AsRef<[Segment]>> Path<S> {
    /// The path along [`Segment::between`]s, each of which begins where the one before ends, the last of them at
    /// `last`. Without segments it is a hover there.
    ///
    /// # Errors
    /// Names the derivative that leaves the range of the law.
    pub fn new(segments: S, last: &Knot) -> Result<Self, ParameterError> {
        let bounds = bounds(segments.as_ref())?;
        Ok(Self { segments, last: last.anchor(), bounds })
    }
}

/// The bounds of all segments together.
fn bounds(segments: &[Segment]) -> Result<ReferenceBounds, ParameterError> {
    let mut suprema = Suprema::new();
    for segment in segments {
        require(segment.reach() < STATE_RANGE, "reference (position)", Reason::NotBelow(STATE_RANGE))?;
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
        (bounds.horizontal_speed, "reference (horizontal speed)"),
        (bounds.horizontal_acceleration, "reference (horizontal acceleration)"),
        (bounds.vertical_acceleration, "reference (vertical acceleration)"),
        (bounds.jerk, "reference (jerk)"),
        (bounds.snap, "reference (snap)"),
        (bounds.heading_rate, "reference (heading rate)"),
        (bounds.heading_second_derivative, "reference (second derivative of the heading)"),
    ] {
        require(bound < DERIVATIVE_RANGE, field, Reason::NotBelow(DERIVATIVE_RANGE))?;
    }
    Ok(bounds)
}

impl<S: AsRef<[Segment]>> Trajectory for Path<S> {
    fn at(&self, time_us: u64) -> Reference {
        let segments = self.segments.as_ref();
        match segments.get(segments.partition_point(|segment| segment.end_us() <= time_us)) {
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

    fn fifth_derivative(&self, from_us: u64, to_us: u64) -> f64 {
        let segments = self.segments.as_ref();
        let first = segments.partition_point(|segment| segment.end_us() <= from_us);
        let crossed = segments.iter().skip(first).take_while(|segment| segment.start_us() <= to_us);
        crossed.map(Segment::fifth_derivative).fold(0.0, f64::max)
    }
}
