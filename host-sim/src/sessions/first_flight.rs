//! A first flight's bench checks, walked through with a person at the vehicle and a link to it; no debug probe.
//!
//! ```text
//! person <- instructions, questions | answers -> walk <- telemetry, words | commands -> vehicle
//!                                                 '-> record of what passed -> page to sign
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`line`], [`vehicle`] | bytes to and from the vehicle; what it says and answers |
//! | [`person`] | questions and answers, at a terminal or out of a file |
//! | [`judge`] | what measured values mean |
//! | `checks` | the checks, in their order |
//! | [`record`], [`page`] | what passed, kept over walks; the page to sign |
//!
//! A check that fails ends the walk: the next ones rest on it. It is safe to break off at any question: the vehicle is
//! disarmed in all of them but the last checks, and a vehicle without heartbeats disarms.

mod checks;
pub mod judge;
pub mod line;
pub mod page;
pub mod person;
pub mod record;
pub mod vehicle;

pub use checks::CHECKS;

use controller_core::certificate::certified::{Certified, Refused};
use person::{Person, Reply};
use record::{Entry, Record};
use scenario::Scenario;
use std::time::Duration;
use vehicle::{Stop, Vehicle};

/// A board, as far as checks differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Board {
    /// Its name, as features and binaries have it.
    pub name: &'static str,
    /// Its name, as it says itself.
    pub title: &'static str,
    /// Whether it measures the battery, and has a radio receiver.
    pub is_h743: bool,
}

/// The boards.
pub const BOARDS: [Board; 3] = [
    Board { name: "micoair-h743", title: "MicoAir H743 V2", is_h743: true },
    Board { name: "matek-h743", title: "Matek H743", is_h743: true },
    Board { name: "crazyflie-bolt", title: "Crazyflie Bolt", is_h743: false },
];

/// How a check came out, and with which figures.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// As it must.
    Passed(String),
    /// Not so: why.
    Failed(String),
    /// It was not made: why.
    Skipped(String),
}

impl Outcome {
    /// In a word.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Passed(_) => "passed",
            Self::Failed(_) => "FAILED",
            Self::Skipped(_) => "skipped",
        }
    }

    /// Its figures, or its reason.
    #[must_use]
    pub fn figures(&self) -> &str {
        match self {
            Self::Passed(figures) | Self::Failed(figures) | Self::Skipped(figures) => figures,
        }
    }

    fn read(word: &str, figures: String) -> Option<Self> {
        [Self::Passed, Self::Failed, Self::Skipped]
            .map(|of| of(figures.clone()))
            .into_iter()
            .find(|it| it.word() == word)
    }
}

/// A check.
pub struct Check {
    /// Its name on the command line, and in the record.
    pub id: &'static str,
    /// Its line on the page.
    pub title: &'static str,
    /// What it is about, to be read before it begins.
    pub about: &'static str,
    run: fn(&mut Walk<'_>) -> Result<Outcome, Stop>,
}

/// A walk under way.
pub struct Walk<'a> {
    /// The vehicle.
    pub vehicle: Vehicle,
    /// The person.
    pub person: &'a mut dyn Person,
    /// What is to be flown.
    pub scenario: &'a Scenario,
    /// The certificate's verdict on that.
    pub verdict: Result<Certified, Refused>,
    /// The board.
    pub board: Board,
    /// Whether the person has said in this walk that the propellers are off.
    pub propellers_off: bool,
}

/// How long a hand may take for what it is told.
const HAND_TIMEOUT: Duration = Duration::from_secs(60);

impl<'a> Walk<'a> {
    /// A walk that begins.
    pub fn new(vehicle: Vehicle, person: &'a mut dyn Person, scenario: &'a Scenario, board: Board) -> Self {
        let verdict = Certified::new(scenario.configuration.clone());
        Self { vehicle, person, scenario, verdict, board, propellers_off: false }
    }

    /// Makes the checks that have not passed, or `only` one; whether all of these passed or were skipped.
    ///
    /// # Errors
    /// Why the walk ended before them.
    pub fn make(&mut self, record: &mut Record, only: Option<&str>) -> Result<bool, Stop> {
        let is_done = |record: &Record, check: &Check| match only {
            Some(id) => check.id != id,
            // It may be another image than the last time: the first check says whether it is.
            None if check.id == CHECKS[0].id => false,
            None => record.outcome(check.id).is_some_and(|entry| matches!(entry.outcome, Outcome::Passed(_))),
        };
        for (number, check) in CHECKS.iter().enumerate() {
            if is_done(record, check) {
                continue;
            }
            let heading = format!("\n{} of {}: {}\n{}", number + 1, CHECKS.len(), check.title, check.about);
            self.person.tell(check.id, &heading);
            self.vehicle.texts();
            let outcome = (check.run)(self)?;
            self.person.tell(check.id, &format!("{}: {}", outcome.word(), outcome.figures()));
            let has_failed = matches!(outcome, Outcome::Failed(_));
            let entry = Entry { id: check.id.to_owned(), outcome, time: page::now() };
            record.add(entry).map_err(Stop::Unwritable)?;
            if has_failed {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Asks, and serves the link until there is an answer.
    fn ask(&mut self, key: &str, text: &str) -> Result<String, Stop> {
        self.person.ask(key, text);
        loop {
            match self.person.reply(key) {
                Reply::Given(answer) => return Ok(answer),
                Reply::Gone => return Err(Stop::Left),
                Reply::Waiting => self.vehicle.serve()?,
            }
        }
    }

    /// Asks for one of several answers, until it is one of them.
    fn choose(&mut self, key: &str, text: &str, answers: &[&str]) -> Result<String, Stop> {
        let mut question = format!("{text} ({})", answers.join(", "));
        for _ in 0..ASKED_MAX {
            let answer = self.ask(key, &question)?.to_lowercase();
            if answers.contains(&answer.as_str()) {
                return Ok(answer);
            }
            question = format!("One of these: {}", answers.join(", "));
        }
        Err(Stop::Left)
    }

    /// Asks whether something is so.
    fn confirm(&mut self, key: &str, text: &str) -> Result<bool, Stop> {
        Ok(self.choose(key, text, &["yes", "no"])? == "yes")
    }

    /// Asks for a number; none where it is left out.
    fn number(&mut self, key: &str, text: &str) -> Result<Option<f64>, Stop> {
        for _ in 0..ASKED_MAX {
            let answer = self.ask(key, text)?;
            if answer.is_empty() || answer == "skip" {
                return Ok(None);
            }
            if let Ok(number) = answer.replace(',', ".").parse::<f64>()
                && number.is_finite()
            {
                return Ok(Some(number));
            }
        }
        Err(Stop::Left)
    }

    /// Before a motor may turn: the propellers are off, said in this walk.
    fn has_no_propellers(&mut self) -> Result<bool, Stop> {
        if !self.propellers_off {
            let text = "Are all propellers OFF, and is the frame held down?";
            self.propellers_off = self.confirm("propellers-off", text)?;
        }
        Ok(self.propellers_off)
    }
}

/// How often a question is asked again that got no fitting answer.
const ASKED_MAX: usize = 5;

#[cfg(test)]
mod tests;
