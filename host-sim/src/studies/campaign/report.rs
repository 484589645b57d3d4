//! The page of a campaign: how its figures are spread, the worst flights by number, and what was flown.

use super::columns::{counts, floats};
use super::manifest::Manifest;
use super::rows::{HOLDS_COLUMN, share_of_rotor};
use super::summary::{Summary, verdicts};
use crate::output::table::{percent, short};
use crate::reports::report::distribution::Distribution;
use crate::reports::report::document;
use crate::reports::report::page::{Block, Page, Section};
use crate::reports::report::prose::{Cell, Fact, Table};
use arrow_array::RecordBatch;

const WORST_LISTED: usize = 20;

/// A figure of every flight.
struct Figure {
    title: String,
    unit: &'static str,
    /// The limit of every flight.
    bound: Option<f64>,
    values: Vec<f64>,
}

/// The page of what was `flown` of a scenario, read from `text`.
#[must_use]
pub fn page(summary: &Summary, text: &str, manifest: &Manifest, flown: &[RecordBatch]) -> Page {
    let figure = |title: &str, unit, column: &str| {
        let bound = column.starts_with("share").then_some(1.0);
        Figure { title: title.to_owned(), unit, bound, values: floats(flown, column) }
    };
    let mut shares = vec![figure("Share of the thrust's proven bound", "", "share_thrust")];
    for axis in ["x", "y", "z"] {
        shares.push(figure(&format!("Share of the bound on torque {axis}"), "", &format!("share_torque_{axis}")));
    }
    for rotor in 1..=manifest.rotors as usize {
        shares.push(figure(&format!("Share of rotor {rotor}'s bound"), "", &share_of_rotor(rotor)));
    }
    let figures = [
        figure("On the reference for good after", "s", "settled"),
        figure("Near its attitude for good after", "s", "attitude"),
        figure("Near its heading for good after", "s", "heading"),
        figure("Height lost", "m", "height_lost"),
        figure("Rise above start and reference", "m", "rise"),
        figure("Distance from the reference at the end", "m", "final_error"),
    ];
    let numbers = counts(flown, "number");
    let greatest =
        |flight: usize| shares.iter().filter_map(|share| share.values.get(flight)).copied().fold(0.0, f64::max);
    let greatest = Figure {
        title: "Greatest share of any proven bound".to_owned(),
        unit: "",
        bound: Some(1.0),
        values: (0..numbers.len()).map(greatest).collect(),
    };
    let words = verdicts(flown);
    let worst = figures.iter().chain([&greatest]).map(|figure| Block::Table(worst(figure, &numbers, &words)));
    let spread: Vec<Distribution> = figures.iter().chain([&greatest]).chain(&shares).map(distribution).collect();
    let sections = [
        ("Distributions", vec![Block::Distributions(spread)]),
        ("Worst flights", std::iter::once(Block::Text(REPLAY_HINT.to_owned())).chain(worst).collect()),
        (
            "Scenario",
            [
                gains(manifest),
                Some(Block::Folded(
                    "Vehicle, gains and all else, section by section".into(),
                    document::tables(text, "scenario"),
                )),
                Some(Block::Listing("The file as it was read".into(), text.to_owned())),
            ]
            .into_iter()
            .flatten()
            .collect(),
        ),
    ];
    let sentence = match (summary.holds, summary.rival) {
        (true, None) => "Every flight recovers and tracks within its bounds".to_owned(),
        (false, None) => "Not every flight holds".to_owned(),
        (true, Some(law)) => format!("Every flight under {law} recovers and tracks; nothing is proven of that law"),
        (false, Some(law)) => format!("Not every flight under {law} recovers and tracks"),
    };
    let beyond = if summary.rival.is_some() { "Beyond a certified bound of ours" } else { "Beyond a certified bound" };
    Page {
        title: manifest.name.clone(),
        kind: manifest.rival().map_or("campaign".to_owned(), |law| format!("campaign under {law}")),
        verdict: Some((summary.holds, sentence)),
        lead: summary
            .refusal
            .as_ref()
            .map_or(summary.title.clone(), |refusal| format!("{}. Not certified: {refusal}", summary.title)),
        highlights: [
            Fact::new("Flights", summary.flights.to_string()),
            Fact::new("Recover and track", share(summary.tracking, summary.flights)),
            Fact::new(beyond, summary.beyond.to_string()),
            Fact::new("Task a rotor for more than it has", summary.clipped.to_string()),
        ]
        .into_iter()
        .chain(rotors(summary))
        .collect(),
        tracks: Vec::new(),
        sections: sections.map(|(title, blocks)| Section { title: title.into(), blocks }).into(),
    }
}

