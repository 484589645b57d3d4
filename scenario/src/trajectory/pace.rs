//! Times for points that come without: as short as the bounds allow, on a path that does not swing out.
//!
//! Through the points goes the smoothest path ([`controller_core::reference::spline`]). Its shape depends on the shares
//! that the legs have of the whole time, not on that time. Two things are decided:
//!
//! - *The corridor.* A leg that leaves it, a distance around the straight line between its two points, gets another
//!   point in its middle, until none does. Such points are passed like any other.
//! - *The pace.* Legs that use little of the bounds get shorter, those that use most get longer, as long as the whole
//!   becomes shorter by that. Then all times are stretched so that the bounds just hold.

use super::stretch::{stretch, taken};
use controller_core::error::ParameterError;
use controller_core::reference::ReferenceBounds;
use controller_core::reference::knot::{Knot, REST};
use controller_core::reference::segment::Segment;
use controller_core::reference::spline::{self, Stage};
use nalgebra::Vector3;

/// The share of the bounds that is used; the rest is for rounding.
const USED: f64 = 0.9995;
/// How often legs are halved, paces are changed, and by which power of its use a leg changes.
const HALVINGS: u32 = 8;
const CHANGES: u32 = 40;
const POWER: f64 = 0.35;
/// Places looked at on each leg.
const PLACES: u32 = 32;

/// A point without a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// m, world.
    pub position: Vector3<f64>,
    /// rad.
    pub heading: f64,
}

/// Knots through `points`, of which no two neighbours are equal, inside `corridor`, m, and `allowed`; and which of the
/// knots are the points.
///
/// # Errors
/// If a derivative leaves the range of the law.
pub fn paced(
    points: &[Point],
    corridor: f64,
    allowed: &ReferenceBounds,
) -> Result<(Vec<Knot>, Vec<usize>), ParameterError> {
    let mut legs = Legs::new(points);
    for _ in 0..HALVINGS {
        if !legs.halve(corridor) {
            break;
        }
    }
    let mut best = legs.stretched(allowed)?;
    for _ in 0..CHANGES {
        let mut changed = best.clone();
        changed.change(allowed)?;
        let changed = changed.stretched(allowed)?;
        if changed.duration() > 0.999 * best.duration() || changed.leaving(corridor).is_some() {
            break;
        }
        best = changed;
    }
    let knots = best.knots();
    let named = (0..knots.len()).filter(|i| best.named[*i]).collect();
    Ok((knots, named))
}

/// The points, with those in between, and how long each leg takes, s.
#[derive(Debug, Clone)]
struct Legs {
    points: Vec<Point>,
    named: Vec<bool>,
    durations: Vec<f64>,
}

impl Legs {
    /// At first a leg takes as long as it is, and the first and the last half as long again: there the path is at rest.
    fn new(points: &[Point]) -> Self {
        let turn = |pair: &[Point]| (pair[1].heading - pair[0].heading).sin().abs();
        let long = |pair: &[Point]| (pair[1].position - pair[0].position).norm() + turn(pair);
        let mut durations: Vec<f64> = points.windows(2).map(long).collect();
        let last = durations.len().saturating_sub(1);
        for end in [0, last] {
            if let Some(duration) = durations.get_mut(end) {
                *duration *= 1.5;
            }
        }
        Self { points: points.to_vec(), named: vec![true; points.len()], durations }
    }

    fn duration(&self) -> f64 {
        self.durations.iter().sum()
    }

    fn knots(&self) -> Vec<Knot> {
        let times = std::iter::once(0.0).chain(self.durations.iter().scan(0.0, |time, duration| {
            *time += duration;
            Some(*time)
        }));
        let mut knots: Vec<Knot> = times
            .zip(&self.points)
            .map(|(time, point)| Knot {
                time_us: (time * 1e6).round() as u64,
                position: point.position,
                heading: point.heading,
                derivatives: REST,
            })
            .collect();
        spline::solve(&mut knots, &mut vec![Stage::EMPTY; self.points.len()]);
        knots
    }

    /// The first legs that leave the corridor, if one does.
    fn leaving(&self, corridor: f64) -> Option<Vec<usize>> {
        let leaving: Vec<usize> = self
            .knots()
            .windows(2)
            .enumerate()
            .filter(|(_, pair)| swing(&pair[0], &pair[1]) > corridor)
            .map(|(leg, _)| leg)
            .collect();
        (!leaving.is_empty()).then_some(leaving)
    }

    /// Halves each leg that leaves the corridor; whether one did.
    fn halve(&mut self, corridor: f64) -> bool {
        let Some(leaving) = self.leaving(corridor) else { return false };
        for leg in leaving.into_iter().rev() {
            let (from, to) = (self.points[leg], self.points[leg + 1]);
            let turn = (to.heading - from.heading + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU);
            let turn = turn - std::f64::consts::PI;
            let middle = Point { position: (from.position + to.position) / 2.0, heading: from.heading + turn / 2.0 };
            self.points.insert(leg + 1, middle);
            self.named.insert(leg + 1, false);
            self.durations[leg] /= 2.0;
            self.durations.insert(leg, self.durations[leg]);
        }
        true
    }

    /// Makes each leg's duration a little more like what the bounds ask of it.
    fn change(&mut self, allowed: &ReferenceBounds) -> Result<(), ParameterError> {
        let knots = self.knots();
        for (duration, pair) in self.durations.iter_mut().zip(knots.windows(2)) {
            let own = taken(pair)?;
            *duration *= stretch(&own, allowed).max(0.1).powf(POWER);
        }
        Ok(())
    }

    /// With all durations stretched until the bounds just hold.
    fn stretched(mut self, allowed: &ReferenceBounds) -> Result<Self, ParameterError> {
        // Times are whole microseconds: stretched first to where those are fine enough, then exactly.
        for _ in 0..3 {
            let factor = stretch(&taken(&self.knots())?, allowed) / USED;
            self.durations.iter_mut().for_each(|duration| *duration *= factor);
        }
        Ok(self)
    }
}

/// How far the way between two knots is from the straight line between them, m.
fn swing(from: &Knot, to: &Knot) -> f64 {
    let segment = Segment::between(from, to);
    let (straight, time) = (to.position - from.position, to.time_us - from.time_us);
    let square = straight.norm_squared();
    let distances = (1..PLACES).map(|place| {
        let at = segment.at(from.time_us + time * u64::from(place) / u64::from(PLACES)).position.map(f64::from);
        let gone = at - from.position;
        let along = if square > 0.0 { (gone.dot(&straight) / square).clamp(0.0, 1.0) } else { 0.0 };
        (gone - straight * along).norm()
    });
    distances.fold(0.0, f64::max)
}
