//! Sectors of a log file: each holds whole ULog messages and can be read without the others.
//!
//! ```text
//! sector = messages | filler to its end, the last two bytes of which are a checksum of all that stands before them
//! blank  = filler from its beginning to its end
//! filler = message of a kind that ULog does not define, so that readers skip it, all its bytes set
//! ```
//!
//! A sector that power cut short while it was written keeps blank bytes at one end: its checksum is wrong, and where a
//! reader takes them for numbers they are NaN, which stands for what is not known.

use crate::hardware::SECTOR_BYTES;
use crate::recorder::ulog;
use mavlink::calculate_crc;

/// The kind of a message that readers skip.
pub const FILLER_KIND: u8 = b'Z';

/// Bytes of a message's head.
pub const MESSAGE_HEAD_BYTES: usize = 3;

const CHECKSUM_BYTES: usize = 2;

/// What the checksum begins with.
const CHECKSUM_SEED: u8 = FILLER_KIND;

/// Bytes of messages that a sector has room for.
pub const SECTOR_CAPACITY_BYTES: usize = SECTOR_BYTES - MESSAGE_HEAD_BYTES - CHECKSUM_BYTES;

/// A sector without messages.
pub const BLANK_SECTOR: [u8; SECTOR_BYTES] = {
    let mut bytes = [0xFF; SECTOR_BYTES];
    [bytes[0], bytes[1], bytes[2]] = ulog::head(FILLER_KIND, SECTOR_BYTES - MESSAGE_HEAD_BYTES);
    bytes
};

/// What a sector holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// No messages.
    Blank,
    /// Messages.
    Whole,
    /// A part of what should have been written, or something else altogether.
    Torn,
}

impl Content {
    /// What is in these bytes.
    pub fn from_bytes(bytes: &[u8; SECTOR_BYTES]) -> Self {
        if *bytes == BLANK_SECTOR {
            return Self::Blank;
        }
        let is_whole = bytes
            .split_last_chunk::<CHECKSUM_BYTES>()
            .is_some_and(|(covered, checksum)| calculate_crc(covered, CHECKSUM_SEED) == u16::from_le_bytes(*checksum));
        if is_whole { Self::Whole } else { Self::Torn }
    }
}

/// A sector that fills up.
#[derive(Debug, Clone)]
pub struct Sector {
    bytes: [u8; SECTOR_BYTES],
    used: usize,
}

impl Sector {
    /// Nothing in it yet.
    pub const fn new() -> Self {
        Self { bytes: BLANK_SECTOR, used: 0 }
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.used == 0
    }

    /// Adds a message that consists of these parts, or leaves the sector as it is if there is no room; whether there
    /// was.
    pub fn put(&mut self, parts: &[&[u8]]) -> bool {
        let length: usize = parts.iter().map(|part| part.len()).sum();
        if self.used + length > SECTOR_CAPACITY_BYTES {
            return false;
        }
        let to = self.bytes.iter_mut().skip(self.used);
        to.zip(parts.iter().copied().flatten()).for_each(|(to, from)| *to = *from);
        self.used += length;
        true
    }

    /// The sector as it is written, and a new one in its place.
    pub fn finish(&mut self) -> [u8; SECTOR_BYTES] {
        let Self { mut bytes, used } = core::mem::replace(self, Self::new());
        let filler = ulog::head(FILLER_KIND, SECTOR_BYTES - used - MESSAGE_HEAD_BYTES);
        let mut filling = bytes.iter_mut().skip(used);
        filling.by_ref().zip(filler).for_each(|(to, from)| *to = from);
        filling.for_each(|to| *to = 0xFF);
        if let Some((covered, checksum)) = bytes.split_last_chunk_mut::<CHECKSUM_BYTES>() {
            *checksum = calculate_crc(covered, CHECKSUM_SEED).to_le_bytes();
        }
        bytes
    }
}

#[cfg(test)]
mod tests;
