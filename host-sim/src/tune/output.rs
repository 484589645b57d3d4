//! The tuned scenario as a file: the original text with its gains, thrust floor and name replaced, comments kept.

use super::Tuned;
use super::space::named;
use crate::table::short;
use toml_edit::{DocumentMut, Item, Table, TomlError, value};

/// How the line begins that says what was achieved.
const HEAD: &str = "# Tuned:";

/// `original` with the tuned gains, headed by what they achieve.
///
/// # Errors
/// If `original` is no TOML; a text that was read as a scenario is.
pub fn rewritten(original: &str, tuned: &Tuned) -> Result<String, TomlError> {
    let mut document: DocumentMut = original.parse()?;
    let configuration = &tuned.scenario.configuration;
    document["name"] = value(tuned.scenario.name.as_str());
    for (section, key, constant) in named(configuration) {
        if !document.contains_key(section) {
            document[section] = Item::Table(Table::new());
        }
        document[section][key] = value(shortest(constant));
    }
    if let Some(table) = document["gains"].as_table_mut() {
        // Whatever stood here was said of other gains.
        table.decor_mut().set_suffix("                               # found by `host-sim tune`");
    }
    match configuration.thrust_floor() {
        Some(floor) => {
            if !document.contains_key("control") {
                document["control"] = Item::Table(Table::new());
            }
            document["control"]["thrust_floor"] = value(shortest(floor));
        }
        None => {
            if let Some(control) = document.get_mut("control").and_then(Item::as_table_like_mut) {
                control.remove("thrust_floor");
            }
        }
    }
    let head = format!(
        "{HEAD} height lost from upside down {} m, {} m of excursion in a gust; every margin at least {:.1} %.\n",
        short(tuned.verdict.shown.height_lost),
        short(tuned.verdict.shown.gust),
        100.0 * tuned.verdict.tightest.map_or(0.0, |tightest| tightest.margin())
    );
    let text = document.to_string();
    // A file that was tuned before loses what it said then.
    let rest = text.strip_prefix(HEAD).and_then(|said| said.split_once('\n')).map_or(text.as_str(), |(_, rest)| rest);
    Ok(head + rest)
}

/// The double with the fewest digits that rounds to `single`, so that the file reads like the number that flies.
fn shortest(single: f32) -> f64 {
    single.to_string().parse().unwrap_or(f64::from(single))
}
