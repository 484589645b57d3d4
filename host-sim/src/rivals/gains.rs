//! The rivals' gains as a file: for each vehicle a table, in it for each rival a table of its gains by name.
//!
//! ```toml
//! [hummingbird]               # the vehicle they were found for, as rivals know it
//! mass = 0.5                  # kg
//! inertia = [3.65e-3, 3.68e-3, 7.03e-3]   # kg m^2
//! lag = 0.005                 # of the rotors, s
//! delay = 0.0                 # between a tick and its command's effect, s
//! thrust_max = 40.0           # N
//! period = 0.01               # between ticks, s
//!
//! [hummingbird.lee]
//! cost = 9.4                  # the search's result
//! k_x_across = 5.0
//!
//! [hummingbird.mellinger]
//! cost = inf                  # a search found no gains that fly every trial to its end: it is left out of comparisons
//! ```
//!
//! Gains that were found for one vehicle say little of another, rotors and delay included: a set serves the vehicle
//! that its table describes and no other. A table that leaves out lag, delay, thrust or period serves any.
//!
//! Where there are none of this vehicle at this rate, its gains of another rate serve as they are: they stand in 1/s,
//! and every filter is exact for its period. [`Set::of_other_rates`] says so: a search finds better ones.

use super::kind::RivalKind;
use super::pilot::model;
use crate::output::table::short;
use crate::rivals::choice::{LawChoice, OUR_LAW};
use scenario::Scenario;
use scenario::number::{self, Number};
use std::fmt::Write;
use std::path::Path;
use toml_edit::{DocumentMut, Item, Value};

/// Gains that were found with `host-sim compare --tune`, with the commands.
pub const BUILT_IN: &str = include_str!("gains.toml");

/// Their name in messages.
const BUILT_IN_NAME: &str = "the built-in gains";

/// The gains of every rival on one vehicle.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Set {
    /// Each rival's, in the order of its names, with what the search made of them.
    pub rivals: Vec<(RivalKind, Vec<f64>, f64)>,
    /// Rivals for which a search found no gains that fly every trial to its end.
    pub lost: Vec<RivalKind>,
    /// Rivals whose gains were found at another rate, Hz.
    pub from_other_rates: Vec<(RivalKind, f64)>,
}

/// A file of gains that cannot be used, in one line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GainsError(String);

impl std::fmt::Display for GainsError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for GainsError {}

/// The key of a table that says at which rate its gains were found.
const PERIOD_KEY: &str = "period";

