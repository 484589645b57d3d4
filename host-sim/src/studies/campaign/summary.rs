//! A campaign's summary: how many flights recover and track, quantiles, bounds, and the worst flights by number.

use super::columns::{counts, floats, whole_numbers};
use super::draw::timing;
use super::losses::Losses;
use super::manifest::Manifest;
use super::outcome::{HEADING_TOLERANCE_RAD, SETTLED_DISTANCE_M, in_time};
use super::quantile;
use super::rows::{HOLDS_COLUMN, LEAST_COMMAND_COLUMN, share_of_rotor};
use crate::flight::extremes::MRP_TOLERANCE;
use crate::output::table::{aligned, percent, short};
use arrow_array::RecordBatch;
use arrow_array::cast::AsArray;
use scenario::Scenario;
use scenario::rotor_loss::PLACE_HELD_DISTANCE_M;
use scenario::verdict::Verdict;
use std::fmt;

const WORST_LISTED: usize = 5;

/// A campaign's summary.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// The campaign, in a line.
    pub title: String,
    /// Flights.
    pub flights: u64,
    /// Flights that recovered and tracked.
    pub tracking: u64,
    /// The name of the law that flew, if it is not ours.
    pub rival: Option<&'static str>,
    /// Flights with a command beyond a certified bound, always one of our law's.
    pub beyond: u64,
    /// Flights with a command that a rotor could not follow.
    pub clipped: u64,
    /// The least command of any rotor in all flights, and what motors idle at, parts of a full one; none without
    /// rotors.
    pub least_command: Option<(f64, f64)>,
    /// Flights in which the law's fallback came.
    pub fallback: u64,
    /// Rotors that failed or were taken to.
    pub losses: Losses,
    /// Whether the law looks for rotors that fail.
    pub looks: bool,
    /// Why the scenario may not fly, if so.
    pub refusal: Option<String>,
    /// Whether every flight tracks within all bounds, and the scenario may fly. Of another law, whether every flight
    /// tracks.
    pub holds: bool,
    quantiles: String,
    worst: Vec<(&'static str, String)>,
}

/// One figure of every flight.
struct Figure {
    what: String,
    unit: &'static str,
    values: Vec<f64>,
}

