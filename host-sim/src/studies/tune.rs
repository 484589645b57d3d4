//! The `tune` command: constants that certify and make the most of a vehicle.
//!
//! The goals, in this order:
//!
//! 1. a constraint: every inequality of the certificate, down to the rotors, with
//!    [`requirements::Requirements::margin`] to spare; the sampled loops stable with gain and delay margins, at least
//!    the margins that every flight needs; the vehicle recovers from upside down; the file's own reference is flown
//!    without a clipped command and within the allowed errors;
//! 2. the least cost: what a pilot feels of the trials in [`trials`], averaged over the vehicle as it may really be.
//!
//! [`space`] says which constants are searched; [`candidate`] judges a point of it, cheapest test first; [`evolution`]
//! searches; [`output`] writes what was found. A search starts from the file's constants and never ends with worse
//! ones. Seeds are fixed: the same file gives the same constants.

pub mod candidate;
pub mod chosen;
pub mod effort;
pub mod evolution;
pub mod output;
pub mod requirements;
pub mod rivals;
pub mod space;
pub mod trials;

use crate::output::interrupt::Interrupt;
use crate::output::progress::Progress;
use crate::output::table::{aligned, short};
use candidate::{Judge, Verdict};
use controller_core::certificate::Certificate;
use controller_core::configuration::Configuration;
use controller_core::error::ParameterError;
use controller_core::reference::ReferenceBounds;
use effort::Effort;
use evolution::Evolution;
use requirements::Requirements;
use scenario::Scenario;
use trials::{MODEL_FIGURES, OWN_MODEL_FIGURES};

/// The search's result.
#[derive(Clone)]
pub struct Tuned {
    /// The scenario with the constants found.
    pub scenario: Scenario,
    /// Its verdict.
    pub verdict: Verdict,
    /// The verdict on the file's own constants.
    pub before: Verdict,
    /// Candidates judged.
    pub judged: u64,
}

impl Tuned {
    /// Whether the search found better constants than its start.
    #[must_use]
    pub fn improved(&self) -> bool {
        self.verdict != self.before
    }

    /// Every figure before and after, as a table for a terminal.
    #[must_use]
    pub fn table(&self) -> String {
        let own = |verdict: &Verdict| {
            let beyond =
                verdict.figures.beyond.map_or([f64::INFINITY; OWN_MODEL_FIGURES.len()], |beyond| beyond.values());
            [&verdict.figures.values()[..], &beyond].concat()
        };
        let number = |value: f64| if value.is_finite() { short((1e4 * value).round() / 1e4) } else { "-".to_owned() };
        let pairs = [own(&self.before), own(&self.verdict), self.before.mean.to_vec(), self.verdict.mean.to_vec()];
        let head = ["", "", "file's model: before", "after", "mean of four models: before", "after"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        for (place, (name, unit, ..)) in MODEL_FIGURES.iter().chain(&OWN_MODEL_FIGURES).enumerate() {
            let values = pairs.iter().map(|values| values.get(place).map_or(String::new(), |value| number(*value)));
            rows.push([*name, *unit].map(str::to_owned).into_iter().chain(values).collect());
        }
        let cost = ["cost", "", "", "", &number(self.before.cost), &number(self.verdict.cost)];
        rows.push(cost.map(str::to_owned).to_vec());
        aligned(&rows)
    }
}

/// Searches constants for `scenario`; an interrupt ends the search with the best found so far.
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
    let mut progress = Progress::new("tuning", u64::from(effort.generations) + 1);
    let mut evolution = Evolution::new(&judge, &effort, interrupt);
    let wanted = |generation: &u32| *generation < effort.generations && interrupt.signal().is_none();
    for generation in (0..).take_while(wanted) {
        progress.show(u64::from(generation) + 1);
        evolution.generation(&judge, interrupt);
    }
    drop(progress);
    let Some((point, verdict)) = evolution.best() else {
        return Err(Box::new(evolution.closest()));
    };
    let (before, judged) = (evolution.start().clone(), evolution.judged());
    match judge.scenario(&point) {
        Some(scenario) => Ok(Tuned { scenario, verdict, before, judged }),
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
