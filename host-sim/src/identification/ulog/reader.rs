//! A file's topics as columns, its parameters, its information and its texts.
//!
//! ```text
//! file    = head | messages          message = length of what follows, 2 bytes | kind, 1 byte | ...
//! F format   I information   P parameter   A subscription   D data   L text   O dropout   B flags
//! ```
//!
//! Messages of other kinds are skipped. A file that was cut short ends in the middle of a message; what stands before
//! it is read. A damaged message is skipped and counted ([`Damage`]): alone, if another follows where it ends; if not,
//! its length is wrong unless it is its topic's, and reading goes on where messages are found to follow one another.

use super::formats::{Field, Formats, Number};
use super::{HEAD_BYTES, MAGIC};
use std::collections::BTreeMap;
use std::fmt;

/// Message B: whether data are appended, which is ignored here, and flags that no reader of this version
/// understands.
const FLAG_WORDS: [usize; 2] = [8, 16];
const APPENDED_FLAG: u8 = 1;

/// The kinds of messages of the format's version 1, with those that are ignored here; and Z, with which the firmware
/// fills the sectors of a card.
const MESSAGE_KINDS: &[u8] = b"FIMPQADLCORSBZ";

/// So many messages that follow one another do so by no chance.
const MESSAGES_IN_A_ROW: usize = 3;

/// A topic, row by row.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Series {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Series {
    /// The columns of these names, together; none if one is missing.
    pub fn columns(&self, names: &[&str]) -> Option<Vec<Vec<f64>>> {
        let place = |name: &&str| self.names.iter().position(|found| found == name);
        let places = names.iter().map(place).collect::<Option<Vec<usize>>>()?;
        Some(self.rows.iter().map(|row| places.iter().map(|place| row[*place]).collect()).collect())
    }

    /// Takes out each row whose time is not between those of its neighbours, which are in order; how many.
    fn without_strays(&mut self) -> usize {
        let Some(place) = self.names.iter().position(|name| name == "timestamp") else { return 0 };
        let times: Vec<f64> = self.rows.iter().map(|row| row[place]).collect();
        let strays: Vec<bool> = (0..times.len())
            .map(|at| {
                let neighbours = at.checked_sub(1).and_then(|before| Some((times[before], *times.get(at + 1)?)));
                neighbours.is_some_and(|(before, after)| before <= after && !(before..=after).contains(&times[at]))
            })
            .collect();
        let mut is_stray = strays.iter();
        self.rows.retain(|_| !is_stray.next().is_some_and(|stray| *stray));
        strays.iter().filter(|stray| **stray).count()
    }

    /// How many rows it has.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether it has none.
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
    pub words: String,
}

/// What could not be read of a file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Damage {
    /// Messages, and stretches without one.
    pub places: usize,
    /// Bytes that were skipped.
    pub bytes: usize,
    /// What is wrong with the first of them.
    pub first: String,
}

impl Damage {
    fn add(&mut self, bytes: usize, what: impl FnOnce() -> String) {
        if self.places == 0 {
            self.first = what();
        }
        (self.places, self.bytes) = (self.places + 1, self.bytes + bytes);
    }
}

/// Follows what is said of a file; empty where all of it was read.
impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { places, bytes, first } = self;
        match places {
            0 => Ok(()),
            1 => write!(f, "; 1 damaged place of {bytes} bytes skipped: {first}"),
            _ => write!(f, "; {places} damaged places of {bytes} bytes skipped, the first: {first}"),
        }
    }
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
    /// What was skipped.
    pub damage: Damage,
}

impl Ulog {
    /// Reads a file; of its topics only those that are `wanted`, each of its first instance.
    ///
    /// # Errors
    /// If it is no ULog, or one that needs a newer reader.
    pub fn read(bytes: &[u8], wanted: &[&str]) -> Result<Self, String> {
        if !bytes.starts_with(&MAGIC) || bytes.len() < HEAD_BYTES {
            return Err("is no ULog".to_owned());
        }
        let mut reading = Reading { wanted, log: Self::default(), formats: Formats::default(), open: BTreeMap::new() };
        reading.log.start =
            bytes.get(HEAD_BYTES - 8..HEAD_BYTES).and_then(|eight| eight.try_into().ok()).map_or(0, u64::from_le_bytes);
        let (mut at, mut messages) = (HEAD_BYTES, bytes);
        while let Some((kind, end)) = header(messages, at) {
            let body = messages.get(at + 3..end);
            let is_followed = body.is_some() && goes_on(messages, end);
            let found = || (at + 1..messages.len()).find(|at| is_row(messages, *at));
            let next = if is_followed { Some(end) } else { found() };
            if body.is_none() && next.is_none() {
                // Cut short.
                break;
            }
            let next = next.unwrap_or(messages.len());
            let sound = body.filter(|body| is_followed || next >= end && reading.is_of_its_length(kind, body));
            let wrong = match sound {
                Some(flags) if kind == b'B' => {
                    let appended = appended(flags)?.filter(|appended| *appended >= end);
                    messages = appended.and_then(|appended| bytes.get(..appended)).unwrap_or(bytes);
                    None
                }
                Some(body) => reading.message(kind, body).err().map(|wrong| (at, wrong)),
                None => Some((at, "a message that ends where none begins".to_owned())),
            };
            let between = (sound.is_some() && next > end).then(|| (end, "no message".to_owned()));
            if let Some((from, wrong)) = wrong.or(between) {
                reading.log.damage.add(next - from, || format!("byte {from}: {wrong}"));
            }
            at = next;
        }
        Ok(reading.finish())
    }

