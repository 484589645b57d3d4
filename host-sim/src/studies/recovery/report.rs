//! The lines H, T and r: each a value, its unit, the set that it is for, and what makes it known.

use super::flight::Outcome;
use super::many::share_beyond;
use super::search::Wanted;
use super::start::{FLIGHT_DURATION_S, Sets, Start};
use super::tube::Beside;
use crate::output::table::short;
use scenario::tube::{NoTube, Tube};
use std::fmt;

/// The worst of one figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    wanted: Wanted,
    /// Of the random flights.
    random: f64,
    /// That the search found: its start and its flight.
    start: Start,
    outcome: Outcome,
}

impl Found {
    /// Of `random` flights and what a search found from them.
    #[must_use]
    pub fn new(wanted: Wanted, random: &[Outcome], (start, outcome): (Start, Outcome)) -> Self {
        let worst = random.iter().map(|outcome| wanted.of(outcome)).fold(0.0, f64::max);
        Self { wanted, random: worst, start, outcome }
    }

    /// m, or s.
    #[must_use]
    pub fn worst(&self) -> f64 {
        self.wanted.of(&self.outcome)
    }

    /// The figure in words, rounded up; a time beyond a flight's end is no figure.
    fn in_words(&self, value: f64) -> String {
        let up = (100.0 * value).ceil() / 100.0;
        match self.wanted {
            Wanted::Height => format!("{up:.2} m"),
            Wanted::Time if value > FLIGHT_DURATION_S => format!("more than {FLIGHT_DURATION_S} s"),
            Wanted::Time => format!("{up:.2} s"),
        }
    }
}

/// What recoveries cost.
#[derive(Debug, Clone)]
pub struct Report {
    /// The scenario's.
    pub name: String,
    /// What it is for.
    pub sets: Sets,
    /// What counts as back, m.
    pub radius: f64,
    /// The worst heights lost.
    pub height: Found,
    /// The worst times.
    pub time: Found,
    /// Random flights that are not back at their end.
    pub not_arrived: u64,
    /// Random flights in which the law's fallback came.
    pub fell_back: u64,
    /// Random flights in which the law took a rotor for lost.
    pub blamed_a_rotor: u64,
    /// Random flights.
    pub flights: u64,
    /// Flights of each search.
    pub search: u64,
    /// The proof of r.
    pub tube: Result<Tube, NoTube>,
    /// The greatest gust that has a radius, m/s^2.
    pub gust_max: f64,
    /// How far the proof's worst gusts took the vehicle.
    pub beside: Option<Beside>,
}

impl Report {
    /// Why there is no certificate of all three.
    #[must_use]
    pub fn reason(&self) -> String {
        let r = self.tube.as_ref().err().map_or(String::new(), |why| format!(", and no r is proven: {why}"));
        format!("{}: H and T are NOT proven for every start of S, only flown{r}", self.name)
    }

    fn line(&self, letter: &str, what: &str, found: &Found) -> String {
        let flights = grouped(self.flights);
        let statistics = if found.wanted == Wanted::Time && self.not_arrived > 0 {
            let count = grouped(self.not_arrived);
            format!("{count} of {flights} random flights are not back after {FLIGHT_DURATION_S} s")
        } else {
            let more = if found.wanted == Wanted::Time { "take longer" } else { "lose more" };
            format!(
                "of {flights} random flights {}: of starts drawn so, fewer than 1 in {} {more}, with a confidence of \
                 0.999999",
                found.in_words(found.random),
                grouped((1.0 / share_beyond(self.flights)) as u64)
            )
        };
        let worst = found.in_words(found.worst());
        format!(
            "{letter} {worst} from S: {what}. NOT proven for every start, only the worst found ({statistics}; a search \
             of {} flights: {worst})\n",
            grouped(self.search)
        )
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, sets, radius, height, time, tube, .. } = self;
        writeln!(f, "{name}: recovery to a hover from starts in S\nS: {sets}\n")?;
        let back = format!("within {} m", short(*radius));
        f.write_str(&self.line("H", "height lost", height))?;
        f.write_str(&self.line("T", &format!("time until it is back for good, {back}"), time))?;
        let greatest =
            format!("The greatest gust with a proven radius: {:.2} m/s^2", (100.0 * self.gust_max).floor() / 100.0);
        match (tube, self.beside) {
            (Ok(tube), Some(Beside { alone, searched, together })) => writeln!(
                f,
                "r {} m in S, from hover: how far a gust along one axis may take the vehicle for ever, {} m across and \
                 {} m up or down. PROVEN for the law in exact arithmetic, on the premise that its thrust scale is \
                 right and stands still: gusts that go on can teach it a false one, and then a vehicle has come 1.1 times \
                 as far (docs/recovery.md, 9). \
                 Flown in the proof's worst gusts: {} m; the worst that a search of {} flights found from there: {} m. \
                 In the worst gusts of all axes at once, of which the proof does not speak: {} m. {greatest}",
                raised(tube.greatest()),
                raised(tube.across()),
                raised(tube.vertical()),
                short(alone),
                grouped(self.search),
                short(searched),
                short(together),
            )?,
            (Err(why), _) => writeln!(f, "r none is proven for S: {why}. {greatest}. T counts with {back}")?,
            (Ok(_), None) => {}
        }
        let odd =
            [(self.fell_back, "the law's fallback comes"), (self.blamed_a_rotor, "the law takes a rotor for lost")];
        for (count, what) in odd.into_iter().filter(|(count, _)| *count > 0) {
            writeln!(f, "in {} of {} random flights {what}", grouped(count), grouped(self.flights))?;
        }
        for found in [height, time] {
            let (what, until) = (found.in_words(found.worst()), found.wanted.until(&found.outcome));
            writeln!(f, "\nthe start of {what}: {}", found.start.in_words(sets, until))?;
        }
        Ok(())
    }
}

/// Metres, rounded up to a tenth of a millimetre.
fn raised(distance: f64) -> String {
    format!("{:.4}", (1e4 * distance).ceil() / 1e4)
}

/// A number with its thousands apart.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> = digits.as_bytes().rchunks(3).rev().filter_map(|group| str::from_utf8(group).ok()).collect();
    groups.join(",")
}

#[cfg(test)]
mod tests;
