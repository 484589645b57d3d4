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

/// How far the vehicle comes from a hover in the worst gusts of a tube, with lag and moments of inertia as they are and
/// at both ends; and in gusts that a search finds by climbing from each of these.
///
/// # Errors
/// If a signal came.
pub fn beside(flyer: &Flyer, tube: &Tube, orders: &Orders, work: &Work) -> Result<Beside, Interrupted> {
    let gusts = [Axis::LateralX, Axis::LateralY, Axis::Vertical].map(|axis| tube.worst_gust(axis));
    beside_gusts(flyer, gusts, orders, work)
}

/// The same for gusts of -1 or 1 for each tick, oldest first.
pub(super) fn beside_gusts(
    flyer: &Flyer,
    gusts: [&[f64]; 3],
    orders: &Orders,
    work: &Work,
) -> Result<Beside, Interrupted> {
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
        let ticks = gusts[begin.gust.axis].len();
        let flown =
            |start: &Start| farthest(flyer, start, (0..ticks).map(|tick| start.gust.at(tick as f64 * flyer.period())));
        let alone = flown(begin);
        let (mut best, mut distance) = (begin.clone(), alone);
        for _ in 0..each {
            work.count()?;
            let tried = best.mutated(flyer.sets(), flyer.vehicle(), &mut drawn, CHANGE_SCALE);
            let tried = Start { lag: tried.lag, inertia: tried.inertia, gust: tried.gust, ..Start::at_rest() };
            let after = flown(&tried);
            if after >= distance {
                (best, distance) = (tried, after);
            }
        }
        Ok([alone, distance])
    };
    let distances: Vec<[f64; 2]> = begins.par_iter().enumerate().map(climb).collect::<Result<_, _>>()?;
    let [alone, searched] = distances.into_iter().fold([0.0_f64; 2], |[a, b], [c, d]| [a.max(c), b.max(d)]);

    // All end together: the last gust counts most.
    let ticks = gusts.map(<[f64]>::len).into_iter().max().unwrap_or(0);
    let at = |axis: usize, tick: usize| {
        let waits = ticks - gusts[axis].len();
        tick.checked_sub(waits).and_then(|tick| gusts[axis].get(tick)).copied().unwrap_or(0.0)
    };
    let all = || (0..ticks).map(|tick| Vector3::from_fn(|axis, _| at(axis, tick)));
    let together = corners(flyer).map(|start| farthest(flyer, &start, all())).fold(0.0, f64::max);
    Ok(Beside { alone, searched, together })
}

/// How large a change is.
const CHANGE_SCALE: f64 = 0.02;

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
