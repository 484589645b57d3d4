//! Hill climbing for the worst start: the worst random ones change a little, and what is worse stays. Every second one
//! begins at the ends of its set: few random starts are there.
//!
//! Each climb has random numbers of its own, so that the number of threads changes nothing. A change is as large as has
//! worked lately: larger after each that made it worse, smaller after each that did not.

use super::flight::{Flyer, Outcome};
use super::many::{Interrupted, Orders, Work};
use super::start::{FLIGHT_DURATION_S, Start};
use crate::studies::campaign::draw::Drawn;
use rayon::prelude::*;

/// Climbs of a search, if it has as many flights.
const CLIMB_COUNT: u64 = 32;

/// The scale of changes at first, at least, and from one to the next.
const SCALE_START: f64 = 0.2;
const SCALE_MIN: f64 = 0.005;
const SCALE_MAX: f64 = 1.0;
const SCALE_UP: f64 = 1.5;
const SCALE_DOWN: f64 = 0.95;

/// What is to be as great as it can be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// The height lost.
    Height,
    /// The time until it is back for good.
    Time,
}

impl Wanted {
    /// m, or s; of a flight that does not arrive more than of any that does.
    #[must_use]
    pub fn of(self, outcome: &Outcome) -> f64 {
        match self {
            Self::Height => outcome.height_lost,
            Self::Time => outcome.settled_after.unwrap_or(FLIGHT_DURATION_S + outcome.distance_at_end),
        }
    }

    /// Until when its start's gust counts, s.
    #[must_use]
    pub fn until(self, outcome: &Outcome) -> f64 {
        match self {
            Self::Height => outcome.lowest_at,
            Self::Time => outcome.settled_after.unwrap_or(FLIGHT_DURATION_S),
        }
    }
}

/// The worst start that is found from those of the `random` flights, and its flight.
///
/// # Errors
/// If a signal came.
pub fn worst(
    flyer: &Flyer,
    wanted: Wanted,
    random: &[Outcome],
    orders: &Orders,
    work: &Work,
) -> Result<(Start, Outcome), Interrupted> {
    let mut ranked: Vec<(u64, &Outcome)> = (0..).zip(random).collect();
    ranked.sort_by(|(_, one), (_, other)| wanted.of(other).total_cmp(&wanted.of(one)));
    let from = |rank: u64| {
        let (number, outcome) = ranked[rank as usize % ranked.len()];
        (Start::drawn(flyer.sets(), flyer.vehicle(), orders.seed, number), *outcome)
    };
    let climbs = CLIMB_COUNT.min(orders.search);
    let climb = |climb: u64| {
        let flights = orders.search / climbs + u64::from(climb < orders.search % climbs);
        // No flight has this number: none is drawn from the same random numbers.
        let mut drawn = Drawn::new(orders.seed, u64::MAX - 2 * climb - u64::from(wanted == Wanted::Time));
        let (start, outcome) = from(climb);
        if climb % 2 == 1 && flights > 0 {
            let start = start.at_the_ends(flyer.sets());
            let outcome = work.fly(flyer, &start)?;
            return climbed(flyer, wanted, (start, outcome), flights - 1, &mut drawn, work);
        }
        climbed(flyer, wanted, (start, outcome), flights, &mut drawn, work)
    };
    let climbed: Vec<(Start, Outcome)> = (0..climbs).into_par_iter().map(climb).collect::<Result<_, _>>()?;
    let worse = |one: (Start, Outcome), other: (Start, Outcome)| {
        if wanted.of(&other.1) > wanted.of(&one.1) { other } else { one }
    };
    Ok(climbed.into_iter().fold(from(0), worse))
}

fn climbed(
    flyer: &Flyer,
    wanted: Wanted,
    (mut start, mut outcome): (Start, Outcome),
    flights: u64,
    drawn: &mut Drawn,
    work: &Work,
) -> Result<(Start, Outcome), Interrupted> {
    let mut scale = SCALE_START;
    for _ in 0..flights {
        let tried = start.mutated(flyer.sets(), flyer.vehicle(), drawn, scale);
        let flown = work.fly(flyer, &tried)?;
        let (before, after) = (wanted.of(&outcome), wanted.of(&flown));
        scale = if after > before { scale * SCALE_UP } else { scale * SCALE_DOWN }.clamp(SCALE_MIN, SCALE_MAX);
        if after >= before {
            (start, outcome) = (tried, flown);
        }
    }
    Ok((start, outcome))
}
