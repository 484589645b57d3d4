//! How much height a recovery costs, how long it takes, and how near the vehicle then stays: what flights show of it.
//!
//! A [model](scenario::model) of the vehicle is at its reference, a hover, with any attitude and some speed and spin,
//! and its law is freshly reset. The law sees the true state. Forces come and go; rotors' lag and moments of inertia
//! are not as the law believes. Nothing here is proven for every start: flights give the worst that was found, and a
//! bound from statistics on starts drawn alike.
//!
//! | module | what it holds |
//! |---|---|
//! | [`start`], [`gust`] | where a flight begins and how its vehicle differs from the file; the force along it |
//! | [`flight`] | one flight, and what it showed |
//! | [`many`] | random flights on all cores |
//! | [`search`] | hill climbing for a start that is worse still |
//! | [`tube`] | how near it stays: the worst gusts of the proof, flown |
//! | [`report`] | the lines H, T and r |

pub mod flight;
pub mod gust;
pub mod many;
pub mod report;
pub mod search;
pub mod start;
pub mod tube;

use crate::output::interrupt::Interrupt;
use crate::output::progress::Progress;
use controller_core::configuration::LawParameters;
use controller_core::error::ParameterError;
use flight::{Flyer, Outcome};
pub use many::Orders;
use many::{Interrupted, Work};
use report::Report;
use scenario::Scenario;
use scenario::tube::{Loops, NoTube, Tolerances, Tube};
use scenario::verdict::Verdict;
use search::Wanted;
use start::Sets;
use std::fmt;
use std::sync::Mutex;

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
    let Proof { tube, gust_max } = proof(scenario, sets, interrupt)?;
    let radius = tube.as_ref().map_or(RADIUS_UNPROVEN_M, |tube| RADIUS_MIN_M.max(2.0 * tube.greatest()));
    let flyer = Flyer::new(certified, &scenario.loop_timing(), sets, radius).map_err(Refused::Undefined)?;
    let interrupted = |Interrupted(signal)| Refused::Interrupted(signal);
    let work = Work::new(orders.flights + 3 * orders.search, interrupt);
    let random = many::flights(&flyer, orders, &work).map_err(interrupted)?;
    let climb = |wanted| search::worst(&flyer, wanted, &random, orders, &work).map_err(interrupted);
    let beside = tube.as_ref().ok().map(|tube| tube::beside(&flyer, tube, orders, &work)).transpose();
    let beside = beside.map_err(interrupted)?;
    let count = |what: fn(&Outcome) -> bool| random.iter().filter(|outcome| what(outcome)).count() as u64;
    Ok(Report {
        name: scenario.name.clone(),
        sets: *sets,
        radius,
        height: report::Found::new(Wanted::Height, &random, climb(Wanted::Height)?),
        time: report::Found::new(Wanted::Time, &random, climb(Wanted::Time)?),
        not_arrived: count(|outcome| outcome.settled_after.is_none()),
        fell_back: count(|outcome| outcome.fell_back),
        blamed_a_rotor: count(|outcome| outcome.blamed_a_rotor),
        flights: orders.flights,
        search: orders.search,
        tube,
        gust_max,
        beside,
    })
}

/// What counts as back at least, m, and otherwise twice the proven radius: r is for a law that knows its thrust, and a
/// recovery can leave it in error about that (`docs/recovery.md`).
const RADIUS_MIN_M: f64 = 0.1;

/// What counts as back where no radius is proven, m.
const RADIUS_UNPROVEN_M: f64 = 0.5;

/// The greatest gust that a radius is looked for, m/s^2.
const GUST_MAX_M_PER_S2: f64 = 10.0;

/// What is proven about the radius.
struct Proof {
    tube: Result<Tube, NoTube>,
    /// The greatest gust that has one, m/s^2.
    gust_max: f64,
}

/// Proves the radius, or finds why that fails.
fn proof(scenario: &Scenario, sets: &Sets, interrupt: &Interrupt) -> Result<Proof, Refused> {
    let tolerances = Tolerances { lag: sets.lag, inertia: sets.inertia };
    let progress = Mutex::new(Progress::new("proving r", 1000));
    let show = |done: f64| {
        if let Ok(mut progress) = progress.try_lock() {
            progress.show((1e3 * done) as u64);
        }
        interrupt.signal().is_none()
    };
    let loops = match Loops::new(scenario, &tolerances, &show) {
        Ok(loops) => loops,
        Err(NoTube::Stopped) => return Err(Refused::Interrupted(interrupt.signal().unwrap_or_default())),
        Err(none) => return Ok(Proof { tube: Err(none), gust_max: 0.0 }),
    };
    Ok(Proof { tube: loops.tube(sets.gust), gust_max: loops.greatest_gust(GUST_MAX_M_PER_S2) })
}

#[cfg(test)]
mod tests;
