//! campaign.json: which campaign the flights of a directory belong to. Two directories belong together, and a campaign
//! goes on where it was, only if these agree.

use super::CampaignError;
use super::batches::sha256;
use crate::rivals::choice::{LawChoice, OUR_LAW};
use crate::rivals::kind::RivalKind;
use scenario::Scenario;
use serde_json::{Value, json};
use std::ops::Range;
use std::path::Path;

/// A chunk is flown, kept and lost together.
pub const CHUNK_FLIGHTS: u64 = 50;
/// Its name in a directory.
pub const MANIFEST_FILE: &str = "campaign.json";
/// Its key of the hash of the flights' file.
const RESULT_HASH: &str = "result_sha256";

/// The identity of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Manifest {
    /// The scenario's name.
    pub name: String,
    /// Of the scenario's text, hexadecimal.
    pub scenario: String,
    /// Of the program that flies.
    pub version: String,
    /// Flights of the whole campaign.
    pub flights: u64,
    /// Seed of all draws.
    pub seed: u64,
    /// s.
    pub plant_step: f64,
    /// How many rotors the vehicle has.
    pub rotors: u64,
    /// Which part of the campaign, from 1, and of how many.
    pub shard: (u64, u64),
    /// Which law flies.
    pub law: LawChoice,
    /// What the file of all flights hashes to, hexadecimal, once it is written. It says nothing of which campaign this
    /// is.
    pub result: Option<String>,
}

impl Manifest {
    /// Of our law's flights of `scenario`, with the plant step that it has, read from `text`.
    #[must_use]
    pub fn new(scenario: &Scenario, text: &str, flights: u64, seed: u64, shard: (u64, u64)) -> Self {
        Self {
            name: scenario.name.clone(),
            scenario: sha256(text.as_bytes()),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            flights,
            seed,
            plant_step: scenario.timing.step(),
            rotors: scenario.configuration.rotors().map_or(0, |rotors| rotors.len() as u64),
            shard,
            law: LawChoice::Ours,
            result: None,
        }
    }

    /// The same flights under `law`.
    #[must_use]
    pub fn under(self, law: LawChoice) -> Self {
        Self { law, ..self }
    }

    /// The name of a law that is not ours.
    #[must_use]
    pub fn rival(&self) -> Option<&'static str> {
        (self.law != LawChoice::Ours).then(|| self.law.name())
    }

    /// The numbers of its chunks, rising.
    #[must_use]
    pub fn chunks(&self) -> Vec<u64> {
        let (part, parts) = self.shard;
        (0..self.flights.div_ceil(CHUNK_FLIGHTS)).filter(|chunk| chunk % parts == part - 1).collect()
    }

    /// The numbers of the flights of a chunk.
    #[must_use]
    pub fn flights_of(&self, chunk: u64) -> Range<u64> {
        chunk * CHUNK_FLIGHTS..((chunk + 1) * CHUNK_FLIGHTS).min(self.flights)
    }

    /// How many flights its chunks have together.
    #[must_use]
    pub fn own_flights(&self) -> u64 {
        self.chunks().into_iter().map(|chunk| self.flights_of(chunk)).map(|flights| flights.end - flights.start).sum()
    }

    /// As the text of a file. That of our law says nothing of laws: its gains are the scenario's.
    #[must_use]
    pub fn written(&self) -> String {
        let said = |key: &str| self.law != LawChoice::Ours || !matches!(key, "law" | "gains");
        let fields = self.fields().into_iter().filter(|(key, ..)| said(key));
        let mut values: serde_json::Map<String, Value> =
            fields.map(|(key, _, value)| (key.to_owned(), value)).collect();
        values.extend(self.result.iter().map(|hash| (RESULT_HASH.to_owned(), json!(hash))));
        format!("{:#}\n", Value::Object(values))
    }

    /// Each key, what a person calls it, and its value.
    fn fields(&self) -> [(&'static str, &'static str, Value); 11] {
        let gains: serde_json::Map<String, Value> =
            self.law.gains().map(|(gain, value)| (gain.to_owned(), json!(value))).collect();
        [
            ("name", "name", json!(self.name)),
            ("scenario_sha256", "scenario", json!(self.scenario)),
            ("version", "version of host-sim", json!(self.version)),
            ("flights", "number of flights", json!(self.flights)),
            ("seed", "seed", json!(self.seed)),
            ("plant_step", "plant step", json!(self.plant_step)),
            ("rotors", "number of rotors", json!(self.rotors)),
            ("shard", "shard", json!([self.shard.0, self.shard.1])),
            ("chunk", "flights of a chunk", json!(CHUNK_FLIGHTS)),
            ("law", "law", json!(self.law.name())),
            ("gains", "gains of that law", Value::Object(gains)),
        ]
    }

    /// The manifest in `directory`; none if there is no campaign.
    ///
    /// # Errors
    /// If its manifest cannot be read or is malformed.
    pub fn read_in(directory: &Path) -> Result<Option<Self>, CampaignError> {
        let path = directory.join(MANIFEST_FILE);
        let text = match scenario::text::read(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(CampaignError::Input(format!("{}: cannot be read: {error}", path.display()))),
        };
        let read = serde_json::from_str(&text).ok().and_then(|value| Self::read(&value));
        let problem = || CampaignError::Input(format!("{}: is no campaign's of this program", path.display()));
        read.ok_or_else(problem).map(Some)
    }

    fn read(value: &Value) -> Option<Self> {
        let number = |key: &str| value.get(key)?.as_u64();
        let text = |key: &str| value.get(key)?.as_str().map(str::to_owned);
        let shard = value.get("shard")?.as_array()?;
        let shard = (shard.first()?.as_u64()?, shard.get(1)?.as_u64()?);
        let (flights, chunk) = (number("flights")?, number("chunk")?);
        let plant_step = value.get("plant_step")?.as_f64()?;
        let is_one = chunk == CHUNK_FLIGHTS && (1..=shard.1).contains(&shard.0);
        is_one.then_some(())?;
        Some(Self {
            name: text("name")?,
            scenario: text("scenario_sha256")?,
            version: text("version")?,
            flights,
            seed: number("seed")?,
            plant_step,
            rotors: number("rotors")?,
            shard,
            law: law(value)?,
            result: text(RESULT_HASH),
        })
    }

    /// In what the two differ, in words; none where they agree.
    #[must_use]
    pub fn difference(&self, other: &Self) -> Option<String> {
        let pairs = self.fields().into_iter().zip(other.fields());
        let differing: Vec<String> = pairs
            .filter(|((_, _, own), (_, _, others))| own != others)
            .map(|((key, what, own), (_, _, others))| match key {
                "scenario_sha256" | "gains" => what.to_owned(),
                _ => format!("{what} ({own} and {others})"),
            })
            .collect();
        (!differing.is_empty()).then(|| differing.join(", "))
    }
}

/// The law that a manifest names.
fn law(manifest: &Value) -> Option<LawChoice> {
    let Some(name) = manifest.get("law") else { return Some(LawChoice::Ours) };
    let name = name.as_str()?;
    if name == OUR_LAW {
        return Some(LawChoice::Ours);
    }
    let (kind, gains) = (RivalKind::named(name)?, manifest.get("gains")?);
    let values = kind.gains().iter().map(|gain| gains.get(gain)?.as_f64()).collect::<Option<Vec<f64>>>()?;
    Some(LawChoice::Rival(kind, values))
}
