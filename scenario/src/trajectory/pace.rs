//! Times for points that come without: the quickest path within a corridor that the limits allow.
//!
//! Points near the straight line between others are passed near ([`merge`]), all others exactly. The search
//! ([`quickest`]) begins at rest at each of these, with one piece for each leg; then each is split, and it goes
//! on, at last with more places. What it finds is stretched in time until it certifies at every instant.
//!
//! A search may end in a local optimum. But a path in a narrower corridor is one in a wider one, and a slower one is
//! one below a higher speed: so the same is done for all of [`SERIES_PER_DECADE`] below what is given, and the quickest
//! is kept.

mod blocks;
mod equations;
mod hull;
pub mod limits;
pub mod merge;
mod piece;
mod places;
mod quickest;
mod sloped;
mod way;

use controller_core::reference::knot::Knot;
use limits::PathLimits;
use merge::{Leg, Point, merged};
use nalgebra::Vector3;
use piece::PiecePlace;
use quickest::Search;
use std::ops::ControlFlow;
use way::Way;

/// Corridors and speeds, times a power of ten, m and m/s. A path keeps to the widest corridor of these that is no wider
/// than what is given, so that a wider one never takes longer.
const SERIES_PER_DECADE: [f64; 5] = [1.0, 2.0, 3.0, 5.0, 7.0];
/// The narrowest that is tried in place of a wider one.
const CORRIDOR_MIN_M: f64 = 0.05;
/// The minimum power of ten, where what is given is no less.
const SERIES_POWER_MIN: i32 = -3;
/// A search through more of them would take minutes.
pub const LEGS_MAX: usize = 300;
/// The share of corridor and speed that the search uses, for what happens between the places where it looks; and of the
/// corridor with one piece for each leg.
const CORRIDOR_AND_SPEED_SHARE: f64 = 0.99;
const FIRST_CORRIDOR_SHARE: f64 = 0.6;
/// What the barrier may hold back, as a share of the duration: at first, and at the end of each search.
const BARRIER_GAP_SHARES: [f64; 4] = [0.2, 0.03, 0.01, 0.002];
/// The places of a piece at which the first two searches and the last look at rows.
const PLACES_PER_PIECE: [usize; 2] = [16, 32];
/// How much of its duration a path may lose in the second search, and in the last: one that has no hope is left.
const IMPROVABLE_DURATION_SHARES: [f64; 2] = [0.8, 0.98];
/// Legs that take longer than so many times the mean get three pieces, the others two.
const LONG_LEG_RATIO: f64 = 1.5;
/// By how much a path is stretched at once to be inside the limits, and how often at most.
const LIMITS_STRETCH: f64 = 1.02;
const LIMITS_STRETCHES_MAX: u32 = 30;
/// The share of its speed with which a path begins to be stretched until it certifies, and by how much at once, in how
/// many parts.
const FIRST_SPEED_SHARE: f64 = 0.98;
const CERTIFYING_STRETCH: f64 = 1.01;
const CERTIFYING_STRETCH_PARTS: i32 = 8;
const CERTIFYING_STRETCHES_MAX: i32 = 60;

/// A path, and when each point is passed, s.
#[derive(Debug, Clone, PartialEq)]
pub struct Paced {
    /// How it is passed along.
    pub knots: Vec<Knot>,
    /// s, of each point.
    pub times: Vec<f64>,
}

/// Why there is no path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Problem {
    /// So many legs, more than [`LEGS_MAX`].
    Legs(usize),
    /// Even at rest the limits are exceeded.
    Rest,
}

