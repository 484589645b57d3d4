//! The `campaign` and `merge` commands: flights by the chunk on all cores, and shards put together.
//!
//! Which flights there are, and what each is, comes from the manifest; which core flies a chunk, and when, changes
//! nothing. Chunks that are already there are not flown again.

use super::CampaignError;
use super::manifest::{CHUNK_FLIGHTS, Manifest};
use super::random_flight::fly;
use super::report;
use super::rows::{FlightRow, batch};
use super::store::{REPORT_FILE, SUMMARY_FILE, Store};
use super::summary::Summary;
use crate::flight::law_on_vehicle::LawOnVehicle;
use crate::output::interrupt::Interrupt;
use crate::output::progress::Progress;
use crate::rivals::choice::LawChoice;
use arrow_array::RecordBatch;
use controller_core::certificate::Certificate;
use rayon::prelude::*;
use scenario::Scenario;
use scenario::verdict::Verdict;
use std::fmt::Display;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// The orders of a campaign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orders {
    /// Flights of the whole campaign.
    pub flights: u64,
    /// Seed of all draws.
    pub seed: u64,
    /// Which part of it, from 1, and of how many.
    pub shard: (u64, u64),
}

/// A scenario that a campaign can fly, with the plant step that is flown, and where it is from.
pub struct CampaignSource {
    scenario: Scenario,
    text: String,
    file: String,
}

impl CampaignSource {
    /// `scenario`, read from `text`, which errors call `file`.
    ///
    /// # Errors
    /// If it is [`grounded`].
    pub fn new(scenario: Scenario, text: String, file: String) -> Result<Self, CampaignError> {
        let source = Self { scenario, text, file };
        match grounded(&source.scenario) {
            Some(problem) => Err(source.error(problem)),
            None => Ok(source),
        }
    }

    /// The scenario.
    #[must_use]
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Its text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Its name in errors.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    fn error(&self, problem: impl Display) -> CampaignError {
        CampaignError::Input(format!("{}: {problem}", self.file))
    }

    fn verdict(&self) -> Result<Verdict, CampaignError> {
        Verdict::judge(&self.scenario).map_err(|error| self.error(error))
    }
}

/// Flies `source` under `law` into `directory`, or what is missing there.
///
/// # Errors
/// [`CampaignError`]; chunks that were finished stay.
pub fn campaign(
    source: &CampaignSource,
    law: &LawChoice,
    orders: &Orders,
    directory: &Path,
    interrupt: &Interrupt,
) -> Result<Summary, CampaignError> {
    let CampaignSource { scenario, text, .. } = source;
    let Orders { flights, seed, shard } = *orders;
    if let Some(problem) = idle(orders) {
        return Err(CampaignError::Input(problem));
    }
    let verdict = source.verdict()?;
    let on_vehicle = LawOnVehicle::new(law, scenario, verdict.certified())
        .ok_or_else(|| source.error(format_args!("the law {} is undefined for its gains", law.name())))?;
    let manifest = Manifest::new(scenario, text, flights, seed, shard).under(law.clone());
    let store = Store::open(directory, &manifest, text)?;
    let flown = match store.result() {
        Some(flown) => flown,
        None => {
            let chunks = Chunks::new(source, &on_vehicle, verdict.certificate(), &store, interrupt);
            chunks.fly()?
        }
    };
    finish(source, &verdict, &store, &flown)
}

/// Why nothing of `scenario` is thrown into the air, if so.
#[must_use]
pub fn grounded(scenario: &Scenario) -> Option<&'static str> {
    let problem = "ground: a campaign throws its vehicles into the air anywhere: leave that section out";
    scenario.reality.ground.is_some().then_some(problem)
}

/// What is wrong where shards are left without flights: of those nothing could be said.
fn idle(orders: &Orders) -> Option<String> {
    let (chunks, parts) = (orders.flights.div_ceil(CHUNK_FLIGHTS), orders.shard.1);
    let many = |count: u64, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    (parts > chunks).then(|| {
        let (flights, found) = (many(orders.flights, "flight"), many(chunks, "chunk"));
        format!(
            "shard: {flights} in chunks of {CHUNK_FLIGHTS} are {found}, so there can be at most {}, found {parts}",
            many(chunks, "shard")
        )
    })
}

