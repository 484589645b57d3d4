//! The rivals' gains as a file: for each vehicle a table, in it for each rival a table of its gains by name.
//!
//! ```toml
//! [hummingbird]
//! mass = 0.5                  # the vehicle they were found for: kg, kg m^2
//! inertia = [3.65e-3, 3.68e-3, 7.03e-3]
//!
//! [hummingbird.lee]
//! cost = 9.4                  # what the search made of it
//! k_x_across = 5.0
//! ```

use super::kind::Kind;
use scenario::Scenario;
use std::fmt::Write;
use toml_edit::{DocumentMut, Item};

/// Gains that were found with `host-sim compare --tune`, with the commands that find them again.
pub const BUILT_IN: &str = include_str!("gains.toml");

/// The gains of every rival on one vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct Set {
    /// Each rival's, in the order of its names, with what the search made of them.
    pub rivals: Vec<(Kind, Vec<f64>, f64)>,
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

impl Set {
    /// The set in `text`, called `file` in messages, that was found for the vehicle of `scenario`.
    ///
    /// # Errors
    /// If the text is no TOML, holds no table of that mass and inertia, or a rival's gains are not all there, or not positive.
    pub fn of(scenario: &Scenario, text: &str, file: &str) -> Result<Self, GainsError> {
        let failed = |what: String| GainsError(format!("{file}: {what}"));
        let document: DocumentMut =
            text.parse().map_err(|error: toml_edit::TomlError| failed(error.message().replace('\n', " ")))?;
        let vehicle = scenario.configuration.vehicle();
        let own = [vehicle.mass, vehicle.inertia.x, vehicle.inertia.y, vehicle.inertia.z];
        let is_own = |item: &Item| {
            let numbers = item.get("inertia").and_then(Item::as_array).into_iter().flatten();
            let numbers = numbers.map(|value| value.as_float().map(|number| number as f32));
            let mass = item.get("mass").and_then(Item::as_float).map(|mass| mass as f32);
            std::iter::once(mass).chain(numbers).eq(own.map(Some))
        };
        let Some((name, item)) = document.iter().find(|(_, item)| is_own(item)) else {
            return Err(failed(format!(
                "no table has the mass and inertia of {}'s vehicle: find the rivals' gains for it with --tune 40",
                scenario.name
            )));
        };
        let rivals = Kind::ALL.map(|kind| {
            let of = format!("{name}.{}", kind.name());
            let table =
                item.get(kind.name()).and_then(Item::as_table).ok_or_else(|| failed(format!("{of}: missing")))?;
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
            if kind.build(scenario, &gains).is_none() {
                return Err(failed(format!("{of}: the law is undefined for these gains")));
            }
            Ok((kind, gains, number("cost")?))
        });
        Ok(Self { rivals: rivals.into_iter().collect::<Result<_, _>>()? })
    }

    /// As a table of a file of gains; `origin` is a line that says where they come from.
    #[must_use]
    pub fn written(&self, scenario: &Scenario, origin: &str) -> String {
        let vehicle = scenario.configuration.vehicle();
        let (name, inertia) = (&scenario.name, vehicle.inertia);
        let mut text = format!(
            "# {origin}\n[{name}]\nmass = {:?}\ninertia = [{:?}, {:?}, {:?}]\n",
            vehicle.mass, inertia.x, inertia.y, inertia.z
        );
        for (kind, gains, cost) in &self.rivals {
            let _ = writeln!(text, "\n[{name}.{}]\ncost = {cost:.3}", kind.name());
            for (key, gain) in kind.gains().iter().zip(gains) {
                let _ = writeln!(text, "{key} = {}", rounded(*gain));
            }
        }
        text
    }
}

/// Five significant digits, as a float of TOML.
fn rounded(value: f64) -> String {
    let short: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    format!("{short:?}")
}
