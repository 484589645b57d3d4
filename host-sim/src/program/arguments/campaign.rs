//! The arguments of a campaign and of a merge of its shards, in clap's terms, and their checks.

use clap::Args;
use clap::builder::PossibleValuesParser;
use host_sim::rivals::choice::{LawChoice, OUR_LAW};
use host_sim::rivals::gains;
use host_sim::rivals::kind::RivalKind;
use host_sim::studies::campaign::fly::{CampaignSource, Orders};
use host_sim::studies::campaign::step;
use scenario::Scenario;
use scenario::campaign::FLIGHTS_MAX;
use std::path::{Path, PathBuf};

/// The arguments of `campaign`.
#[derive(Args)]
pub struct CampaignArguments {
    /// Scenario file; its [campaign] says how circumstances differ from flight to flight
    pub file: PathBuf,
    /// How many flights [default: the file's, or 1000]
    #[arg(long, value_name = "N")]
    flights: Option<u64>,
    /// Seed of all draws [default: the file's, or 0]
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// Directory for the results [default: campaigns/<name>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Fly part I of N of the campaign, I from 1; `merge` puts the parts together
    #[arg(long, value_name = "I/N", value_parser = shard, conflicts_with = "replay")]
    shard: Option<(u64, u64)>,
    /// Fly this one flight again, as `fly` does: log, figures, report
    #[arg(long, value_name = "NUMBER")]
    pub replay: Option<u64>,
    /// With --replay: fly even if log.csv will take more than 1 GB
    #[arg(long, requires = "replay")]
    pub large_log: bool,
    /// Which law flies: ours, or another one to compare it with
    #[arg(long, value_name = "NAME", default_value = OUR_LAW, value_parser = law_names())]
    law: String,
    /// File with that law's gains, as `compare` writes it [default: those built in for the vehicles of docs/rivals.md]
    #[arg(long, value_name = "FILE")]
    gains: Option<PathBuf>,
    /// A file with a [campaign] section, for a scenario that has none
    #[arg(long, value_name = "FILE")]
    draws: Option<PathBuf>,
    /// The plant's step, s [default: the longest of at most 5 ms that fits]
    #[arg(long, value_name = "SECONDS")]
    plant_step: Option<f64>,
}

/// Shards to put together.
#[derive(Args)]
pub struct MergeArguments {
    /// The directories of all shards of one campaign
    #[arg(required = true)]
    pub shards: Vec<PathBuf>,
    /// Directory for the whole
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// The help of `campaign`.
pub const HELP: &str = "\
Each flight's circumstances come from the seed and its number alone: where it
starts, wind, noise and, if the file asks for it, what the model has wrong. A
flight recovers and tracks if it comes within 0.2 m of its reference in the
first 90 % of its time and stays there to the end. The same flights give the
same bytes at any number of threads, in any split, and after any interruption:
what was finished is kept, and the same command goes on from there.
campaign.arrow has a row for each flight; docs/campaign.md has its columns, and
how to read them in Python.