impl Set {
    /// The gains of `kinds` in `text`, called `file` in messages, that were found for the vehicle of `scenario`.
    ///
    /// # Errors
    /// If the text is no TOML, has no table of that vehicle, or if a rival's gains are incomplete or not positive.
    pub fn parse(scenario: &Scenario, text: &str, file: &str, kinds: &[RivalKind]) -> Result<Self, GainsError> {
        let failed = |what: String| GainsError(format!("{file}: {what}"));
        let document: DocumentMut =
            text.parse().map_err(|error: toml_edit::TomlError| failed(error.message().replace('\n', " ")))?;
        let own = vehicle(scenario);
        let is_own = |item: &Item, rate: bool| {
            own.iter().all(|(key, values)| *key == PERIOD_KEY && !rate || is_said(item.get(key), key, values))
        };
        let of_rate = document.iter().filter(|(_, item)| is_own(item, true));
        let of_others = document.iter().filter(|(_, item)| is_own(item, false) && !is_own(item, true));
        let tables: Vec<(&str, &Item)> = of_rate.chain(of_others).collect();
        let Some((first, _)) = tables.first() else {
            let there: Vec<&str> = document.iter().map(|(name, _)| name).collect();
            let said: Vec<String> = own.iter().map(|(key, values)| line(key, values)).collect();
            return Err(failed(format!(
                "no table is of {}'s vehicle ({}); those there are of: {}; `host-sim compare FILE` finds the rivals' \
                 gains for it and writes them to gains.toml, which --gains reads",
                scenario.name,
                said.join(", "),
                if there.is_empty() { "none".to_owned() } else { there.join(", ") }
            )));
        };
        let mut set = Self::default();
        for &kind in kinds {
            let of_kind = |&(name, item)| {
                let table = Item::get(item, kind.name())?.as_table()?;
                Some((format!("{name}.{}", kind.name()), item, table))
            };
            let missing = || failed(format!("{first}.{}: missing", kind.name()));
            let (of, item, table) = tables.iter().find_map(of_kind).ok_or_else(missing)?;
            if table.len() == 1 && table.get("cost").and_then(Item::as_float) == Some(f64::INFINITY) {
                set.lost.push(kind);
                continue;
            }
            let number = |key: &str| {
                let found = table.get(key).ok_or_else(|| failed(format!("{of}.{key}: missing")))?;
                let number = found.as_float().or(found.as_integer().map(|whole| whole as f64));
                let positive = number.filter(|number| number.is_finite() && *number > 0.0);
                positive.ok_or_else(|| failed(format!("{of}.{key}: must be a finite number greater than zero")))
            };
            if let Some((key, _)) = table.iter().find(|(key, _)| *key != "cost" && !kind.gains().contains(key)) {
                return Err(failed(format!("{of}.{key}: unknown; known are cost and {}", kind.gains().join(", "))));
            }
            let gains = kind.gains().iter().map(|key| number(key)).collect::<Result<Vec<f64>, _>>()?;
            if !is_own(item, true) {
                let period = item.get(PERIOD_KEY).and_then(Item::as_float).filter(|period| *period > 0.0);
                let period =
                    period.ok_or_else(|| failed(format!("{of}: its {PERIOD_KEY} must be greater than zero")))?;
                set.from_other_rates.push((kind, 1.0 / period));
            }
            if kind.build(scenario, &gains).is_none() {
                return Err(failed(format!("{of}: the law is undefined for these gains")));
            }
            set.rivals.push((kind, gains, number("cost")?));
        }
        Ok(set)
    }

    /// The gains of `kinds` that are built in for the vehicle of `scenario`, if there are any.
    #[must_use]
    pub fn built_in(scenario: &Scenario, kinds: &[RivalKind]) -> Option<Self> {
        Self::parse(scenario, BUILT_IN, BUILT_IN_NAME, kinds).ok()
    }

    /// The gains of `kinds` in `file`, or those that are built in.
    ///
    /// # Errors
    /// If the file cannot be read, and as [`Self::parse`]'s.
    pub fn read(scenario: &Scenario, file: Option<&Path>, kinds: &[RivalKind]) -> Result<Self, GainsError> {
        let Some(file) = file else { return Self::parse(scenario, BUILT_IN, BUILT_IN_NAME, kinds) };
        let name = file.display().to_string();
        let text =
            scenario::text::read(file).map_err(|error| GainsError(format!("{name}: cannot be read: {error}")))?;
        Self::parse(scenario, &text, &name, kinds)
    }

    /// The laws, in the order of their names.
    pub fn laws(&self) -> impl Iterator<Item = LawChoice> {
        self.rivals.iter().map(|(kind, gains, _)| LawChoice::Rival(*kind, gains.clone()))
    }

    /// One of them.
    #[must_use]
    pub fn law(&self, kind: RivalKind) -> Option<LawChoice> {
        self.laws().find(|law| law.name() == kind.name())
    }

    /// As a table of a file of gains; `origin` is a line that says where they come from.
    #[must_use]
    pub fn written(&self, scenario: &Scenario, origin: &str) -> String {
        // A name with a dot would be a table within a table.
        let name = &if scenario.name.contains('.') { format!("\"{}\"", scenario.name) } else { scenario.name.clone() };
        let lines: String = vehicle(scenario).iter().map(|(key, values)| line(key, values) + "\n").collect();
        let mut text = format!("# {origin}\n[{name}]\n{lines}");
        for (kind, gains, cost) in &self.rivals {
            let _ = writeln!(text, "\n[{name}.{}]\ncost = {cost:.3}", kind.name());
            for (key, gain) in kind.gains().iter().zip(gains) {
                let _ = writeln!(text, "{key} = {}", rounded(*gain));
            }
        }
        for kind in &self.lost {
            let _ =
                writeln!(text, "\n[{name}.{}]\ncost = inf  # no gains were found that fly every trial", kind.name());
        }
        text
    }

