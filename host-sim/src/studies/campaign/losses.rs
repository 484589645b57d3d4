//! What all flights of a campaign showed of rotors that failed, or were taken to.

use super::columns::{counts, floats, whole_numbers};
use super::quantile;
use crate::output::table::short;
use arrow_array::RecordBatch;
use scenario::rotor_loss::PLACE_HELD_DISTANCE_M;
use std::fmt;

/// How many false alarms are listed.
const ALARMS_LISTED: usize = 20;

/// Failing rotors of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Losses {
    /// Flights in which one failed.
    pub failed: u64,
    /// Of these, those in which the law took the right one for lost, and not too early.
    pub found: u64,
    /// Of these, those in which it found none.
    pub missed: u64,
    /// Of these, those that end within [`PLACE_HELD_DISTANCE_M`] of their reference.
    pub held: u64,
    /// Flights in which the law found a rotor that had not failed, each with that rotor, from 1.
    pub false_alarms: Vec<(u64, u64)>,
    /// From the failure to its finding, s; height lost and distance after it, m.
    figures: [Vec<f64>; 3],
}

impl Losses {
    /// Counts the failing rotors of all flights in `flown`.
    #[must_use]
    pub fn count(flown: &[RecordBatch]) -> Self {
        let numbers = counts(flown, "number");
        let [failed, found] = ["failed_rotor", "found_rotor"].map(|column| whole_numbers(flown, column));
        let [failures, findings, depths, distances, ends] =
            ["failure_time", "found_time", "failure_height_lost", "failure_distance", "final_error"]
                .map(|column| floats(flown, column));
        let mut losses = Self {
            failed: 0,
            found: 0,
            missed: 0,
            held: 0,
            false_alarms: Vec::new(),
            figures: [const { Vec::new() }; 3],
        };
        let [delays, lost, away] = &mut losses.figures;
        for flight in 0..numbers.len() {
            losses.failed += u64::from(failed[flight].is_some());
            match (failed[flight], found[flight]) {
                (None, None) => {}
                (Some(_), None) => losses.missed += 1,
                (failed, Some(rotor)) if failed == Some(rotor) && findings[flight] >= failures[flight] => {
                    losses.found += 1;
                    delays.push(findings[flight] - failures[flight]);
                }
                (_, Some(rotor)) => losses.false_alarms.push((numbers[flight], rotor)),
            }
            if failed[flight].is_some() {
                losses.held += u64::from(ends[flight] <= PLACE_HELD_DISTANCE_M);
                lost.push(depths[flight]);
                away.push(distances[flight]);
            }
        }
        losses
    }

    /// Greatest distance from the reference after each failure, m.
    #[must_use]
    pub fn distances(&self) -> &[f64] {
        &self.figures[2]
    }
}

impl fmt::Display for Losses {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { failed, found, missed, held, false_alarms, figures: [delays, depths, distances] } = self;
        let parts =
            |values: &[f64]| [0.5, 0.99, 1.0].map(|part| quantile(values, part).map_or(String::new(), written_figure));
        if *failed > 0 {
            let wrong = failed - found - missed;
            writeln!(
                f,
                "a rotor failed in {failed} flights, {held} of which end within {PLACE_HELD_DISTANCE_M} m of their reference; the \
                 law found it in {found}, another one or too early in {wrong}, none in {missed}"
            )?;
            let figures =
                [("found after", "s", delays), ("height lost", "m", depths), ("greatest distance", "m", distances)];
            for (what, unit, values) in figures.iter().filter(|(.., values)| !values.is_empty()) {
                let [median, most, greatest] = parts(values);
                writeln!(f, "  {what}: median {median} {unit}, 99 % {most} {unit}, greatest {greatest} {unit}")?;
            }
        }
        write!(f, "false alarms, of rotors that had not failed: {}", false_alarms.len())?;
        for (place, (number, rotor)) in false_alarms.iter().take(ALARMS_LISTED).enumerate() {
            write!(f, "{} {number} (rotor {rotor})", if place == 0 { ": flights" } else { "," })?;
        }
        Ok(())
    }
}

/// A figure; infinite of a flight that could not be flown to its end.
fn written_figure(value: f64) -> String {
    if value.is_finite() { short(value) } else { "infinite".to_owned() }
}

#[cfg(test)]
mod tests;
