//! Vehicle and person together: what a check is made with.

use super::person::{Person, Reply};
use super::vehicle::{Stop, Vehicle};
use controller_core::certificate::certified::{Certified, Refused};
use scenario::Scenario;
use std::time::Duration;

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
pub(super) const HAND_TIMEOUT: Duration = Duration::from_secs(60);

impl<'a> Walk<'a> {
    /// A walk that begins.
    pub fn new(vehicle: Vehicle, person: &'a mut dyn Person, scenario: &'a Scenario, board: Board) -> Self {
        let verdict = Certified::new(scenario.configuration.clone());
        Self { vehicle, person, scenario, verdict, board, propellers_off: false }
    }

    /// Asks, and serves the link until there is an answer.
    ///
    /// # Errors
    /// A signal, or nobody there.
    pub(super) fn ask(&mut self, key: &str, text: &str) -> Result<String, Stop> {
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
    ///
    /// # Errors
    /// A signal, or nobody there.
    pub(super) fn choose(&mut self, key: &str, text: &str, answers: &[&str]) -> Result<String, Stop> {
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
    ///
    /// # Errors
    /// A signal, or nobody there.
    pub(super) fn confirm(&mut self, key: &str, text: &str) -> Result<bool, Stop> {
        Ok(self.choose(key, text, &["yes", "no"])? == "yes")
    }

    /// Asks for a number; none where it is left out.
    ///
    /// # Errors
    /// A signal, or nobody there.
    pub(super) fn number(&mut self, key: &str, text: &str) -> Result<Option<f64>, Stop> {
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
    ///
    /// # Errors
    /// A signal, or nobody there.
    pub(super) fn has_no_propellers(&mut self) -> Result<bool, Stop> {
        if !self.propellers_off {
            let text = "Are all propellers OFF, and is the frame held down?";
            self.propellers_off = self.confirm("propellers-off", text)?;
        }
        Ok(self.propellers_off)
    }
}

/// How often a question is asked again that got no fitting answer.
const ASKED_MAX: usize = 5;
