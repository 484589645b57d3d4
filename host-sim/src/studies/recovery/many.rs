//! Random flights on all cores: each from seed and number alone, so that the number of threads changes nothing.

use super::flight::{Flyer, Outcome};
use super::start::Start;
use crate::output::interrupt::Interrupt;
use crate::output::progress::Progress;
use rayon::prelude::*;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// How much is flown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orders {
    /// Flights drawn at random.
    pub flights: u64,
    /// Flights of each of the three searches.
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

/// The signal that came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interrupted(pub u8);

/// Flights that are done, shown as they are.
pub struct Work<'a> {
    interrupt: &'a Interrupt,
    done: AtomicU64,
    progress: Mutex<Progress>,
}

impl<'a> Work<'a> {
    /// `total` flights, until a signal comes.
    #[must_use]
    pub fn new(total: u64, interrupt: &'a Interrupt) -> Self {
        Self { interrupt, done: AtomicU64::new(0), progress: Mutex::new(Progress::new("flying recoveries", total)) }
    }

    /// Flies one more.
    ///
    /// # Errors
    /// If a signal has come.
    pub fn fly(&self, flyer: &Flyer, start: &Start) -> Result<Outcome, Interrupted> {
        self.count()?;
        Ok(flyer.flown(start))
    }

    /// Counts one more flight.
    ///
    /// # Errors
    /// If a signal has come.
    pub fn count(&self) -> Result<(), Interrupted> {
        if let Some(signal) = self.interrupt.signal() {
            return Err(Interrupted(signal));
        }
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        // A thread that cannot draw at once leaves it to the next.
        if let Ok(mut progress) = self.progress.try_lock() {
            progress.show(done);
        }
        Ok(())
    }
}

/// The flights that were ordered, in the order of their numbers.
///
/// # Errors
/// If a signal came.
pub fn flights(flyer: &Flyer, orders: &Orders, work: &Work) -> Result<Vec<Outcome>, Interrupted> {
    let start = |number| Start::drawn(flyer.sets(), flyer.vehicle(), orders.seed, number);
    (0..orders.flights).into_par_iter().map(|number| work.fly(flyer, &start(number))).collect()
}

/// The share p of starts drawn alike with (1 - p)^flights = 1e-6: with a confidence of 1 - 1e-6 fewer do worse than the
/// worst of so many flights.
#[must_use]
pub fn share_beyond(flights: u64) -> f64 {
    -(DOUBT_PROBABILITY.ln() / flights as f64).exp_m1()
}

/// 1 minus the confidence.
pub const DOUBT_PROBABILITY: f64 = 1e-6;
