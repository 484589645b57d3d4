//! A file's topics as columns, its parameters, its information and its texts.
//!
//! ```text
//! file    = head | messages          message = length of what follows, 2 bytes | kind, 1 byte | ...
//! F format   I information   P parameter   A subscription   D data   L text   O dropout   B flags
//! ```
//!
//! Messages of other kinds are skipped. A file that was cut short ends in the middle of a message; what stands before
//! it is read. Anything else that does not fit is an error that names the byte.

use super::formats::{Field, Formats, Number};
use super::{HEAD, MAGIC};
use std::collections::BTreeMap;

/// Message B: whether something is appended, which nothing here is interested in, and what no reader of this version
/// understands.
const FLAGS: [usize; 2] = [8, 16];
const APPENDED: u8 = 1;

/// A topic, row by row.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Series {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Series {
    /// The columns of these names, together; none if one is missing.
    #[must_use]
    pub fn columns(&self, names: &[&str]) -> Option<Vec<Vec<f64>>> {
        let place = |name: &&str| self.names.iter().position(|found| found == name);
        let places = names.iter().map(place).collect::<Option<Vec<usize>>>()?;
        Some(self.rows.iter().map(|row| places.iter().map(|place| row[*place]).collect()).collect())
    }

    /// How many rows it has.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether it has none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

/// A text that was logged.
#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    /// As syslog numbers it, in ASCII.
    pub level: u8,
    /// us.
    pub time: u64,
    /// The words.
    pub words: String,
}

/// What a file holds of the topics that were asked for.
#[derive(Debug, Clone, Default)]
pub struct Ulog {
    /// us.
    pub start: u64,
    /// Every topic's name, wanted or not.
    pub names: Vec<String>,
    topics: BTreeMap<String, Series>,
    /// The first value of each parameter.
    pub parameters: BTreeMap<String, f64>,
    /// Texts of information, by key.
    pub information: BTreeMap<String, String>,
    /// In order.
    pub texts: Vec<Text>,
}

impl Ulog {
    /// Reads a file; of its topics only those that are `wanted`, each of its first instance.
    ///
    /// # Errors
    /// What does not fit, and at which byte.
    pub fn read(bytes: &[u8], wanted: &[&str]) -> Result<Self, String> {
        if !bytes.starts_with(&MAGIC) || bytes.len() < HEAD {
            return Err("is no ULog".to_owned());
        }
        let mut reading = Reading { wanted, log: Self::default(), formats: Formats::default(), open: BTreeMap::new() };
        reading.log.start =
            bytes.get(HEAD - 8..HEAD).and_then(|eight| eight.try_into().ok()).map_or(0, u64::from_le_bytes);
        let (mut at, mut end) = (HEAD, bytes.len());
        while let Some(head) = bytes.get(at..at + 3).filter(|_| at < end) {
            let length = usize::from(u16::from_le_bytes([head[0], head[1]]));
            let Some(body) = bytes.get(at + 3..at + 3 + length) else { break };
            let outcome = match head[2] {
                b'B' => appended(body).map(|found| end = found.unwrap_or(end)),
                kind => reading.message(kind, body),
            };
            outcome.map_err(|what| format!("byte {at}: {what}"))?;
            at += 3 + length;
        }
        Ok(reading.log)
    }

    /// A topic, if there are records of it.
    #[must_use]
    pub fn topic(&self, name: &str) -> Option<&Series> {
        self.topics.get(name).filter(|series| !series.is_empty())
    }
}

/// Where something else is appended, if it is.
fn appended(flags: &[u8]) -> Result<Option<usize>, String> {
    let [begin, end] = FLAGS;
    let incompatible = flags.get(begin..end).ok_or("flags are cut short")?;
    let [first, rest @ ..] = incompatible else { return Ok(None) };
    if first & !APPENDED != 0 || rest.iter().any(|byte| *byte != 0) {
        return Err("is of a ULog that needs a newer reader".to_owned());
    }
    let offset = flags.get(end..end + 8).and_then(|eight| eight.try_into().ok()).map_or(0, u64::from_le_bytes);
    Ok((first & APPENDED != 0 && offset > 0).then(|| usize::try_from(offset).unwrap_or(usize::MAX)))
}