    /// The rivals that are left out, and why; `None` if all fly.
    #[must_use]
    pub fn left_out(&self) -> Option<String> {
        let names: Vec<&str> = self.lost.iter().map(|kind| kind.name()).collect();
        let why = "a search found no gains with which every trial is flown to its end";
        (!names.is_empty()).then(|| format!("left out: {}; {why}", names.join(", ")))
    }

    /// The rivals whose gains were found at another rate than `rate`, Hz; `None` if there are none.
    #[must_use]
    pub fn of_other_rates(&self, rate: f64) -> Option<String> {
        let from = |(kind, from): &(RivalKind, f64)| format!("{} at {} Hz", kind.name(), short(*from));
        let all: Vec<String> = self.from_other_rates.iter().map(from).collect();
        let said = format!("gains not found at {} Hz: {}; --tune searches better ones", short(rate), all.join(", "));
        (!all.is_empty()).then_some(said)
    }
}

/// The law of this name on the vehicle of `scenario`, a rival's with gains from `file` or those that are built in.
///
/// # Errors
/// The argument that is refused, `law` or `gains`, and why.
pub fn chosen(name: &str, scenario: &Scenario, file: Option<&Path>) -> Result<LawChoice, (&'static str, String)> {
    let Some(kind) = RivalKind::named(name) else {
        let names: Vec<&str> = std::iter::once(OUR_LAW).chain(RivalKind::ALL.map(RivalKind::name)).collect();
        return match file {
            _ if name != OUR_LAW => Err(("law", format!("must be one of {}, found {name:?}", names.join(", ")))),
            Some(_) => Err(("gains", "our law's gains are the scenario's: choose another law".to_owned())),
            None => Ok(LawChoice::Ours),
        };
    };
    let set = Set::read(scenario, file, &[kind]).map_err(|error| ("gains", error.to_string()))?;
    set.law(kind).ok_or_else(|| ("law", format!("there are no gains of {name}")))
}

/// The rivals' model of the vehicle of `scenario`, by the keys of a table, in single precision.
fn vehicle(scenario: &Scenario) -> [(&'static str, Vec<f32>); 6] {
    let model = model(scenario);
    [
        ("mass", vec![model.mass as f32]),
        ("inertia", model.inertia.iter().map(|value| *value as f32).collect()),
        ("lag", vec![model.lag as f32]),
        ("delay", vec![model.delay as f32]),
        ("thrust_max", vec![model.thrust_max as f32]),
        ("period", vec![model.period as f32]),
    ]
}

/// Whether a table says `values` under `key`, or nothing where it need not.
fn is_said(found: Option<&Item>, key: &str, values: &[f32]) -> bool {
    let Some(found) = found else { return !matches!(key, "mass" | "inertia") };
    let number = |value: &Value| value.as_float().or(value.as_integer().map(|whole| whole as f64));
    let said: Option<Vec<f32>> = match found.as_array() {
        Some(array) => array.iter().map(|value| number(value).map(|number| number as f32)).collect(),
        None => found.as_value().and_then(number).map(|number| vec![number as f32]),
    };
    said.is_some_and(|said| said == values)
}

/// As a line of a table.
fn line(key: &str, values: &[f32]) -> String {
    match values {
        [value] => format!("{key} = {}", Number(*value)),
        several => format!("{key} = {}", number::array(several)),
    }
}

/// Five significant digits, as a float of TOML.
fn rounded(value: f64) -> String {
    let short: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    Number(short).to_string()
}
