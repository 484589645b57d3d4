//! How much height a recovery costs, how long it takes, and how near the vehicle then stays: what flights show of it.
//!
//! A [model](scenario::model) of the vehicle is at its reference, a hover, with any attitude and some speed and spin,
//! and its law is freshly reset. The law sees the true state. Forces come and go; rotors' lag and moments of inertia are
//! not what the law believes. Nothing here is proven for every start: flights give the worst that was found, and what
//! statistics prove of starts drawn alike.
//!
//! | module | what it holds |
//! |---|---|
//! | [`start`], [`gust`] | where a flight begins and how its vehicle differs from the file; the force along it |
//! | [`flight`] | one flight, and what it showed |
//! | [`many`] | random flights on all cores |
//! | [`search`] | hill climbing for a start that is worse still |
//! | [`tube`] | how near it stays: proven, and flown at rest for comparison |
//! | [`report`] | the lines H, T and r |

pub mod flight;
pub mod gust;
pub mod many;
pub mod report;
pub mod search;
pub mod start;
pub mod tube;

use crate::output::interrupt::Interrupt;
use controller_core::configuration::LawParameters;
use controller_core::error::ParameterError;
use flight::{Flyer, Outcome};
use many::{Interrupted, Work};
use report::Report;
use scenario::Scenario;
use scenario::verdict::Verdict;
use search::Wanted;
use start::Sets;
use std::fmt;
use tube::{Radii, Tolerances};

/// How much is flown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orders {
    /// Flights drawn at random.
    pub flights: u64,
    /// Flights of each of the two searches.
    pub search: u64,
    /// Of all draws.
    pub seed: u64,
}

impl Default for Orders {
    /// About a minute on two cores, at 100 Hz.
    fn default() -> Self {
        Self { flights: 50_000, search: 15_000, seed: 1 }
    }
}

/// Why there is no report.
#[derive(Debug)]
pub enum Refused {
    /// What the scenario lacks, and what to do.
    Scenario(String),
    /// This signal came.
    Interrupted(u8),
    /// A number is beyond what the law or the loops can work with.
    Undefined(ParameterError),
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scenario(why) => f.write_str(why),
            Self::Interrupted(signal) => write!(f, "interrupted by signal {signal}; nothing is kept"),
            Self::Undefined(error) => write!(f, "{error}"),
        }
    }
}

/// What recoveries of `scenario` cost, from starts in `sets`.
///
/// # Errors
/// [`Refused`].
pub fn recovery(scenario: &Scenario, sets: &Sets, orders: &Orders, interrupt: &Interrupt) -> Result<Report, Refused> {
    let LawParameters::Extended(_) = scenario.configuration.law() else {
        let why = "control.law: recoveries are judged of the extended law: take law = \"extended\", without the \
                   paper's gains";
        return Err(Refused::Scenario(why.to_owned()));
    };
    if scenario.configuration.rotors().is_none() {
        let why = "rotors: recoveries are judged of a vehicle whose rotors are known: add that section";
        return Err(Refused::Scenario(why.to_owned()));
    }
    let verdict = Verdict::judge(scenario).map_err(Refused::Undefined)?;
    if let Some(refusal) = verdict.refusal() {
        return Err(Refused::Scenario(format!("not certified: {refusal}; `host-sim certify` says what to change")));
    }
    let Some(certified) = verdict.certified() else {
        return Err(Refused::Scenario("not certified".to_owned()));
    };
    let tolerances = Tolerances { lag: sets.lag, inertia: sets.inertia };
    let tube = tube::judge(scenario, sets.gust, &tolerances);
    let radii =
        tube.as_ref().map_or(Radii::UNPROVEN, |tube| Radii { across: tube.across(), vertical: tube.vertical() });
    let flyer = Flyer::new(certified, &scenario.loop_timing(), sets, radii).map_err(Refused::Undefined)?;
    let beside = tube.as_ref().ok().map(|tube| tube::beside_the_tube(&flyer, tube::worst_gusts(tube)));
    let interrupted = |Interrupted(signal)| Refused::Interrupted(signal);
    let work = Work::new(orders.flights + 2 * orders.search, interrupt);
    let random = many::flights(&flyer, orders, &work).map_err(interrupted)?;
    let climb = |wanted| search::worst(&flyer, wanted, &random, orders, &work).map_err(interrupted);
    let count = |what: fn(&Outcome) -> bool| random.iter().filter(|outcome| what(outcome)).count() as u64;
    Ok(Report {
        name: scenario.name.clone(),
        sets: *sets,
        radii,
        height: report::Found::new(Wanted::Height, &random, climb(Wanted::Height)?),
        time: report::Found::new(Wanted::Time, &random, climb(Wanted::Time)?),
        not_arrived: count(|outcome| outcome.settled_after.is_none()),
        fell_back: count(|outcome| outcome.fell_back),
        blamed_a_rotor: count(|outcome| outcome.blamed_a_rotor),
        flights: orders.flights,
        search: orders.search,
        tube,
        beside,
    })
}

#[cfg(test)]
mod tests;
