//! The arguments of a comparison, in clap's terms, and their checks.

use clap::Args;
use clap::builder::PossibleValuesParser;
use host_sim::rivals::kind::RivalKind;
use host_sim::studies::tune::effort::Effort;
use std::path::{Path, PathBuf};

/// The arguments of `compare`.
#[derive(Args)]
pub struct CompareArguments {
    /// Scenario file: vehicle, limits, rotors, our law's gains, [campaign]
    pub file: PathBuf,
    /// Random flights of each law
    #[arg(long, value_name = "N", default_value_t = 200)]
    pub flights: u64,
    /// The other laws that fly beside ours, with commas between [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = rivals_names())]
    only: Vec<String>,
    /// The other laws' rate, Hz: 1/rate is a whole number of plant steps [default: the file's]
    #[arg(long, value_name = "HZ")]
    pub rate: Option<f64>,
    /// Fly the vehicle as its file does not know it instead: delay, mass, voltage, wind, ground (see docs/rivals.md)
    #[arg(long, conflicts_with = "flights")]
    pub realism: bool,
    /// Fly it as a rotor fails instead, to the ground (see docs/rivals.md)
    #[arg(long, conflicts_with_all = ["flights", "realism"])]
    pub rotor_loss: bool,
    /// Directory for table, pictures, report and gains [default: flights/<name>-compared]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// File with the rivals' gains [default: those built in for this vehicle, or else a search that writes gains.toml]
    #[arg(long, value_name = "FILE", conflicts_with = "tune")]
    pub gains: Option<PathBuf>,
    /// Search the rivals' gains even if some are built in, in so many generations, and write them to rivals.toml
    #[arg(long, value_name = "GENERATIONS")]
    tune: Option<u32>,
    /// Generations of the search where none are built in: a few, for tests
    #[arg(long, hide = true, conflicts_with_all = ["tune", "gains"])]
    generations: Option<u32>,
    /// Candidates of each generation of a search, 4 to 1000 [default: 32 with --tune, else as many as tune's]
    #[arg(long)]
    population: Option<usize>,
    /// Seed of that search
    #[arg(long, default_value_t = Effort::default().seed)]
    seed: u64,
}

/// The values of --only.
fn rivals_names() -> PossibleValuesParser {
    PossibleValuesParser::new(RivalKind::ALL.map(RivalKind::name))
}

/// The most random flights that are held in memory.
const FLIGHTS_MAX: u64 = 100_000;
/// Candidates of each generation of a search that --tune asks for.
const TUNE_POPULATION_SIZE: usize = 32;

/// Which gains of the rivals fly.
pub enum GainsWanted {
    /// The gains of this file.
    Of(PathBuf),
    /// The built-in gains; without any, those of a search with this effort.
    BuiltInOr(Effort),
    /// The gains of a search.
    Searched(Effort),
}

impl CompareArguments {
    /// Which gains of the rivals are to fly.
    ///
    /// # Errors
    /// Names the argument out of range.
    pub fn gains(&self) -> Result<GainsWanted, String> {
        if !(1..=FLIGHTS_MAX).contains(&self.flights) {
            return Err(format!("--flights: must be from 1 to {FLIGHTS_MAX}, found {}", self.flights));
        }
        for (name, generations) in [("--tune", self.tune), ("--generations", self.generations)] {
            if generations == Some(0) {
                return Err(format!("{name}: must be at least 1, found 0"));
            }
        }
        if let Some(population) = self.population.filter(|population| !(4..=1000).contains(population)) {
            return Err(format!("--population: must be from 4 to 1000, found {population}"));
        }
        let usual = Effort::default();
        let effort = |generations, population| Effort {
            generations,
            population: self.population.unwrap_or(population),
            seed: self.seed,
        };
        Ok(match (&self.gains, self.tune) {
            (Some(file), _) => GainsWanted::Of(file.clone()),
            (None, Some(generations)) => GainsWanted::Searched(effort(generations, TUNE_POPULATION_SIZE)),
            (None, None) => {
                GainsWanted::BuiltInOr(effort(self.generations.unwrap_or(usual.generations), usual.population))
            }
        })
    }

    /// The other laws that are to fly, in the order of the table.
    pub fn kinds(&self) -> Vec<RivalKind> {
        let is_wanted = |kind: &RivalKind| self.only.is_empty() || self.only.iter().any(|name| name == kind.name());
        RivalKind::ALL.into_iter().filter(is_wanted).collect()
    }

    /// How to find the same gains again.
    pub fn command(&self, effort: &Effort) -> String {
        let Effort { generations, population, seed } = effort;
        let only = if self.only.is_empty() { String::new() } else { format!(" --only {}", self.only.join(",")) };
        let rate = self.rate.map_or_else(String::new, |rate| format!(" --rate {rate}"));
        let file = self.file.display();
        format!("host-sim compare {file}{only}{rate} --tune {generations} --population {population} --seed {seed}")
    }

    /// Where the results go, of a scenario of this name.
    pub fn directory(&self, name: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| Path::new("flights").join(format!("{name}-compared")))
    }
}