/// The quickest path through `points`, of which no two neighbours are equal, that was found with a `speed` at most,
/// m/s.
///
/// # Errors
/// Why there is none.
pub fn paced(points: &[Point], corridor: f64, speed: f64, limits: &PathLimits) -> Result<Paced, Problem> {
    let mut tries =
        Tries { points, limits, searches: PLACES_PER_PIECE.map(|places| Search::new(limits, places)), best: None };
    let corridors = below(corridor, CORRIDOR_MIN_M);
    let widest = corridors.first().copied().unwrap_or(corridor);
    let (kept, legs) = merged(points, widest);
    if legs.len() > LEGS_MAX {
        return Err(Problem::Legs(legs.len()));
    }
    if legs.is_empty() {
        let way = Way::resting(points[0].place);
        return Ok(Paced { knots: way.knots(), times: vec![0.0] });
    }
    let _ = corridors.iter().try_for_each(|corridor| tries.make(*corridor, speed));
    let length = legs.iter().map(Leg::length).sum::<f64>();
    let mut slower = below(speed, 0.0).into_iter().filter(|slower| *slower < speed);
    let _ = slower.try_for_each(|slower| match length < slower * tries.shortest() {
        true if tries.is_idle(slower) => ControlFlow::Continue(()),
        true => tries.make(widest, slower),
        false => ControlFlow::Break(()),
    });
    let stopping = |tries: &Tries| tries.certified(&tries.searches[0].stopping(legs)?);
    let found = tries.best.take().or_else(|| Some((stopping(&tries)?, kept)));
    let (way, kept) = found.ok_or(Problem::Rest)?;
    Ok(Paced { knots: way.knots(), times: times(&way, points, &kept) })
}

/// Those of [`SERIES_PER_DECADE`] from `min` to `max`, descending; `max` itself where there is none.
fn below(max: f64, min: f64) -> Vec<f64> {
    let power = max.log10().floor() as i32;
    let all = (power.min(SERIES_POWER_MIN)..=power)
        .flat_map(|power| SERIES_PER_DECADE.map(|number| number * 10.0_f64.powi(power)));
    let mut found: Vec<f64> = all.filter(|number| (0.999 * min..=1.001 * max).contains(number)).collect();
    found.reverse();
    if found.is_empty() { vec![max] } else { found }
}

/// What has been found.
struct Tries<'a> {
    points: &'a [Point],
    limits: &'a PathLimits,
    searches: [Search<'a>; 2],
    /// The quickest, and which points it passes exactly.
    best: Option<(Way, Vec<usize>)>,
}

