//! How near the vehicle stays once it is there: the worst gusts of the [proof](scenario::tube), flown beside it.

use super::flight::Flyer;
use super::gust::Gust;
use super::many::{Interrupted, Orders, Work};
use super::start::Start;
use crate::studies::campaign::draw::Drawn;
use nalgebra::Vector3;
use rayon::prelude::*;
use scenario::sampled_loop::Axis;
use scenario::tube::Tube;

/// How far the vehicle comes from a hover, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beside {
    /// In the worst gust of one axis.
    pub alone: f64,
    /// In whatever gust along one axis a search found from there.
    pub searched: f64,
    /// In the worst gusts of all axes at once: the proof does not speak of these.
    pub together: f64,
}

/// The worst gust of a tube along each axis.
#[must_use]
pub fn worst_gusts(tube: &Tube) -> [&[f64]; 3] {
    [Axis::LateralX, Axis::LateralY, Axis::Vertical].map(|axis| tube.worst_gust(axis))
}

/// How far the vehicle comes from a hover in these gusts (-1 or 1 for each tick, oldest first): with lag and moments of
/// inertia as they are, and at both ends.
#[must_use]
pub fn beside_the_tube(flyer: &Flyer, gusts: [&[f64]; 3]) -> Beside {
    let ticks = gusts.map(<[f64]>::len).into_iter().max().unwrap_or(0);
    // All end together: the last gust counts most.
    let at = |axis: usize, tick: usize| {
        let waits = ticks - gusts[axis].len();
        tick.checked_sub(waits).and_then(|tick| gusts[axis].get(tick)).copied().unwrap_or(0.0)
    };
    let mut beside = Beside { alone: 0.0, searched: 0.0, together: 0.0 };
    for start in corners(flyer) {
        for (axis, gust) in gusts.iter().enumerate() {
            let distance = farthest(flyer, &start, gust.iter().map(|share| Vector3::ith(axis, *share)));
            beside.alone = beside.alone.max(distance);
        }
        let all = (0..ticks).map(|tick| Vector3::from_fn(|axis, _| at(axis, tick)));
        beside.together = beside.together.max(farthest(flyer, &start, all));
    }
    Beside { searched: beside.alone, ..beside }
}

/// The greatest distance that a search finds, by climbing from each of these gusts at each corner of the tolerances.
///
/// # Errors
/// If a signal came.
pub fn searched(flyer: &Flyer, gusts: [&[f64]; 3], orders: &Orders, work: &Work) -> Result<f64, Interrupted> {
    let begins: Vec<Start> = (0..3)
        .flat_map(|axis| {
            let gust = Gust::of_ticks(axis, gusts[axis], flyer.period());
            corners(flyer).map(move |start| Start { gust: gust.clone(), ..start })
        })
        .collect();
    let each = orders.search / begins.len() as u64;
    let climb = |(number, begin): (usize, &Start)| {
        // No flight and no other climb has this number.
        let mut drawn = Drawn::new(orders.seed, u64::MAX / 2 - number as u64);
        let ticks = (begin.gust.steps.last().map_or(0.0, |step| step.from) / flyer.period()).ceil() as u64 + 100;
        let flown =
            |start: &Start| farthest(flyer, start, (0..ticks).map(|tick| start.gust.at(tick as f64 * flyer.period())));
        let (mut best, mut distance) = (begin.clone(), flown(begin));
        for _ in 0..each {
            work.count()?;
            let tried = best.mutated(flyer.sets(), flyer.vehicle(), &mut drawn, SCALE);
            let tried = Start { lag: tried.lag, inertia: tried.inertia, gust: tried.gust, ..Start::at_rest() };
            let after = flown(&tried);
            if after >= distance {
                (best, distance) = (tried, after);
            }
        }
        Ok(distance)
    };
    let distances: Vec<f64> = begins.par_iter().enumerate().map(climb).collect::<Result<_, _>>()?;
    Ok(distances.into_iter().fold(0.0, f64::max))
}

/// How large a change is.
const SCALE: f64 = 0.02;

/// At rest, with lag and moments of inertia as they are and at both ends.
fn corners(flyer: &Flyer) -> impl Iterator<Item = Start> {
    let factors = |share: f64| [1.0 - share, 1.0, 1.0 + share];
    let (lags, inertias) = (factors(flyer.sets().lag), factors(flyer.sets().inertia));
    lags.into_iter().flat_map(move |lag| {
        inertias.map(|inertia| Start { lag, inertia: Vector3::repeat(inertia), ..Start::at_rest() })
    })
}

fn farthest(flyer: &Flyer, start: &Start, gust: impl IntoIterator<Item = Vector3<f64>>) -> f64 {
    let mut farthest = 0.0_f64;
    flyer.fly(start, gust, |position| farthest = farthest.max(position.norm()));
    farthest
}