  host-sim campaign vehicles/hummingbird.toml --flights 10000
  host-sim campaign vehicles/hummingbird.toml --replay 6194
  host-sim campaign vehicles/hummingbird.toml --shard 1/2 --out first
  host-sim campaign vehicles/hummingbird.toml --shard 2/2 --out second
  host-sim merge first second --out whole

Another law flies the very same circumstances: --law indi, into
campaigns/<name>-indi. docs/rivals.md says what the laws are.

The exit status is 1 if a flight does not track, a command goes beyond its
certified bound, or the scenario is not certified. Nothing is certified of
another law: its status is 1 if a flight does not track.";

/// The values of --law.
fn law_names() -> PossibleValuesParser {
    PossibleValuesParser::new(std::iter::once(OUR_LAW).chain(RivalKind::ALL.map(RivalKind::name)))
}

/// `I/N`.
fn shard(text: &str) -> Result<(u64, u64), String> {
    let parsed = text.split_once('/').and_then(|(part, parts)| Some((part.parse().ok()?, parts.parse().ok()?)));
    let fits = |(part, parts): &(u64, u64)| (1..=*parts).contains(part);
    parsed.filter(fits).ok_or_else(|| "must be I/N with I from 1 to N, e.g. 1/4".to_owned())
}

impl CampaignArguments {
    /// The scenario and where it is from.
    ///
    /// # Errors
    /// Names the file or the argument that is refused.
    pub fn source(&self) -> Result<CampaignSource, String> {
        let read = |file: &Path| {
            scenario::self_contained::read(file).map_err(|error| format!("{}: cannot be read: {error}", file.display()))
        };
        let (mut text, mut name) = (read(&self.file)?, self.file.display().to_string());
        if let Some(draws) = &self.draws {
            let section = read(draws)?;
            // The mark that a file may begin with has no place within one.
            let section = section.strip_prefix('\u{feff}').unwrap_or(&section);
            only_campaign(section).map_err(|problem| format!("{}: {problem}", draws.display()))?;
            // The scenario has to be one by itself, so that errors in it are found where they are.
            Scenario::parse(&text, &name).map_err(|error| error.to_string())?;
            if has_campaign(&text) {
                return Err(format!("{name}: campaign: must be left out where --draws has it"));
            }
            text = format!("{}\n\n{section}", text.trim_end());
            name = format!("{name} with {}", draws.display());
        }
        let scenario = Scenario::parse(&text, &name).map_err(|error| error.to_string())?;
        let stepped = match self.plant_step {
            None => step::with_longest_step(&scenario),
            Some(wanted) => step::with_step(&scenario, wanted).map_err(|problem| format!("--plant-step: {problem}"))?,
        };
        CampaignSource::new(stepped, text, name).map_err(|error| error.to_string())
    }

    /// How many flights, and which.
    ///
    /// # Errors
    /// Names the argument that is refused.
    pub fn orders(&self, scenario: &Scenario) -> Result<Orders, String> {
        let flights = self.flights.unwrap_or(scenario.campaign.flights);
        if !(1.0..=FLIGHTS_MAX).contains(&(flights as f64)) {
            return Err(format!("--flights: must be from 1 to {FLIGHTS_MAX}, found {flights}"));
        }
        let seed = self.seed.unwrap_or(scenario.campaign.seed);
        Ok(Orders { flights, seed, shard: self.shard.unwrap_or((1, 1)) })
    }

    /// Which law flies `scenario`.
    ///
    /// # Errors
    /// Names the file of gains that is refused, and why.
    pub fn law(&self, scenario: &Scenario) -> Result<LawChoice, String> {
        let chosen = gains::chosen(&self.law, scenario, self.gains.as_deref());
        chosen.map_err(|(argument, problem)| format!("--{argument}: {problem}"))
    }

    /// Where the results go, of a campaign or a flight of this name.
    #[must_use]
    pub fn directory(&self, name: &str) -> PathBuf {
        let parent = if self.replay.is_some() { "flights" } else { "campaigns" };
        self.out.clone().unwrap_or_else(|| Path::new(parent).join(name))
    }
}

/// Whether a scenario has circumstances of its own.
fn has_campaign(text: &str) -> bool {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    text.parse::<toml_edit::DocumentMut>().is_ok_and(|document| document.contains_key("campaign"))
}

/// Refuses a text that says anything else than what circumstances there are.
fn only_campaign(text: &str) -> Result<(), String> {
    let document: toml_edit::DocumentMut = text
        .parse()
        .map_err(|error: toml_edit::TomlError| format!("not TOML: {}", error.message().replace('\n', "; ")))?;
    let mut sections = document.iter();
    match (sections.next(), sections.next()) {
        (Some(("campaign", toml_edit::Item::Table(table))), None) if !table.is_dotted() => Ok(()),
        _ => Err("must hold a [campaign] section and nothing else".to_owned()),
    }
}
