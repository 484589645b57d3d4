//! The rows of a comparison: one figure of every law each, and where ours is not the best.

use super::limit::{ARRIVAL_FIGURE, Limit};
use super::scene_figures::{RandomFlights, SceneFigures};
use crate::output::table::{aligned, short};
use std::fmt::Write;

/// The name of the column of the vehicle's own limit.
pub const LIMIT_COLUMN: &str = "limit";

/// The share by which another law must be better for ours to lose a row.
const CLEARLY_BETTER_SHARE: f64 = 0.01;

/// One figure of every law.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureRow {
    /// The scene.
    pub scene: &'static str,
    /// The figure's name.
    pub figure: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The value of each law, in the laws' order; less is better; infinite means never, or that the flight ended
    /// early.
    pub values: Vec<f64>,
    /// The least difference that matters, in the unit.
    pub grain: f64,
    /// The vehicle's own limit, whatever the law; where one is worked out.
    pub limit: Option<f64>,
}

impl FigureRow {
    /// Whether another law shows clearly less than ours, the first.
    #[must_use]
    pub fn lost(&self) -> bool {
        let Some((ours, rivals)) = self.values.split_first() else { return false };
        let best = rivals.iter().copied().fold(f64::INFINITY, f64::min);
        best < ours * (1.0 - CLEARLY_BETTER_SHARE) && ours - best > self.grain
    }
}

/// A figure of one law in one scene.
type Get = fn(&SceneFigures) -> f64;

/// Figures of scenes: scene, figure, unit, its function, and the least difference that matters.
const SCENE_FIGURES: [(&str, &str, &str, Get, f64); 22] = [
    ("own", "position error, last half, RMS", "mm", |s| 1e3 * s.rms, 0.1),
    ("own", "rotor command's change in 10 ms, RMS", "mN", |s| 1e3 * s.activity, 0.1),
    ("step", ARRIVAL_FIGURE, "s", settled, 0.02),
    ("step", "ticks clipped", "%", clipped, 0.0),
    ("far step", ARRIVAL_FIGURE, "s", settled, 0.02),
    ("far step", "height lost", "m", |s| s.height_lost, 0.01),
    ("far step", "ticks clipped", "%", clipped, 0.0),
    ("upside down", "height lost", "m", |s| s.height_lost, 0.01),
    ("upside down", ARRIVAL_FIGURE, "s", settled, 0.02),
    ("upside down", "ticks clipped", "%", clipped, 0.0),
    ("gust", "deepest excursion", "m", |s| s.excursion, 0.001),
    ("gust", "offset left", "m", |s| s.end_error, 0.001),
    ("gust", "ticks clipped", "%", clipped, 0.0),
    ("storm", "deepest excursion", "m", |s| s.excursion, 0.001),
    ("storm", "offset at the end", "m", |s| s.end_error, 0.001),
    ("storm", "ticks clipped", "%", clipped, 0.0),
    ("noise", "position error, RMS", "mm", |s| 1e3 * s.rms, 0.1),
    ("noise", "rotor command's change in 10 ms, RMS", "mN", |s| 1e3 * s.activity, 0.1),
    ("weak rotors", ARRIVAL_FIGURE, "s", settled, 0.02),
    ("weak rotors", "deepest excursion", "m", |s| s.excursion, 0.001),
    ("heavy", "height lost", "m", |s| s.height_lost, 0.01),
    ("heavy", ARRIVAL_FIGURE, "s", settled, 0.02),
];

fn settled(figures: &SceneFigures) -> f64 {
    figures.settled.unwrap_or(f64::INFINITY)
}

fn clipped(figures: &SceneFigures) -> f64 {
    100.0 * figures.clipped
}

/// The beginning of a rotor figure's name: a vehicle without rotors has no such figures.
const OF_ROTORS: &str = "rotor";