    /// A topic, if there are records of it.
    pub fn topic(&self, name: &str) -> Option<&Series> {
        self.topics.get(name).filter(|series| !series.is_empty())
    }
}

/// Where something else is appended, if it is.
fn appended(flags: &[u8]) -> Result<Option<usize>, String> {
    let [begin, end] = FLAG_WORDS;
    let incompatible = flags.get(begin..end).ok_or("flags are cut short")?;
    let [first, rest @ ..] = incompatible else { return Ok(None) };
    if first & !APPENDED_FLAG != 0 || rest.iter().any(|byte| *byte != 0) {
        return Err("is of a ULog that needs a newer reader".to_owned());
    }
    let offset = flags.get(end..end + 8).and_then(|eight| eight.try_into().ok()).map_or(0, u64::from_le_bytes);
    Ok((first & APPENDED_FLAG != 0 && offset > 0).then(|| usize::try_from(offset).unwrap_or(usize::MAX)))
}

/// The kind of the message that begins at `at`, and where it ends.
fn header(bytes: &[u8], at: usize) -> Option<(u8, usize)> {
    let head = bytes.get(at..at + 3)?;
    Some((head[2], at + 3 + usize::from(u16::from_le_bytes([head[0], head[1]]))))
}

/// Whether a message may end at `at`: another begins there, be it of an unknown kind or cut short, or the file ends.
fn goes_on(bytes: &[u8], at: usize) -> bool {
    match header(bytes, at) {
        Some((kind, end)) => MESSAGE_KINDS.contains(&kind) || is_row(bytes, end),
        None => at <= bytes.len(),
    }
}

/// Whether known messages follow one another from `at` on: [`MESSAGES_IN_A_ROW`] of them, or up to the end.
fn is_row(bytes: &[u8], mut at: usize) -> bool {
    for _ in 0..MESSAGES_IN_A_ROW {
        match header(bytes, at) {
            Some((kind, end)) if MESSAGE_KINDS.contains(&kind) && (at + 4..=bytes.len()).contains(&end) => at = end,
            _ => return at == bytes.len(),
        }
    }
    true
}

/// A file that is being read.
struct Reading<'w> {
    wanted: &'w [&'w str],
    log: Ulog,
    formats: Formats,
    /// Subscriptions, by their numbers: the topic and its fields; none of what is not wanted.
    open: BTreeMap<[u8; 2], Option<(String, Vec<Field>)>>,
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
            0 => Err("a message of no kind".to_owned()),
            _ => Ok(()),
        }
    }

    /// What was read, without the records whose times are damaged.
    fn finish(mut self) -> Ulog {
        for (name, series) in &mut self.log.topics {
            for _ in 0..series.without_strays() {
                self.log.damage.add(0, || format!("a record of {name} whose time is not between its neighbours'"));
            }
        }
        self.log
    }

    /// Whether it is a record of a wanted topic, and as long as that topic's are.
    fn is_of_its_length(&self, kind: u8, body: &[u8]) -> bool {
        let (b'D', [low, high, record @ ..]) = (kind, body) else { return false };
        let topic = self.open.get(&[*low, *high]).and_then(Option::as_ref);
        topic.is_some_and(|(_, fields)| fields.iter().map(Field::end).max() == Some(record.len()))
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
        let number = Number::from_name(kind).and_then(|number| number.read(value));
        let number = number.ok_or(format!("the parameter {key} is not a number"))?;
        self.log.parameters.entry(key.to_owned()).or_insert(number);
        Ok(())
    }

    fn subscription(&mut self, body: &[u8]) -> Result<(), String> {
        let [instance, low, high, name @ ..] = body else { return Err("a subscription is cut short".to_owned()) };
        let name = std::str::from_utf8(name).map_err(|_| "a topic's name is no text".to_owned())?;
        self.open.insert([*low, *high], None);
        if *instance > 0 {
            return Ok(());
        }
        self.log.names.push(name.to_owned());
        if self.wanted.contains(&name) {
            let fields = self.formats.fields(name)?;
            let names = fields.iter().map(|field| field.name.clone()).collect();
            self.log.topics.entry(name.to_owned()).or_insert(Series { names, rows: Vec::new() });
            self.open.insert([*low, *high], Some((name.to_owned(), fields)));
        }
        Ok(())
    }

    fn data(&mut self, body: &[u8]) -> Result<(), String> {
        let [low, high, record @ ..] = body else { return Err("a record is cut short".to_owned()) };
        let subscription = self.open.get(&[*low, *high]).ok_or("a record of a topic that is not subscribed to")?;
        let Some((name, fields)) = subscription else { return Ok(()) };
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