/// A file that is being read.
struct Reading<'w> {
    wanted: &'w [&'w str],
    log: Ulog,
    formats: Formats,
    /// Subscriptions, by their numbers: the topic and its fields.
    open: BTreeMap<[u8; 2], (String, Vec<Field>)>,
}

impl Reading<'_> {
    fn message(&mut self, kind: u8, body: &[u8]) -> Result<(), String> {
        match kind {
            b'F' => self.formats.add(body),
            b'I' => self.information(body),
            b'P' => self.parameter(body),
            b'A' => self.subscription(body),
            b'D' => self.data(body),
            b'L' => self.text(body),
            _ => Ok(()),
        }
    }

    fn information(&mut self, body: &[u8]) -> Result<(), String> {
        let (kind, key, value) = keyed(body)?;
        if kind.starts_with("char") {
            self.log.information.insert(key.to_owned(), String::from_utf8_lossy(value).into_owned());
        }
        Ok(())
    }

    fn parameter(&mut self, body: &[u8]) -> Result<(), String> {
        let (kind, key, value) = keyed(body)?;
        let number = Number::of(kind).and_then(|number| number.read(value));
        let number = number.ok_or(format!("the parameter {key} is no number"))?;
        self.log.parameters.entry(key.to_owned()).or_insert(number);
        Ok(())
    }

    fn subscription(&mut self, body: &[u8]) -> Result<(), String> {
        let [instance, low, high, name @ ..] = body else { return Err("a subscription is cut short".to_owned()) };
        let name = std::str::from_utf8(name).map_err(|_| "a topic's name is no text".to_owned())?;
        if *instance > 0 {
            return Ok(());
        }
        self.log.names.push(name.to_owned());
        if self.wanted.contains(&name) {
            let fields = self.formats.fields(name)?;
            let names = fields.iter().map(|field| field.name.clone()).collect();
            self.log.topics.entry(name.to_owned()).or_insert(Series { names, rows: Vec::new() });
            self.open.insert([*low, *high], (name.to_owned(), fields));
        }
        Ok(())
    }

    fn data(&mut self, body: &[u8]) -> Result<(), String> {
        let [low, high, record @ ..] = body else { return Err("a record is cut short".to_owned()) };
        let Some((name, fields)) = self.open.get(&[*low, *high]) else { return Ok(()) };
        let row: Option<Vec<f64>> = fields.iter().map(|field| field.read(record)).collect();
        let row = row.ok_or(format!("a record of {name} is cut short"))?;
        if let Some(series) = self.log.topics.get_mut(name) {
            series.rows.push(row);
        }
        Ok(())
    }

    fn text(&mut self, body: &[u8]) -> Result<(), String> {
        let (head, words) = body.split_at_checked(9).ok_or("a text is cut short")?;
        let time = head.get(1..).and_then(|eight| eight.try_into().ok()).map_or(0, u64::from_le_bytes);
        let words = String::from_utf8_lossy(words).into_owned();
        self.log.texts.push(Text { level: head[0], time, words });
        Ok(())
    }
}

/// The type, the key and the value of a message that begins with a key.
fn keyed(body: &[u8]) -> Result<(&str, &str, &[u8]), String> {
    let (length, rest) = body.split_first().ok_or("a key is cut short")?;
    let (key, value) = rest.split_at_checked(usize::from(*length)).ok_or("a key is cut short")?;
    let key = std::str::from_utf8(key).map_err(|_| "a key is no text".to_owned())?;
    let (kind, key) = key.split_once(' ').ok_or(format!("the key {key:?} has no type"))?;
    Ok((kind, key, value))
}
