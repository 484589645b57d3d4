//! What passed, kept in a file beside the scenario: a walk that stopped goes on where it was.
//!
//! A record is of one board, one scenario file and one image. Where any of them is another, it begins anew: what was
//! checked was not that.

use super::outcome::Outcome;
use crate::output::whole_file::WholeFile;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use toml_edit::{ArrayOfTables, DocumentMut, Item, Table, value};

/// What is checked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Subject {
    /// The board's name.
    pub board: String,
    /// The SHA-256 of the scenario file.
    pub scenario: String,
    /// The SHA-256 of the image, or the version that the vehicle names where no image is given.
    pub image: String,
}

/// A check that was made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// Which.
    pub id: String,
    /// How it came out.
    pub outcome: Outcome,
    /// When, by this computer's clock, UTC.
    pub time: String,
}

/// What was checked so far.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Record {
    /// Of what.
    pub subject: Subject,
    /// In the order in which they were made.
    pub entries: Vec<Entry>,
    path: PathBuf,
}

impl Record {
    /// The record in a file, if that is of the same subject; else an empty one, and the reason in words where there was
    /// another.
    ///
    /// # Errors
    /// In words, if the file cannot be read, or is no record.
    pub fn open(path: &Path, subject: Subject) -> Result<(Self, Option<String>), String> {
        let empty = Self { subject, entries: Vec::new(), path: path.to_owned() };
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok((empty, None)),
            Err(error) => return Err(format!("{}: cannot be read: {error}", path.display())),
        };
        let wrong = |what: &str| format!("{}: {what}; give another --record, or remove it", path.display());
        let document: DocumentMut = text.parse().map_err(|_| wrong("is no record of a first flight"))?;
        let text_of =
            |key: &str| document.get(key).and_then(Item::as_str).ok_or_else(|| wrong(&format!("{key}: missing")));
        let found = Subject {
            board: text_of("board")?.to_owned(),
            scenario: text_of("scenario")?.to_owned(),
            image: text_of("image")?.to_owned(),
        };
        let differs = [
            ("board", &found.board, &empty.subject.board),
            ("scenario file", &found.scenario, &empty.subject.scenario),
            ("image", &found.image, &empty.subject.image),
        ];
        let differs = differs.into_iter().find(|(_, one, other)| one != other).map(|(what, ..)| what);
        if let Some(what) = differs {
            return Ok((empty, Some(format!("{}: was of another {what}: it begins anew", path.display()))));
        }
        let tables = document.get("check").and_then(Item::as_array_of_tables);
        let entries = tables.into_iter().flatten().map(|table| entry(table).ok_or_else(|| wrong("check: incomplete")));
        let entries = entries.collect::<Result<_, _>>()?;
        Ok((Self { entries, ..empty }, None))
    }

    /// How a check came out last.
    #[must_use]
    pub fn outcome(&self, id: &str) -> Option<&Entry> {
        self.entries.iter().rfind(|entry| entry.id == id)
    }

    /// Adds a check in place of the last one of its kind, and writes the file.
    ///
    /// # Errors
    /// In words, if it cannot be written.
    pub fn add(&mut self, entry: Entry) -> Result<(), String> {
        self.entries.retain(|before| before.id != entry.id);
        self.entries.push(entry);
        let mut document = DocumentMut::new();
        let Subject { board, scenario, image } = &self.subject;
        for (key, text) in [("board", board), ("scenario", scenario), ("image", image)] {
            document[key] = value(text);
        }
        let mut checks = ArrayOfTables::new();
        for Entry { id, outcome, time } in &self.entries {
            let mut table = Table::new();
            table["id"] = value(id);
            table["outcome"] = value(outcome.word());
            table["figures"] = value(outcome.figures());
            table["time"] = value(time);
            checks.push(table);
        }
        document["check"] = Item::ArrayOfTables(checks);
        write(&self.path, &document.to_string())
    }
}

/// Writes a whole file.
pub fn write(path: &Path, text: &str) -> Result<(), String> {
    let written = WholeFile::create(path).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.finish()
    });
    written.map_err(|error| format!("{}: cannot be written: {error}", path.display()))
}

fn entry(table: &Table) -> Option<Entry> {
    let text = |key: &str| Some(table.get(key)?.as_str()?.to_owned());
    let outcome = Outcome::read(&text("outcome")?, text("figures")?)?;
    Some(Entry { id: text("id")?, outcome, time: text("time")? })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        Subject { board: "a".to_owned(), scenario: "b".to_owned(), image: "c".to_owned() }
    }

    fn entry(id: &str, outcome: Outcome) -> Entry {
        Entry { id: id.to_owned(), outcome, time: "2026-11-28 14:00 UTC".to_owned() }
    }

    #[test]
    fn a_record_is_found_again_and_the_last_outcome_counts() {
        let directory = std::env::temp_dir().join(format!("first-flight-{}", std::process::id()));
        std::fs::create_dir_all(&directory).unwrap();
        let path = directory.join("record.toml");
        let (mut record, why) = Record::open(&path, subject()).unwrap();
        assert!(record.entries.is_empty() && why.is_none());
        record.add(entry("boot", Outcome::Failed("\"quoted\" = [1]".to_owned()))).unwrap();
        record.add(entry("axes", Outcome::Skipped("no hands".to_owned()))).unwrap();
        record.add(entry("boot", Outcome::Passed("9 inequalities".to_owned()))).unwrap();
        let (again, why) = Record::open(&path, subject()).unwrap();
        assert_eq!((&again, why), (&record, None));
        assert_eq!(again.outcome("boot").unwrap().outcome, Outcome::Passed("9 inequalities".to_owned()));
        assert_eq!(again.entries.len(), 2);
        for (other, word) in [
            (Subject { board: "x".to_owned(), ..subject() }, "board"),
            (Subject { scenario: "x".to_owned(), ..subject() }, "scenario file"),
            (Subject { image: "x".to_owned(), ..subject() }, "image"),
        ] {
            let (anew, why) = Record::open(&path, other).unwrap();
            assert!(anew.entries.is_empty() && why.unwrap().contains(word));
        }
        std::fs::write(&path, "board = 1").unwrap();
        assert!(Record::open(&path, subject()).unwrap_err().contains("board: missing"));
        std::fs::remove_dir_all(&directory).unwrap();
    }
}
