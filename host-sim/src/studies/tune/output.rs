//! The tuned scenario as a file: the original text with its constants, thrust floor and name replaced, comments kept.
//! Of the extended law's constants it holds only those that do not follow from the vehicle's numbers.

use super::Tuned;
use super::chosen::chosen;
use crate::output::table::short;
use controller_core::configuration::{LawParameters, PaperLaw};
use controller_core::extended::parameters::ExtendedParameters;
use scenario::Scenario;
use scenario::constants::written;
use toml_edit::{DocumentMut, Item, Table, TomlError, value};

/// The beginning of the line with the tuned figures.
const TUNED_LINE: &str = "# Tuned:";

/// `original` with the tuned constants, headed by what they achieve.
///
/// # Errors
/// If `original` is no TOML; a text that was read as a scenario is.
pub fn rewritten(original: &str, tuned: &Tuned) -> Result<String, TomlError> {
    let mut document: DocumentMut = original.parse()?;
    let scenario = &tuned.scenario;
    document["name"] = value(scenario.name.as_str());
    for (section, key, constant) in constants(scenario) {
        set(&mut document, section, key, constant.map(shortest));
    }
    if let Some(table) = document.get_mut("gains").and_then(Item::as_table_mut) {
        // An older comment here is about other gains.
        table.decor_mut().set_suffix("                               # found by `host-sim tune`");
    }
    if scenario.configuration.paper().is_none() {
        let control = document.entry("control").or_insert_with(|| Item::Table(Table::new()));
        control["law"] = value("extended");
    }
    let said = |text: &str| {
        let head = format!(
            "{TUNED_LINE} height lost from upside down {} m, {} m of excursion in a gust; every margin at least {:.1} %.\n",
            short(tuned.verdict.figures.height_lost),
            short(tuned.verdict.figures.gust),
            100.0 * tuned.verdict.tightest.map_or(0.0, |tightest| tightest.margin())
        );
        // A file that was tuned before loses its older line.
        let before = text.strip_prefix(TUNED_LINE).and_then(|said| said.split_once('\n'));
        head + before.map_or(text, |(_, rest)| rest)
    };
    let text = said(&document.to_string());
    // Bounds that follow from the constants may differ now from the judged ones.
    let judged = scenario.configuration.bounds();
    if Scenario::parse(&text, "").is_ok_and(|read| read.configuration.bounds() == judged) {
        return Ok(text);
    }
    let section: DocumentMut = written(judged.entries()).parse()?;
    if let Some(bounds) = section["reference_bounds"].as_table() {
        // Without the place that it had in its own document.
        document["reference_bounds"] = Item::Table(bounds.iter().map(|(key, bound)| (key, bound.clone())).collect());
    }
    Ok(said(&document.to_string()))
}

/// Every constant that a search may change, by section and key; `None` if it follows from the vehicle's numbers.
fn constants(scenario: &Scenario) -> Vec<(&'static str, &'static str, Option<f32>)> {
    match (scenario.configuration.law(), scenario.airframe()) {
        (LawParameters::Extended(law), Some(airframe)) => {
            let given = chosen(&airframe, &law.parameters);
            ExtendedParameters::TABLE.iter().zip(given).map(|(c, value)| (c.section, c.key, value)).collect()
        }
        (LawParameters::Extended(_), None) => Vec::new(),
        (LawParameters::Paper(PaperLaw { gains, thrust_floor }), _) => {
            let gains = gains.entries().map(|(gain, value)| (gain.section, gain.key, Some(value)));
            gains.chain([("control", "thrust_floor", *thrust_floor)]).collect()
        }
    }
}

/// Writes or takes away one key; a section appears with its first key and goes with its last.
fn set(document: &mut DocumentMut, section: &str, key: &str, constant: Option<f64>) {
    match constant {
        Some(number) => {
            let table = document.entry(section).or_insert_with(|| Item::Table(Table::new()));
            let before =
                table.get(key).and_then(|item| item.as_float().or(item.as_integer().map(|whole| whole as f64)));
            // An unchanged value keeps its comment.
            if before.is_none_or(|before| before as f32 != number as f32) {
                table[key] = value(number);
            }
        }
        None => {
            if let Some(table) = document.get_mut(section).and_then(Item::as_table_like_mut) {
                table.remove(key);
                if table.is_empty() {
                    document.remove(section);
                }
            }
        }
    }
}

/// The double with the fewest digits that rounds to `single`, so that the file reads like the number that flies.
fn shortest(single: f32) -> f64 {
    single.to_string().parse().unwrap_or(f64::from(single))
}
