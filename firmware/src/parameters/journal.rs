//! A journal of words in two sectors of flash: whole records of two kinds, one after the other, each written twice; of
//! each kind the newest counts.
//!
//! | word of a record | holds |
//! |---|---|
//! | 0 | its number, one more than that of the record before it |
//! | 1 | how many words it holds, and in its upper half whether there is a record of the other kind beside it |
//! | 2 to 62 | these, the rest of them blank |
//! | 63 | CRC-32 of the others, and its kind |
//!
//! Records fill one sector; then the other is erased and takes the next ones, first of all a copy of the other kind's
//! newest. Power may fail at any point. A sector in which a kind's newest record is is never erased, so that record is
//! lost by nothing. One that was cut short fails its checksum and is left where it is: what was programmed once cannot
//! be programmed again. An erasure that was cut short is done again, because only the sector of the newest record is
//! ever continued. Reading back after writing finds a place that looked blank and was not.
//!
//! A bit that flips later, or a record that is gone, costs one of two copies. [`Kept::Lost`] is what is gone with both:
//! because the other kind's record knows of it, or because the flash holds something, and no record. It does not become
//! [`Kept::Never`] by writing the other kind.

use crate::hardware::{Fault, Flash, Record};

/// The most values that a record holds.
pub const VALUES_MAX: usize = VALUES_END - VALUES;

/// Where in a record its values start, and where they end, which is where its checksum is.
const VALUES: usize = 2;
const VALUES_END: usize = size_of::<Record>() / size_of::<u32>() - 1;

/// A word without anything in it.
const BLANK: u32 = u32::MAX;

/// The upper half of a record's second word where there is a record of the other kind. Older firmware wrote zeros, and
/// reads this as more words than there are.
const HAS_OTHER: u32 = 0x5AA5_0000;
const COUNT_MASK: u32 = 0xFFFF;

/// Copies of a record.
const COPIES: usize = 2;

/// What a record holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Parameters.
    Parameters,
    /// The key that frames are signed with. An older firmware takes its records for cut short.
    Signing,
}

/// What the checksums of each kind are changed by.
const SEALS: [u32; 2] = [0, 0x4E47_4953];

/// What there is of a kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    /// Nothing was ever written.
    Never,
    /// The newest record.
    Whole,
    /// There was a record, and it cannot be read any more.
    Lost,
}

/// A kind's newest record.
#[derive(Clone, Copy)]
struct Newest {
    place: usize,
    number: u32,
    /// The checksum of its values, by which copies are known.
    values: u32,
    /// Whether the record before it is its copy.
    is_doubled: bool,
    /// Whether it knows of the other kind's.
    has_other: bool,
}

/// The journal and where it goes on.
pub struct Journal<F> {
    flash: F,
    /// The newest record's number; 0 without any.
    number: u32,
    newest: [Option<Newest>; 2],
    /// Whether there was a record of each kind that cannot be read any more.
    lost: [bool; 2],
    /// The sector of the newest of all.
    sector: usize,
    /// The place of the next, and the end of its sector.
    next: usize,
    end: usize,
    /// Whether all of the flash is as erased.
    is_blank: bool,
}

impl<F: Flash> Journal<F> {
    /// Finds the newest records.
    pub fn open(flash: F) -> Self {
        let mut journal =
            Self { flash, number: 0, newest: [None; 2], lost: [false; 2], sector: 0, next: 0, end: 0, is_blank: true };
        // Where each sector's used part ends.
        let mut ends = [0; 2];
        for place in 0..2 * F::RECORDS {
            let record = journal.flash.read(place);
            if record == Ok([BLANK; _]) {
                continue;
            }
            (ends[place / F::RECORDS], journal.is_blank) = (place + 1, false);
            if let Ok(record) = record
                && let Some(kind) = kind(&record)
            {
                journal.find(kind, place, &record);
            }
        }
        if journal.number > 0 {
            (journal.next, journal.end) = (ends[journal.sector], (journal.sector + 1) * F::RECORDS);
        }
        journal.lost = [Kind::Parameters, Kind::Signing].map(|kind| {
            let [this, other] = [kind, kind.other()].map(|kind| journal.newest[kind as usize]);
            this.is_none() && other.map_or(!journal.is_blank, |other| other.has_other)
        });
        journal
    }

    /// Takes note of a whole record.
    fn find(&mut self, kind: usize, place: usize, record: &Record) {
        let number = record[0];
        let values = checksum(&record[VALUES..VALUES_END]);
        let newest = &mut self.newest[kind];
        let follows = |before: u32, after: u32| before.wrapping_add(1) == after;
        match newest {
            Some(newest) if newest.number >= number => {
                newest.is_doubled |= newest.values == values && follows(number, newest.number);
            }
            _ => {
                let is_copy = |before: &Newest| before.values == values && follows(before.number, number);
                let is_doubled = newest.as_ref().is_some_and(is_copy);
                let has_other = record[1] & !COUNT_MASK == HAS_OTHER;
                *newest = Some(Newest { place, number, values, is_doubled, has_other });
            }
        }
        if number >= self.number {
            (self.number, self.sector) = (number, place / F::RECORDS);
        }
    }

