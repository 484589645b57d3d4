//! Campaigns of randomised flights, their shards, and merging them: the directories that `host-sim campaign` writes.

use crate::errors::{failed, refused, refused_field, unwritable};
use crate::interruptible::interruptible;
use crate::scenarios::Scenario;
use crate::threads::alone;
use crate::whole_number::Whole;
use host_sim::rivals::choice::OUR_LAW;
use host_sim::rivals::gains as of_rivals;
use host_sim::studies::campaign::CampaignError;
use host_sim::studies::campaign::fly::{self, CampaignSource, Orders};
use host_sim::studies::campaign::step;
use host_sim::studies::campaign::summary;
use pyo3::prelude::*;
use scenario::campaign::FLIGHTS_MAX;
use std::path::PathBuf;

/// What a campaign showed. As text: what `host-sim campaign` prints.
#[pyclass(frozen, module = "saturated_hybrid")]
pub struct Campaign {
    summary: summary::Summary,
}

#[pymethods]
impl Campaign {
    /// How many there are, of a shard its own.
    #[getter]
    fn flights(&self) -> u64 {
        self.summary.flights
    }

    /// Flights that recovered and tracked.
    #[getter]
    fn tracking(&self) -> u64 {
        self.summary.tracking
    }

    /// Flights with a command beyond a certified bound.
    #[getter]
    fn beyond(&self) -> u64 {
        self.summary.beyond
    }

    /// Flights with a command that a rotor could not follow.
    #[getter]
    fn clipped(&self) -> u64 {
        self.summary.clipped
    }

    /// Flights in which a rotor failed.
    #[getter]
    fn failed_rotors(&self) -> u64 {
        self.summary.losses.failed
    }

    /// Flights in which the law found a rotor to fail that had not.
    #[getter]
    fn false_alarms(&self) -> usize {
        self.summary.losses.false_alarms.len()
    }

    /// Why the scenario may not fly, if so.
    #[getter]
    fn refusal(&self) -> Option<&str> {
        self.summary.refusal.as_deref()
    }

    /// Whether every flight tracks within all bounds, and the scenario may fly.
    #[getter]
    fn holds(&self) -> bool {
        self.summary.holds
    }

    fn __str__(&self) -> String {
        self.summary.to_string()
    }

    fn __repr__(&self) -> String {
        let summary::Summary { flights, tracking, beyond, .. } = &self.summary;
        format!("<Campaign: {tracking} of {flights} flights track, {beyond} beyond a bound>")
    }
}

/// Flies a campaign of randomised flights into a directory, on all cores, as `host-sim campaign` does and to the same
/// bytes.
///
/// The circumstances of a flight come from the seed and its number alone: any number of cores, any split and any
/// interruption give the same. What is there already is not flown again.
///
/// Args:
///     scenario: its `[campaign]` section, if it has one, says what differs from flight to flight, and in how many a
///     rotor fails. directory: where `campaign.arrow` and the rest go. flights, seed: of the whole campaign; left out:
///     the scenario's. shard: (I, N): part I of N, from 1; `merge` puts the parts together. plant_step: s; left out:
///     the longest of at most 5 ms that fits. law: whose flights, "ours" or one of docs/rivals.md: "lee", "px4",
///     "mellinger", "indi", "nested", "continuous", "memoryless". gains: a file with that law's gains; left out: those
///     built in for the vehicles of docs/rivals.md.
///
/// Raises:
///     ValueError: names the argument, or says that the directory holds another campaign.
///     OSError: it cannot be written.
#[pyfunction]
#[pyo3(signature = (scenario, directory, *, flights=None, seed=None, shard=(Whole::new(1), Whole::new(1)), plant_step=None, law=OUR_LAW, gains=None))]
#[allow(clippy::too_many_arguments)] // its user names them
pub fn campaign(
    py: Python<'_>,
    scenario: &Scenario,
    directory: PathBuf,
    flights: Option<Whole>,
    seed: Option<Whole>,
    shard: (Whole, Whole),
    plant_step: Option<f64>,
    law: &str,
    gains: Option<PathBuf>,
) -> PyResult<Campaign> {
    let own = &scenario.read.campaign;
    let (flights, seed) = (flights.unwrap_or(Whole::new(own.flights)), seed.unwrap_or(Whole::new(own.seed)));
    let flights = flights.within("flights", 1..=FLIGHTS_MAX as u64)?;
    let seed = seed.within("seed", 0..=u64::MAX)?;
    let within = shard.0.value().zip(shard.1.value()).filter(|(part, parts)| (1..=*parts).contains(part));
    let shard = within.ok_or_else(|| {
        let allowed = "must be (I, N) with I from 1 to N";
        refused_field("shard", format!("{allowed}, found ({}, {})", shard.0, shard.1))
    })?;
    let stepped = match plant_step {
        None => step::with_longest_step(&scenario.read),
        Some(requested) => {
            step::with_step(&scenario.read, requested).map_err(|problem| refused_field("plant_step", problem))?
        }
    };
    let law = of_rivals::chosen(law, &stepped, gains.as_deref());
    let law = law.map_err(|(argument, problem)| refused_field(argument, problem))?;
    let orders = Orders { flights, seed, shard };
    let source = CampaignSource::new(stepped, scenario.text.clone(), scenario.file.clone()).map_err(raised)?;
    let flown = interruptible(py, |interrupt| alone(|| fly::campaign(&source, &law, &orders, &directory, interrupt)))?;
    Ok(Campaign { summary: flown?.map_err(raised)? })
}

/// Puts all shards of a campaign together, in any order: the same bytes as the campaign that was never split.
#[pyfunction]
pub fn merge(py: Python<'_>, shards: Vec<PathBuf>, directory: PathBuf) -> PyResult<Campaign> {
    let merged = py.detach(|| fly::merge(&shards, &directory));
    Ok(Campaign { summary: merged.map_err(raised)? })
}

fn raised(error: CampaignError) -> PyErr {
    match &error {
        CampaignError::Input(_) => refused(error),
        CampaignError::Output(_) => unwritable(error),
        CampaignError::Rows(_) | CampaignError::Interrupted(_) => failed(error),
    }
}