impl Tries<'_> {
    /// s.
    fn shortest(&self) -> f64 {
        self.best.as_ref().map_or(f64::INFINITY, |(way, _)| way.duration())
    }

    /// Whether another `speed`, m/s, would change nothing: it is far above what the best has.
    fn is_idle(&self, speed: f64) -> bool {
        self.best.as_ref().is_some_and(|(way, _)| self.searches[0].leaves_idle(way, speed))
    }

    /// Looks for a quicker one in this corridor, with this speed; breaks where there is no hope of one, nor in narrower
    /// corridors or with lower speeds.
    fn make(&mut self, corridor: f64, speed: f64) -> ControlFlow<()> {
        let (kept, mut legs) = merged(self.points, corridor);
        legs.iter_mut().for_each(|leg| leg.speed = leg.speed.min(speed));
        let Some(way) = self.searched(&legs) else { return ControlFlow::Break(()) };
        let found = self.certified(&Way { legs, ..way });
        if let Some(way) = found.filter(|way| way.duration() < self.shortest()) {
            self.best = Some((way, kept));
        }
        ControlFlow::Continue(())
    }

    /// The quickest along `legs`, from rest at each of their ends; none where there is no hope that it is the best.
    fn searched(&self, legs: &[Leg]) -> Option<Way> {
        let [begin, one, two, end] = BARRIER_GAP_SHARES;
        let [coarse, fine] = &self.searches;
        let hopeless = IMPROVABLE_DURATION_SHARES.map(|hope| self.shortest() / hope);
        let narrowed = |share: f64| {
            let narrowed =
                |leg: &Leg| Leg { corridor: leg.corridor * share, speed: leg.speed * CORRIDOR_AND_SPEED_SHARE, ..*leg };
            legs.iter().map(narrowed).collect::<Vec<Leg>>()
        };
        let split = |way: Way| {
            let long = LONG_LEG_RATIO * way.duration() / legs.len() as f64;
            Way {
                legs: narrowed(CORRIDOR_AND_SPEED_SHARE),
                ..way.split(|duration| if duration > long { 3 } else { 2 })
            }
        };
        let stopping = coarse.stopping(narrowed(FIRST_CORRIDOR_SHARE))?;
        let way = coarse.descend(stopping.clone(), [begin, one]);
        if way.duration() > hopeless[0] {
            return None;
        }
        let way = match within(coarse, &split(way)) {
            Some(way) => coarse.descend(way, [one, two]),
            None => coarse.descend(within(coarse, &split(stopping))?, [begin, two]),
        };
        if way.duration() > hopeless[1] {
            return None;
        }
        Some(within(fine, &way).map_or(way, |way| fine.descend(way, [two, end])))
    }

    /// `way` in the shortest time in which it certifies at every instant; none where it leaves its corridor.
    fn certified(&self, way: &Way) -> Option<Way> {
        let holds = |parts: i32| {
            let stretch =
                FIRST_SPEED_SHARE * CERTIFYING_STRETCH.powf(f64::from(parts) / f64::from(CERTIFYING_STRETCH_PARTS));
            let way = way.clone().stretched(stretch);
            (way.keeps_to_its_legs() && self.limits.allow(&way.knots())).then_some(way)
        };
        let (mut long, mut found) = (0..CERTIFYING_STRETCHES_MAX)
            .find_map(|i| Some((CERTIFYING_STRETCH_PARTS * i, holds(CERTIFYING_STRETCH_PARTS * i)?)))?;
        let mut short = long - CERTIFYING_STRETCH_PARTS;
        while long - short > 1 {
            let middle = (short + long) / 2;
            match holds(middle) {
                Some(way) => (long, found) = (middle, way),
                None => short = middle,
            }
        }
        Some(found)
    }
}

/// `way`, as much more slowly as it takes to be inside; none where no time helps.
fn within(search: &Search, way: &Way) -> Option<Way> {
    let slower = |times: u32| way.clone().stretched(LIMITS_STRETCH.powi(times as i32));
    (0..LIMITS_STRETCHES_MAX).map(slower).find(|way| search.most(way) < 0.999)
}

/// When each point is passed, s: those between two that are kept, where the path is nearest to them.
fn times(way: &Way, points: &[Point], kept: &[usize]) -> Vec<f64> {
    const PLACES_CHECKED_PER_PIECE: usize = 64;
    let places: Vec<PiecePlace> = (0..=PLACES_CHECKED_PER_PIECE)
        .map(|place| PiecePlace::new(place as f64 / PLACES_CHECKED_PER_PIECE as f64))
        .collect();
    let mut times = Vec::with_capacity(points.len());
    let (mut start, mut time) = (0.0, 0.0_f64);
    let mut pieces = way.pieces.iter().enumerate().peekable();
    for (leg, pair) in kept.windows(2).enumerate() {
        let mut along: Vec<(f64, Vector3<f64>)> = Vec::new();
        while let Some((piece, (_, duration))) = pieces.next_if(|(_, (own, _))| *own == leg) {
            along.extend(places.iter().enumerate().map(|(number, place)| {
                (start + duration * number as f64 / PLACES_CHECKED_PER_PIECE as f64, way.motion(piece, place)[0].xyz())
            }));
            start += duration;
        }
        times.push(time);
        for point in &points[pair[0] + 1..pair[1]] {
            let later = along.iter().filter(|(at, _)| *at >= time);
            let distances = later.map(|(at, place)| (at, (place - point.place.xyz()).norm()));
            time = distances.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(time, |(at, _)| *at);
            times.push(time);
        }
        time = start;
    }
    times.push(time);
    times
}

#[cfg(test)]
mod tests;