    /// Whether there was a record of a kind that cannot be read any more, and no other was written since.
    #[must_use]
    pub fn is_lost(&self, kind: Kind) -> bool {
        self.lost[kind as usize]
    }

    /// Reads a kind's newest record over as many of `words` as it holds; what there is of it.
    pub fn read(&mut self, kind: Kind, words: &mut [u32]) -> Kept {
        let Some(newest) = self.newest[kind as usize] else {
            return if self.is_lost(kind) { Kept::Lost } else { Kept::Never };
        };
        let Ok(record) = self.flash.read(newest.place) else { return Kept::Lost };
        let stored = record[VALUES..VALUES_END].iter().take((record[1] & COUNT_MASK) as usize);
        words.iter_mut().zip(stored).for_each(|(word, stored)| *word = *stored);
        Kept::Whole
    }

    /// Whether one more damage would lose a kind's newest record, if there is one: it has no copy, or does not know of
    /// the other kind's.
    #[must_use]
    pub fn is_endangered(&self, kind: Kind) -> bool {
        let has_other = self.exists(kind.other());
        self.newest[kind as usize].is_some_and(|newest| !newest.is_doubled || has_other && !newest.has_other)
    }

    /// Writes a record of `words`, of which there are at most [`VALUES_MAX`].
    ///
    /// # Errors
    /// [`Fault`] if the flash does not take both copies. The record before them, or the first of them, counts then; the
    /// next goes to another place.
    pub fn append(&mut self, kind: Kind, words: &[u32]) -> Result<(), Fault> {
        let mut record = [BLANK; _];
        record[1] = words.len() as u32;
        record[VALUES..VALUES_END].iter_mut().zip(words).for_each(|(place, word)| *place = *word);
        self.put(kind, &mut record)?;
        self.lost[kind as usize] = false;
        // The other kind's is to know of it.
        let other = kind.other();
        match self.newest[other as usize] {
            Some(newest) if !newest.has_other => {
                let mut record = self.flash.read(newest.place)?;
                self.put(other, &mut record)
            }
            _ => Ok(()),
        }
    }

    /// Writes both copies of a record.
    fn put(&mut self, kind: Kind, record: &mut Record) -> Result<(), Fault> {
        (0..COPIES).try_for_each(|_| {
            self.make_room(kind.other())?;
            self.write(kind, record)
        })
    }

    /// Erases the other sector where this one is full, and copies the newest of the kind that would be `left` behind.
    fn make_room(&mut self, left: Kind) -> Result<(), Fault> {
        if self.next == self.end {
            let other = 1 - self.sector;
            if self.newest.iter().flatten().any(|newest| newest.place / F::RECORDS == other) {
                return Err(Fault);
            }
            if !self.is_blank {
                self.flash.erase(other)?;
            }
            (self.next, self.end) = (other * F::RECORDS, (other + 1) * F::RECORDS);
        }
        match self.newest[left as usize] {
            Some(newest) if newest.place / F::RECORDS != self.next / F::RECORDS => {
                let mut record = self.flash.read(newest.place)?;
                (0..COPIES).try_for_each(|_| self.write(left, &mut record))
            }
            _ => Ok(()),
        }
    }

    /// Writes a record to the next place, with a number of its own.
    fn write(&mut self, kind: Kind, record: &mut Record) -> Result<(), Fault> {
        if self.next == self.end {
            return Err(Fault);
        }
        let place = self.next;
        self.next += 1;
        self.is_blank = false;
        self.number = self.number.wrapping_add(1);
        let has_other = if self.exists(kind.other()) { HAS_OTHER } else { 0 };
        record[0] = self.number;
        record[1] = record[1] & COUNT_MASK | has_other;
        record[VALUES_END] = checksum(&record[..VALUES_END]) ^ SEALS[kind as usize];
        self.flash.write(place, record)?;
        if self.flash.read(place)? != *record {
            return Err(Fault);
        }
        self.find(kind as usize, place, record);
        Ok(())
    }

    /// Whether there is a record of a kind, or was one.
    fn exists(&self, kind: Kind) -> bool {
        self.newest[kind as usize].is_some() || self.is_lost(kind)
    }
}

impl Kind {
    fn other(self) -> Self {
        match self {
            Self::Parameters => Self::Signing,
            Self::Signing => Self::Parameters,
        }
    }
}

/// What a record holds, if it is whole.
fn kind(record: &Record) -> Option<usize> {
    let seal = record[VALUES_END] ^ checksum(&record[..VALUES_END]);
    SEALS.iter().position(|known| *known == seal)
}

/// CRC-32 (that of Ethernet) of words, each taken low byte first.
fn checksum(words: &[u32]) -> u32 {
    let mut remainder = u32::MAX;
    for word in words {
        remainder ^= word;
        for _ in 0..u32::BITS {
            let carry = remainder & 1;
            remainder = (remainder >> 1) ^ (carry * 0xEDB8_8320);
        }
    }
    !remainder
}
