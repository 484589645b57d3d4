//! What a comparison is asked to be, in clap's terms, and what of it is refused.

use clap::Args;
use host_sim::tune::effort::Effort;
use std::path::{Path, PathBuf};

/// What a comparison with other laws is asked to be.
#[derive(Args)]
pub struct CompareArguments {
    /// Scenario file: vehicle, limits, rotors, our law's gains, [campaign]
    pub file: PathBuf,
    /// Random flights of each law
    #[arg(long, value_name = "N", default_value_t = 200)]
    pub flights: u64,
    /// Directory for table, pictures, report and gains [default: flights/<name>-compared]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// File with the rivals' gains [default: those built in for the vehicles of docs/rivals.md; others need --tune]
    #[arg(long, value_name = "FILE", conflicts_with = "tune")]
    pub gains: Option<PathBuf>,
    /// Search the rivals' gains first, in so many generations, and write them to rivals.toml
    #[arg(long, value_name = "GENERATIONS")]
    tune: Option<u32>,
    /// Candidates of each generation of that search, 4 to 1000
    #[arg(long, default_value_t = 32)]
    population: usize,
    /// Seed of that search
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// The most random flights that are held in memory.
const FLIGHTS_MAX: u64 = 100_000;

impl CompareArguments {
    /// How hard to search for the rivals' gains; none if they are known.
    ///
    /// # Errors
    /// Names the argument that asks for something impossible.
    pub fn effort(&self) -> Result<Option<Effort>, String> {
        if !(1..=FLIGHTS_MAX).contains(&self.flights) {
            return Err(format!("--flights: must be from 1 to {FLIGHTS_MAX}, found {}", self.flights));
        }
        if self.tune == Some(0) {
            return Err("--tune: must be at least 1, found 0".to_owned());
        }
        if !(4..=1000).contains(&self.population) {
            return Err(format!("--population: must be from 4 to 1000, found {}", self.population));
        }
        let effort = |generations| Effort { generations, population: self.population, seed: self.seed };
        Ok(self.tune.map(effort))
    }

    /// How to find the same gains again.
    pub fn command(&self, effort: &Effort) -> String {
        let Effort { generations, population, seed } = effort;
        format!("host-sim compare {} --tune {generations} --population {population} --seed {seed}", self.file.display())
    }

    /// Where the results go, of a scenario of this name.
    pub fn directory(&self, name: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| Path::new("flights").join(format!("{name}-compared")))
    }
}