/// Puts shards together, in any order, into `directory`: the same bytes as the campaign that was never split.
///
/// # Errors
/// [`CampaignError`]: shards that are missing, not complete, or of different campaigns.
pub fn merge(shards: &[impl AsRef<Path>], directory: &Path) -> Result<Summary, CampaignError> {
    let mut stores = shards.iter().map(|shard| Store::complete(shard.as_ref())).collect::<Result<Vec<_>, _>>()?;
    stores.sort_by_key(|(store, _)| store.manifest().shard);
    let Some((first, _)) = stores.first() else {
        return Err(CampaignError::Input("merge: expects the directories of all shards".to_owned()));
    };
    let (manifest, text, file) = (first.manifest().clone(), first.scenario()?, first.scenario_file());
    let parts = manifest.shard.1;
    for (part, (store, _)) in (1..).zip(&stores) {
        let expected = Manifest { shard: (part, parts), ..manifest.clone() };
        if let Some(difference) = expected.difference(store.manifest()) {
            let odd = store.directory().display();
            return Err(CampaignError::Input(format!(
                "{odd}: merge: expects each of the shards of one campaign once, {parts} in all: not the same {difference}"
            )));
        }
    }
    if stores.len() as u64 != parts {
        let problem = format!("merge: expects all {parts} shards of the campaign, found {}", stores.len());
        return Err(CampaignError::Input(problem));
    }
    // Each has the text that its flights were flown from, or what is merged is not what it says.
    stores.iter().try_for_each(|(store, _)| store.scenario().map(drop))?;
    let file = file.display().to_string();
    let scenario = Scenario::parse(&text, &file).map_err(|error| CampaignError::Input(error.to_string()))?;
    let source = CampaignSource::new(scenario, text, file)?;
    let verdict = source.verdict()?;
    let whole = Manifest { shard: (1, 1), result: None, ..manifest };
    let mut numbered: Vec<(u64, RecordBatch)> = stores
        .into_iter()
        .flat_map(|(store, flown)| store.manifest().chunks().into_iter().zip(flown).collect::<Vec<_>>())
        .collect();
    numbered.sort_by_key(|(chunk, _)| *chunk);
    let flown: Vec<RecordBatch> = numbered.into_iter().map(|(_, batch)| batch).collect();
    let store = Store::open(directory, &whole, &source.text)?;
    finish(&source, &verdict, &store, &flown)
}

/// Writes what was flown and what it showed.
fn finish(
    source: &CampaignSource,
    verdict: &Verdict,
    store: &Store,
    flown: &[RecordBatch],
) -> Result<Summary, CampaignError> {
    let CampaignSource { scenario, text, .. } = source;
    let summary = Summary::summarize(scenario, verdict, store.manifest(), flown);
    store.finish(flown)?;
    store.write(SUMMARY_FILE, &summary.to_string())?;
    store.write(REPORT_FILE, &report::page(&summary, text, store.manifest(), flown).html())?;
    Ok(summary)
}

/// Chunks to fly.
struct Chunks<'a> {
    source: &'a CampaignSource,
    law: &'a LawOnVehicle,
    certificate: &'a Certificate,
    store: &'a Store,
    interrupt: &'a Interrupt,
    done: AtomicU64,
    progress: Mutex<Progress>,
}

impl<'a> Chunks<'a> {
    fn new(
        source: &'a CampaignSource,
        law: &'a LawOnVehicle,
        certificate: &'a Certificate,
        store: &'a Store,
        interrupt: &'a Interrupt,
    ) -> Self {
        Self {
            source,
            law,
            certificate,
            store,
            interrupt,
            done: AtomicU64::new(0),
            progress: Mutex::new(Progress::new("flying", store.manifest().own_flights())),
        }
    }

    /// All of them, in the order of their numbers.
    fn fly(&self) -> Result<Vec<RecordBatch>, CampaignError> {
        let chunks = self.store.manifest().chunks();
        // By single chunks: a thread that is done takes the next, so that none waits for another.
        chunks.into_par_iter().with_max_len(1).map(|chunk| self.fly_chunk(chunk)).collect()
    }

    fn fly_chunk(&self, chunk: u64) -> Result<RecordBatch, CampaignError> {
        let numbers = self.store.manifest().flights_of(chunk);
        if let Some(flown) = self.store.part(chunk) {
            self.show(numbers.end - numbers.start);
            return Ok(flown);
        }
        let rows = numbers.map(|number| self.fly_one(number)).collect::<Result<Vec<FlightRow>, _>>()?;
        let flown = batch(&rows, self.store.manifest()).map_err(CampaignError::Rows)?;
        self.store.keep(chunk, &flown)?;
        Ok(flown)
    }

    fn fly_one(&self, number: u64) -> Result<FlightRow, CampaignError> {
        if let Some(signal) = self.interrupt.signal() {
            return Err(CampaignError::Interrupted(signal));
        }
        let flown = fly(self.law, &self.source.scenario, self.certificate, self.store.manifest().seed, number);
        self.show(1);
        flown.map_err(|error| self.source.error(error))
    }

    /// So many more are done.
    fn show(&self, more: u64) {
        let done = self.done.fetch_add(more, Ordering::Relaxed) + more;
        // A thread that cannot draw at once leaves it to the next.
        if let Ok(mut progress) = self.progress.try_lock() {
            progress.show(done);
        }
    }
}

#[cfg(test)]
mod tests;
