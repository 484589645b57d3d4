//! The person at the vehicle: questions and answers, at a terminal or out of a file.
//!
//! Nothing here waits: the link is served meanwhile, and a vehicle without heartbeats would disarm.

use crate::sessions::input;
use std::collections::BTreeMap;
use std::io::Write;
use std::sync::mpsc::{Receiver, TryRecvError};
use toml_edit::{DocumentMut, Item};

/// What came of a question so far.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Reply {
    /// Nothing yet.
    Waiting,
    /// A line.
    Given(String),
    /// Nobody is there any more.
    Gone,
}

/// Somebody at the vehicle.
pub trait Person {
    /// Is told something. `key` names what is to be done now.
    fn tell(&mut self, key: &str, text: &str);

    /// Is asked something; `key` names the question.
    fn ask(&mut self, key: &str, text: &str);

    /// What came of the last question.
    fn reply(&mut self, key: &str) -> Reply;
}

/// Somebody at a terminal.
pub struct Terminal(Receiver<String>);

impl Terminal {
    /// Reads lines from standard input, on a thread of its own.
    #[must_use]
    pub fn open() -> Self {
        Self(input::lines())
    }
}

/// Shown to somebody who may have gone: that changes nothing.
fn show(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = write!(out, "{text}").and_then(|()| out.flush());
}

impl Person for Terminal {
    fn tell(&mut self, _: &str, text: &str) {
        show(&format!("{text}\n"));
    }

    fn ask(&mut self, key: &str, text: &str) {
        // A line from before does not count.
        while self.0.try_recv().is_ok() {}
        show(&format!("{text}\n[{key}] > "));
    }

    fn reply(&mut self, _: &str) -> Reply {
        match self.0.try_recv() {
            Ok(line) => Reply::Given(line.trim().to_owned()),
            Err(TryRecvError::Empty) => Reply::Waiting,
            Err(TryRecvError::Disconnected) => Reply::Gone,
        }
    }
}

/// Answers out of a file: a key and a text for each question.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Prepared(BTreeMap<String, String>);

impl Prepared {
    /// Answers in TOML: `"battery.meter" = "16.1"`.
    ///
    /// # Errors
    /// In words: the line or the key that is wrong.
    pub fn parse(text: &str) -> Result<Self, String> {
        let document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| error.to_string())?;
        let answer = |(key, item): (&str, &Item)| match item.as_str() {
            Some(answer) => Ok((key.to_owned(), answer.to_owned())),
            None => Err(format!("{key}: must be a text in quotes")),
        };
        document.iter().map(answer).collect::<Result<_, _>>().map(Self)
    }
}

impl Person for Prepared {
    fn tell(&mut self, _: &str, text: &str) {
        show(&format!("{text}\n"));
    }

    fn ask(&mut self, key: &str, text: &str) {
        show(&format!("{text}\n[{key}] > {}\n", self.0.get(key).map_or("", String::as_str)));
    }

    fn reply(&mut self, key: &str) -> Reply {
        self.0.get(key).map_or(Reply::Gone, |answer| Reply::Given(answer.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prepared_answers_are_found_by_their_keys_and_others_are_missing() {
        let mut person = Prepared::parse("\"battery.meter\" = \"16.1\"\nmotors = \"yes\"\n").unwrap();
        assert_eq!(person.reply("battery.meter"), Reply::Given("16.1".to_owned()));
        assert_eq!(person.reply("motors"), Reply::Given("yes".to_owned()));
        assert_eq!(person.reply("tilt"), Reply::Gone);
        assert!(Prepared::parse("motors = 1").unwrap_err().starts_with("motors"));
        assert!(Prepared::parse("motors = ").is_err());
    }
}
