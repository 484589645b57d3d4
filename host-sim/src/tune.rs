//! The `tune` command: gains that certify and make the most of a vehicle.
//!
//! What is asked, in this order:
//!
//! 1. a constraint: every inequality of the certificate, down to the rotors, with [`requirements::Requirements::margin`] to spare; the
//!    sampled loops stable with gain and delay margins, at least those without which nothing may fly; the vehicle recovers
//!    from upside down and holds still; the file's own reference is flown without a clipped command and within the errors
//!    asked for;
//! 2. the least height lost from the paper's first attitude, roll -179 degrees, at rest, on a hover reference at the same
//!    point ([`candidate::recovery`]);
//! 3. within [`HEIGHT_SLACK`] of that best, the greatest k_p.
//!
//! [`candidate`] turns a point of the search space into gains and judges it, cheapest test first; [`evolution`] searches;
//! [`frontier`] keeps what was learnt about the trade between height and k_p. Seeds are fixed: the same file gives the
//! same gains.

pub mod candidate;
pub mod evolution;
pub mod frontier;
pub mod output;
pub mod requirements;
pub mod space;

use crate::interrupt::Interrupt;
use crate::progress::Progress;
use candidate::{Judge, Verdict};
use controller_core::certificate::Certificate;
use controller_core::certificate::configuration::Configuration;
use controller_core::error::ParameterError;
use controller_core::reference::ReferenceBounds;
use evolution::{Evolution, Goal};
use frontier::Frontier;
use requirements::Requirements;
use scenario::Scenario;

/// How much more height than the best the answer may lose, relative, to win position gain.
pub const HEIGHT_SLACK: f64 = 0.05;

/// How hard to search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Generations of each of the two stages.
    pub generations: u32,
    /// Seed of the search.
    pub seed: u64,
}

/// What the search found.
#[derive(Clone)]
pub struct Tuned {
    /// The scenario with the gains found.
    pub scenario: Scenario,
    /// What it showed.
    pub verdict: Verdict,
    /// The trade between height lost and k_p.
    pub frontier: Frontier,
    /// Candidates judged.
    pub judged: u64,
}

/// Searches gains for `scenario`; an interrupt ends the search with the best found so far.
///
/// # Errors
/// If no candidate met the requirements: the verdict of the one that came closest.
pub fn tune(
    scenario: &Scenario,
    requirements: Requirements,
    effort: Effort,
    interrupt: &Interrupt,
) -> Result<Tuned, Box<Verdict>> {
    let judge = Judge::new(scenario, requirements);
    let mut frontier = Frontier::default();
    let mut progress = Progress::new("tuning", u64::from(2 * effort.generations));
    let mut evolution = Evolution::new(&judge, effort.seed, &mut frontier, interrupt);
    let wanted = |generation: &u32| *generation < effort.generations && interrupt.signal().is_none();
    for generation in (0..).take_while(wanted) {
        evolution.generation(&judge, Goal::Height, &mut frontier, interrupt);
        progress.show(u64::from(generation));
    }
    let Some(best) = evolution.best(Goal::Height) else {
        return Err(Box::new(evolution.closest()));
    };
    let goal = Goal::PositionGain { height_at_most: best.1.height_lost * (1.0 + HEIGHT_SLACK) };
    for generation in (0..).take_while(wanted) {
        evolution.generation(&judge, goal, &mut frontier, interrupt);
        progress.show(u64::from(effort.generations + generation));
    }
    drop(progress);
    // The second stage may find a lower height than the first: what it allows follows from the best of all.
    let limit = frontier.least_height().unwrap_or(best.1.height_lost) * (1.0 + HEIGHT_SLACK);
    let (point, verdict) = frontier.greatest_gain_within(limit).unwrap_or(best);
    match judge.scenario(&point) {
        Some(scenario) => Ok(Tuned { scenario, verdict, frontier, judged: evolution.judged() }),
        None => Err(Box::new(verdict)),
    }
}

/// The largest factor by which all reference bounds of `configuration` can grow with every margin at `margin` or above.
///
/// # Errors
/// As [`Certificate::new`]'s.
pub fn widest_bounds(configuration: &Configuration, margin: f64) -> Result<(f64, ReferenceBounds), ParameterError> {
    let bounds = *configuration.bounds();
    let scaled = |factor: f64| {
        let grow = |value: f32| (f64::from(value) * factor) as f32;
        ReferenceBounds {
            horizontal_speed: grow(bounds.horizontal_speed),
            horizontal_acceleration: grow(bounds.horizontal_acceleration),
            vertical_acceleration: grow(bounds.vertical_acceleration),
            jerk: grow(bounds.jerk),
            snap: grow(bounds.snap),
            heading_rate: grow(bounds.heading_rate),
            heading_second_derivative: grow(bounds.heading_second_derivative),
        }
    };
    let holds = |factor: f64| {
        configuration
            .with_bounds(scaled(factor))
            .and_then(|wider| Certificate::new(&wider))
            .is_ok_and(|certificate| certificate.tightest().is_some_and(|worst| worst.margin() >= margin))
    };
    let (mut good, mut bad) = (1.0, 1.0);
    while bad < 1e6 && holds(bad) {
        good = bad;
        bad *= 2.0;
    }
    for _ in 0..40 {
        let middle = 0.5 * (good + bad);
        if holds(middle) { good = middle } else { bad = middle }
    }
    Ok((good, scaled(good)))
}

#[cfg(test)]
mod tests;
