//! A file of topics: formats first, then information, parameters and subscriptions, then data in the order of time.

use super::MAGIC;

/// Of the format that is written.
const FORMAT_VERSION: u8 = 1;

/// Flags of a file without anything that a reader must know about.
const FLAG_BYTES: [u8; 40] = [0; 40];

/// A topic to be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Topic {
    /// Its name.
    pub name: &'static str,
    /// Its fields, as ULog writes them; the first is `uint64_t timestamp`.
    pub fields: &'static str,
}

/// A file that grows.
#[derive(Debug, Clone)]
pub struct Writer(Vec<u8>);

impl Writer {
    /// Begins a file of these topics, whose numbers are their places; the first record is of `time`, us.
    #[must_use]
    pub fn new(time: u64, topics: &[Topic], information: &[(&str, &str)], parameters: &[(&str, f64)]) -> Self {
        let mut writer = Self([&MAGIC[..], &[FORMAT_VERSION], &time.to_le_bytes()].concat());
        writer.message(b'B', &[&FLAG_BYTES]);
        for Topic { name, fields } in topics {
            writer.message(b'F', &[format!("{name}:{fields}").as_bytes()]);
        }
        for (key, text) in information {
            writer.keyed(b'I', &format!("char[{}] {key}", text.len()), text.as_bytes());
        }
        for (key, value) in parameters {
            writer.keyed(b'P', &format!("float {key}"), &(*value as f32).to_le_bytes());
        }
        for (number, topic) in (0_u16..).zip(topics) {
            writer.message(b'A', &[&[0], &number.to_le_bytes(), topic.name.as_bytes()]);
        }
        writer
    }

    fn message(&mut self, kind: u8, parts: &[&[u8]]) {
        let length: usize = parts.iter().map(|part| part.len()).sum();
        // Nothing here comes near the longest message.
        self.0.extend(u16::try_from(length).unwrap_or(u16::MAX).to_le_bytes());
        self.0.push(kind);
        parts.iter().for_each(|part| self.0.extend(*part));
    }

    fn keyed(&mut self, kind: u8, key: &str, value: &[u8]) {
        let length = u8::try_from(key.len()).unwrap_or(u8::MAX);
        self.message(kind, &[&[length], key.as_bytes(), value]);
    }

    /// A record of topic `number`: its time, us, and what follows in it.
    pub fn record(&mut self, number: u16, time: u64, rest: &[u8]) {
        self.message(b'D', &[&number.to_le_bytes(), &time.to_le_bytes(), rest]);
    }

    /// A text of `time`, us.
    pub fn text(&mut self, level: u8, time: u64, words: &str) {
        self.message(b'L', &[&[level], &time.to_le_bytes(), words.as_bytes()]);
    }

    /// The file.
    #[must_use]
    pub fn finish(self) -> Vec<u8> {
        self.0
    }
}
