//! The `tune` command: gains that certify and make the most of a vehicle.
//!
//! What is asked, in this order:
//!
//! 1. a constraint: every inequality of the certificate, down to the rotors, with [`requirements::Requirements::margin`] to spare; the
//!    sampled loops stable with gain and delay margins, at least those without which nothing may fly; the vehicle recovers
//!    from upside down; the file's own reference is flown without a clipped command and within the errors asked for;
//! 2. the least cost: what a pilot feels of the trials in [`trials`], averaged over the vehicle as it may really be.
//!
//! [`space`] says which constants are searched; [`candidate`] judges a point of it, cheapest test first; [`evolution`] searches;
//! [`frontier`] keeps what was learnt about the trade between height lost and gusts. Seeds are fixed: the same file gives the
//! same constants.

pub mod candidate;
pub mod effort;
pub mod evolution;
pub mod frontier;
pub mod output;
pub mod requirements;
pub mod space;
pub mod trials;

use crate::interrupt::Interrupt;
use crate::progress::Progress;
use candidate::{Judge, Verdict};
use controller_core::certificate::Certificate;
use controller_core::certificate::configuration::Configuration;
use controller_core::error::ParameterError;
use controller_core::reference::ReferenceBounds;
use effort::Effort;
use evolution::Evolution;
use frontier::Frontier;
use requirements::Requirements;
use scenario::Scenario;

/// What the search found.
#[derive(Clone)]
pub struct Tuned {
    /// The scenario with the gains found.
    pub scenario: Scenario,
    /// What it showed.
    pub verdict: Verdict,
    /// The trade between height lost and gusts.
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
    let mut progress = Progress::new("tuning", u64::from(effort.generations));
    let mut evolution = Evolution::new(&judge, &effort, &mut frontier, interrupt);
    let wanted = |generation: &u32| *generation < effort.generations && interrupt.signal().is_none();
    for generation in (0..).take_while(wanted) {
        evolution.generation(&judge, &mut frontier, interrupt);
        progress.show(u64::from(generation));
    }
    drop(progress);
    let Some((point, verdict)) = evolution.best() else {
        return Err(Box::new(evolution.closest()));
    };
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