impl Summary {
    /// Of what was `flown` of `scenario`, whose verdict is `verdict`.
    pub fn summarize(scenario: &Scenario, verdict: &Verdict, manifest: &Manifest, flown: &[RecordBatch]) -> Self {
        let numbers = counts(flown, "number");
        let verdicts = verdicts(flown);
        let (figures, shares) = figures(scenario, flown);
        let reached = ["settled", "attitude", "heading"].map(|column| floats(flown, column));
        let duration = timing(scenario, &scenario.campaign.ranges).duration();
        let slowest: Vec<f64> = (0..numbers.len())
            .map(|flight| reached.iter().filter_map(|times| times.get(flight)).copied().fold(0.0, f64::max))
            .collect();
        let (losses, ends) = (Losses::count(flown), floats(flown, "final_error"));
        let failed = whole_numbers(flown, "failed_rotor");
        let tracks = |flight: &usize| match failed[*flight] {
            Some(_) => ends[*flight] <= PLACE_HELD_DISTANCE_M,
            None => in_time(Some(slowest[*flight]), duration),
        };
        let tracking = (0..numbers.len()).filter(tracks).count();
        let greatest_share = (0..numbers.len())
            .map(|flight| shares.iter().filter_map(|figure| figure.values.get(flight)).copied().fold(0.0, f64::max));
        let greatest_share: Vec<f64> = greatest_share.collect();
        let listed = |what, values: &[f64], unit| (what, worst(&numbers, values, unit));
        let failing: Vec<String> = numbers
            .iter()
            .zip(&verdicts)
            .filter(|(_, verdict)| **verdict != HOLDS_COLUMN)
            .map(|(number, verdict)| format!("{number} ({verdict})"))
            .take(4 * WORST_LISTED)
            .collect();
        let mut worst = vec![
            listed("slowest", &slowest, "s"),
            listed("deepest", &figures[0].values, "m"),
            listed("nearest to a bound", &greatest_share, ""),
        ];
        if !failing.is_empty() {
            worst.insert(0, ("failing", failing.join(", ")));
        }
        if losses.failed > 0 {
            let failed = numbers.iter().zip(&failed).filter(|(_, failed)| failed.is_some());
            let failed: Vec<u64> = failed.map(|(number, _)| *number).collect();
            worst.push(("farthest after a failure", self::worst(&failed, losses.distances(), "m")));
        }
        let refusal = verdict.refusal().map(|refusal| refusal.to_string());
        let ever = |column: &str| counts(flown, column).iter().filter(|ticks| **ticks > 0).count() as u64;
        let rival = manifest.rival();
        let least = floats(flown, LEAST_COMMAND_COLUMN).into_iter().fold(f64::INFINITY, f64::min);
        let least_command = least.is_finite().then(|| (least, f64::from(scenario.motor().idle)));
        Self {
            title: title(scenario, manifest, numbers.len()),
            flights: numbers.len() as u64,
            tracking: tracking as u64,
            rival,
            beyond: ever("beyond"),
            clipped: ever("clipped"),
            least_command,
            fallback: ever("fallback"),
            looks: rival.is_none() && scenario.configuration.paper().is_none(),
            losses,
            holds: (refusal.is_none() || rival.is_some())
                && tracking == numbers.len()
                && (rival.is_some() || least_command.is_none_or(|(least, idle)| least >= idle))
                && verdicts.iter().all(|verdict| *verdict == HOLDS_COLUMN),
            refusal,
            quantiles: table(&numbers, figures.iter().chain(&shares)),
            worst,
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n", self.title)?;
        if let Some(refusal) = &self.refusal {
            let ours = if self.rival.is_some() { "ours is " } else { "" };
            writeln!(f, "{ours}NOT certified: {refusal}\n")?;
        }
        writeln!(
            f,
            "{} of {} recover and track; {} went beyond a certified bound{}; {} commanded a rotor beyond its limits\n",
            self.tracking,
            self.flights,
            self.beyond,
            if self.rival.is_some() { " of ours" } else { "" },
            self.clipped
        )?;
        if let Some((least, idle)) = self.least_command {
            let (least, says, idle) = (percent(least), if least < idle { "BELOW" } else { "not below" }, percent(idle));
            writeln!(f, "least rotor command: {least} of a full one, {says} the {idle} at which motors idle\n")?;
        }
        if self.fallback > 0 {
            writeln!(f, "the extended law's fallback came in {} flights\n", self.fallback)?;
        }
        if self.looks || self.losses.failed > 0 {
            writeln!(f, "{}\n", self.losses)?;
        }
        writeln!(f, "{}", self.quantiles)?;
        let [attitude, heading] =
            [4.0 * MRP_TOLERANCE.atan(), HEADING_TOLERANCE_RAD].map(|angle| angle.to_degrees().round());
        writeln!(
            f,
            "attitude: within {attitude} degrees of the desired one for good after; heading: {heading} degrees\n"
        )?;
        for (what, flights) in &self.worst {
            writeln!(f, "{what}: {flights}")?;
        }
        Ok(())
    }
}

fn title(scenario: &Scenario, manifest: &Manifest, flights: usize) -> String {
    let (part, parts) = manifest.shard;
    let shard = if parts > 1 { format!(", shard {part} of {parts}") } else { String::new() };
    format!(
        "{}{}: {flights} flights of {} s from seed {}, plant step {} ms{shard}",
        manifest.name,
        manifest.rival().map_or(String::new(), |law| format!(" under {law}")),
        scenario.campaign.ranges.duration,
        manifest.seed,
        short(1e3 * manifest.plant_step)
    )
}

/// The figures of every flight, the height lost first; and the shares of each certified bound.
fn figures(scenario: &Scenario, flown: &[RecordBatch]) -> (Vec<Figure>, Vec<Figure>) {
    let figure = |what: &str, unit, column: &str| Figure { what: what.to_owned(), unit, values: floats(flown, column) };
    let figures = vec![
        figure("height lost", "m", "height_lost"),
        figure("rise above start and reference", "m", "rise"),
        figure(&format!("within {SETTLED_DISTANCE_M} m for good after"), "s", "settled"),
        figure("attitude", "s", "attitude"),
        figure("heading", "s", "heading"),
        figure("error at the end", "m", "final_error"),
    ];
    let of_axis = |axis| figure(&format!("share of the bound on torque {axis}"), "", &format!("share_torque_{axis}"));
    let of_rotor = |rotor| figure(&format!("share of rotor {rotor}'s bound"), "", &share_of_rotor(rotor));
    let rotors = scenario.configuration.rotors().map_or(0, |rotors| rotors.len());
    let thrust = std::iter::once(figure("share of the thrust's bound", "", "share_thrust"));
    (figures, thrust.chain(["x", "y", "z"].map(of_axis)).chain((1..=rotors).map(of_rotor)).collect())
}

/// A row for each figure: median, 99 %, 99.9 %, greatest and whose that is.
fn table<'a>(numbers: &[u64], figures: impl Iterator<Item = &'a Figure>) -> String {
    let head = ["figure", "unit", "median", "99 %", "99.9 %", "greatest", "flight"].map(str::to_owned).to_vec();
    let row = |Figure { what, unit, values }: &Figure| {
        let parts = [0.5, 0.99, 0.999, 1.0].map(|part| quantile(values, part));
        let greatest = parts[3].and_then(|greatest| values.iter().position(|value| *value == greatest));
        let flight = greatest.and_then(|place| numbers.get(place)).map_or(String::new(), u64::to_string);
        let mut cells = vec![what.clone(), (*unit).to_owned()];
        cells.extend(parts.map(|value| value.map_or(String::new(), written_figure)));
        cells.push(flight);
        cells
    };
    aligned(&std::iter::once(head).chain(figures.map(row)).collect::<Vec<_>>())
}

/// A figure, or "none".
fn written_figure(value: f64) -> String {
    if value.is_finite() { short(value) } else { "never".to_owned() }
}

/// The flights with the greatest values, greatest first.
fn worst(numbers: &[u64], values: &[f64], unit: &str) -> String {
    let mut places: Vec<(u64, f64)> = numbers.iter().copied().zip(values.iter().copied()).collect();
    places.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let space = if unit.is_empty() { "" } else { " " };
    let listed: Vec<String> = places
        .iter()
        .take(WORST_LISTED)
        .map(|(number, value)| match value.is_finite() {
            true => format!("{number} ({}{space}{unit})", short(*value)),
            false => format!("{number} (never)"),
        })
        .collect();
    listed.join(", ")
}

/// Each flight's verdict.
pub fn verdicts(flown: &[RecordBatch]) -> Vec<&str> {
    let columns = flown.iter().filter_map(|batch| batch.column_by_name("verdict"));
    columns.flat_map(|column| column.as_string::<i32>().iter().flatten()).collect()
}