/// All rows of a vehicle with this `limit`, with or without `rotors`: of `scenes`, each with every law's figures, and
/// of the random flights.
#[must_use]
pub fn all(
    scenes: &[(&'static str, Vec<Option<SceneFigures>>)],
    thrown: &[Option<RandomFlights>],
    limit: &Limit,
    rotors: bool,
) -> Vec<FigureRow> {
    let of_scene = |&(name, figure, unit, get, grain): &(&'static str, &'static str, &'static str, Get, f64)| {
        let (_, figures) = scenes.iter().find(|(scene, _)| *scene == name)?;
        let values = figures.iter().map(|figures| figures.as_ref().map_or(f64::INFINITY, get)).collect();
        Some(FigureRow { scene: name, figure, unit, values, grain, limit: limit.in_row(name, figure) })
    };
    let figures = SCENE_FIGURES.iter().filter(|(_, figure, ..)| rotors || !figure.starts_with(OF_ROTORS));
    let mut rows: Vec<FigureRow> = figures.filter_map(of_scene).collect();
    let mut random = |figure: &'static str, unit: &'static str, grain: f64, get: &dyn Fn(&RandomFlights) -> f64| {
        let values = thrown.iter().map(|thrown| thrown.as_ref().map_or(f64::INFINITY, get)).collect();
        rows.push(FigureRow { scene: "random", figure, unit, values, grain, limit: None });
    };
    random("flights that never settle", "%", 0.0, &|all| 100.0 * all.share(|one| one.settled.is_none()));
    random("flights that end in no number", "%", 0.0, &|all| 100.0 * all.share(|one| one.height_lost.is_infinite()));
    random("height lost, median", "m", 0.01, &|all| all.height(0.5));
    random("height lost, 99 of 100", "m", 0.01, &|all| all.height(0.99));
    random("height lost, worst", "m", 0.01, &|all| all.height(1.0));
    random("within 0.2 m for good after, median", "s", 0.02, &|all| all.settled(0.5));
    random("within 0.2 m for good after, slowest", "s", 0.02, &|all| all.settled(1.0));
    random("ticks clipped", "%", 0.0, &|all| 100.0 * all.ticks(|one| one.clipped));
    random("ticks beyond our certified bounds", "%", 0.0, &|all| 100.0 * all.ticks(|one| one.beyond));
    rows
}

/// A value as the tables show it.
#[must_use]
pub fn cell(value: f64) -> String {
    if value.is_finite() { short(significant(value)) } else { "never".to_owned() }
}

/// Three significant digits.
fn significant(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// A table for a terminal; rows that ours loses begin with a star.
#[must_use]
pub fn table(names: &[&str], rows: &[FigureRow]) -> String {
    let limit = rows.iter().any(|row| row.limit.is_some()).then_some(&LIMIT_COLUMN);
    let head = ["", "scene", "figure", "unit"].iter().chain(names).chain(limit);
    let mut cells = vec![head.map(|&name| name.to_owned()).collect()];
    let mut before = "";
    for row in rows {
        let scene = if row.scene == before { "" } else { row.scene };
        before = row.scene;
        let star = if row.lost() { "*" } else { "" };
        let head = [star, scene, row.figure, row.unit].map(str::to_owned);
        let values = row.values.iter().map(|value| cell(*value));
        cells.push(head.into_iter().chain(values).chain(row.limit.map(cell)).collect::<Vec<_>>());
    }
    aligned(&cells)
}

/// The same as CSV, in full; `inf` means never.
#[must_use]
pub fn csv(names: &[&str], rows: &[FigureRow]) -> String {
    let mut text = format!("scene,figure,unit,{},ours_loses,{LIMIT_COLUMN}\n", names.join(","));
    for row in rows {
        let _ = write!(text, "{},\"{}\",{}", row.scene, row.figure, row.unit);
        for value in &row.values {
            let _ = write!(text, ",{value}");
        }
        let limit = row.limit.map_or_else(String::new, |limit| limit.to_string());
        let _ = writeln!(text, ",{},{limit}", row.lost());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(values: &[f64]) -> FigureRow {
        FigureRow { scene: "s", figure: "f", unit: "m", values: values.to_vec(), grain: 0.01, limit: None }
    }

    #[test]
    fn a_row_is_lost_where_another_law_is_clearly_better() {
        assert!(row(&[2.0, 3.0, 1.9]).lost());
        assert!(row(&[f64::INFINITY, 3.0]).lost());
        assert!(!row(&[2.0, 1.995]).lost() && !row(&[0.02, 0.011]).lost() && !row(&[2.0, f64::INFINITY]).lost());
    }

    #[test]
    fn the_table_marks_lost_rows_and_says_never() {
        let text = table(&["ours", "lee"], &[row(&[2.0, 1.0]), row(&[1.0, f64::INFINITY])]);
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[1].starts_with('*') && lines[1].ends_with("2     1"), "{text}");
        assert!(!lines[2].starts_with('*') && lines[2].ends_with("never"), "{text}");
        assert!(csv(&["ours", "lee"], &[row(&[1.0, f64::INFINITY])]).ends_with("s,\"f\",m,1,inf,false,\n"));
    }
}