/// Rotors that failed, and those that were taken to.
fn rotors(summary: &Summary) -> Vec<Fact> {
    let Summary { losses, looks, .. } = summary;
    let failed = (losses.failed > 0)
        .then(|| Fact::new("End near their place without a rotor", share(losses.held, losses.failed)));
    let alarms = looks.then(|| Fact::new("Take a sound rotor for lost", losses.false_alarms.len().to_string()));
    failed.into_iter().chain(alarms).collect()
}

/// A law that is not the scenario's, with its gains.
fn gains(manifest: &Manifest) -> Option<Block> {
    let law = Fact::new("law", manifest.rival()?);
    let gains = manifest.law.gains().map(|(gain, value)| Fact::new(gain, short(value)));
    Some(Block::Facts(std::iter::once(law).chain(gains).collect()))
}

const REPLAY_HINT: &str =
    "Any flight is flown again, with its own log and report, by the campaign's command and --replay NUMBER.";

fn share(part: u64, whole: u64) -> String {
    format!("{part}, {}", percent(part as f64 / whole.max(1) as f64))
}

fn distribution(figure: &Figure) -> Distribution {
    let Figure { title, unit, bound, values } = figure;
    let groups = vec![("all flights".to_owned(), values.clone())];
    Distribution {
        title: title.clone(),
        unit: (*unit).to_owned(),
        logarithmic: false,
        bound: *bound,
        groups,
        looks: Vec::new(),
    }
}

/// The flights with the greatest values, greatest first.
fn worst(figure: &Figure, numbers: &[u64], verdicts: &[&str]) -> Table {
    let mut table = Table::new(format!("{}: the greatest", figure.title), &["flight", "value", "verdict"]);
    let mut places: Vec<usize> = (0..numbers.len().min(figure.values.len()).min(verdicts.len())).collect();
    places.sort_by(|&a, &b| figure.values[b].total_cmp(&figure.values[a]).then(numbers[a].cmp(&numbers[b])));
    for place in places.into_iter().take(WORST_LISTED) {
        let value = figure.values[place];
        let value = if value.is_finite() { format!("{} {}", short(value), figure.unit) } else { "never".to_owned() };
        let verdict = Cell::Verdict(Some(verdicts[place] == HOLDS_COLUMN));
        table.rows.push(vec![Cell::text(numbers[place].to_string()), Cell::number(value.trim_end()), verdict]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_flights_stand_first_and_those_that_never_came_before_all_others() {
        let values = vec![1.0, f64::INFINITY, 3.0, 3.0];
        let figure = Figure { title: "t".into(), unit: "s", bound: None, values };
        let table = worst(&figure, &[10, 11, 13, 12], &[HOLDS_COLUMN, "away", HOLDS_COLUMN, HOLDS_COLUMN]);
        let row = |number: &str, value: &str, holds| {
            vec![Cell::text(number), Cell::number(value), Cell::Verdict(Some(holds))]
        };
        let expected =
            [row("11", "never", false), row("12", "3 s", true), row("13", "3 s", true), row("10", "1 s", true)];
        assert_eq!(table.rows, expected);
    }
}
