//! A journal of words in two sectors of flash: whole records of two kinds, one after the other, each written twice; of
//! each kind the newest counts.
//!
//! | word of a record | holds |
//! |---|---|
//! | 0 | its number, one more than that of the record before it |
//! | 1 | how many words it holds, and in its upper half the number of the other kind's newest |
//! | 2 to 126 | these, the rest of them blank |
//! | 127 | CRC-32 of the others, and its kind |
//!
//! Older firmware wrote records of 64 words: up to two of them stand in a place, and are read like the others.
//!
//! Records fill one sector; then the other is erased and takes the next ones, first of all a copy of the other kind's
//! newest. Power may fail at any point. A sector in which a kind's newest record is is never erased, so that record is
//! lost by nothing. One that was cut short fails its checksum and is left where it is: what was programmed once cannot
//! be programmed again. An erasure that was cut short is done again, because only the sector of the newest record is
//! ever continued. Reading back after writing finds a place that looked blank and was not.
//!
//! A bit that flips later, or a record that is gone, costs one of two copies. [`Kept::Lost`] is what is gone with both:
//! because the other kind's record knows of a newer one, because two places behind the newest record of all are neither
//! blank nor whole (a cut leaves one), or because the flash holds something, and no record. It does not become
//! [`Kept::Never`] by writing the other kind.

use crate::hardware::{Fault, Flash, Record};

/// The most values that a record holds.
pub const VALUES_MAX: usize = CHECKSUM_WORD - FIRST_VALUE_WORD;

/// Where in a record its values start, and where they end, which is where its checksum is.
const FIRST_VALUE_WORD: usize = 2;
const CHECKSUM_WORD: usize = size_of::<Record>() / size_of::<u32>() - 1;

/// Words of a record of older firmware.
const OLDER_RECORD_WORDS: usize = 64;

/// A word without anything in it.
const BLANK_WORD: u32 = u32::MAX;

/// Where a record's second word has how many words it holds. Older firmware wrote zeros above it, and reads anything
/// else there as more words than there are.
const COUNT_MASK: u32 = 0xFFFF;

/// Above it: the other kind has a record, that is lost, and the lowest bits of the number of its first copy.
const HAS_OTHER_BIT: u32 = 1 << 31;
const OTHER_LOST_BIT: u32 = 1 << 30;
const OTHER_SHIFT: u32 = 14;

const RECORD_COPIES: usize = 2;

/// What a record holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Parameters.
    Parameters,
    /// The key that frames are signed with. An older firmware takes its records for cut short.
    Signing,
}

/// What the checksums of each kind are changed by.
const CHECKSUM_MASKS: [u32; 2] = [0, 0x4E47_4953];

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
    /// Its second word.
    head: u32,
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
        for place in 0..2 * F::RECORDS_PER_SECTOR {
            let record = journal.flash.read(place);
            if record == Ok([BLANK_WORD; _]) {
                continue;
            }
            (ends[place / F::RECORDS_PER_SECTOR], journal.is_blank) = (place + 1, false);
            if let Ok(record) = record {
                whole(&record).for_each(|(kind, record)| journal.find(kind, place, &record));
            }
        }
        if journal.number > 0 {
            (journal.next, journal.end) = (ends[journal.sector], (journal.sector + 1) * F::RECORDS_PER_SECTOR);
        }
        journal.lost = [Kind::Parameters, Kind::Signing].map(|kind| journal.has_lost(kind));
        journal
    }

    /// Whether a kind's newest record is gone.
    fn has_lost(&mut self, kind: Kind) -> bool {
        let [this, other] = [kind, kind.other()].map(|kind| self.newest[kind as usize]);
        let known = other.map_or(0, |other| other.head & !COUNT_MASK);
        // Any of the two copies will do.
        let numbers = |this: Newest| [this.number, this.number.wrapping_sub(1)].map(stated);
        let is_known = |this: Newest| known == 0 || numbers(this).contains(&known);
        match (this, other) {
            (None, None) => return !self.is_blank,
            (None, Some(_)) => return known != 0,
            (Some(this), Some(other)) if other.number > this.number && !is_known(this) => return true,
            _ => {}
        }
        // What is left of records behind the newest of all, less those that hold as many words as the other kind's.
        let newest = self.newest.iter().flatten().map(|newest| newest.place + 1);
        let begin =
            newest.filter(|place| (place - 1) / F::RECORDS_PER_SECTOR == self.sector).max().unwrap_or(self.next);
        let is_others = |count: u32| match (this, other) {
            (Some(this), _) if this.count() == count => false,
            (_, Some(other)) => other.count() == count,
            (this, None) => this.is_some_and(|this| this.knows_other()),
        };
        let remains = (begin..self.next).filter(|place| match self.flash.read(*place) {
            Ok(record) => !is_others(record[1] & COUNT_MASK),
            Err(Fault) => true,
        });
        remains.count() >= RECORD_COPIES
    }

    /// Takes note of a whole record.
    fn find(&mut self, kind: usize, place: usize, record: &Record) {
        let number = record[0];
        let values = checksum(&record[FIRST_VALUE_WORD..CHECKSUM_WORD]);
        let newest = &mut self.newest[kind];
        let follows = |before: u32, after: u32| before.wrapping_add(1) == after;
        match newest {
            Some(newest) if newest.number >= number => {
                newest.is_doubled |= newest.values == values && follows(number, newest.number);
            }
            _ => {
                let is_copy = |before: &Newest| before.values == values && follows(before.number, number);
                let is_doubled = newest.as_ref().is_some_and(is_copy);
                *newest = Some(Newest { place, number, values, is_doubled, head: record[1] });
            }
        }
        if number >= self.number {
            (self.number, self.sector) = (number, place / F::RECORDS_PER_SECTOR);
        }
    }

    /// Whether there was a record of a kind that cannot be read any more, and no other was written since.
    pub fn is_lost(&self, kind: Kind) -> bool {
        self.lost[kind as usize]
    }

    /// Reads a kind's newest record that is whole over as many of `words` as it holds; what there is of the newest.
    pub fn read(&mut self, kind: Kind, words: &mut [u32]) -> Kept {
        let kept = if self.is_lost(kind) { Kept::Lost } else { Kept::Whole };
        let Some(newest) = self.newest[kind as usize] else {
            return if kept == Kept::Lost { kept } else { Kept::Never };
        };
        let Ok(record) = self.record(newest) else { return Kept::Lost };
        let stored = record[FIRST_VALUE_WORD..CHECKSUM_WORD].iter().take((record[1] & COUNT_MASK) as usize);
        words.iter_mut().zip(stored).for_each(|(word, stored)| *word = *stored);
        kept
    }

    /// Whether one more damage would lose a kind's newest record, if there is one: it has no copy, or does not know of
    /// the other kind's.
    pub fn is_endangered(&self, kind: Kind) -> bool {
        let has_other = self.newest(kind.other()).is_some();
        self.newest(kind).is_some_and(|newest| !newest.is_doubled || has_other && !newest.knows_other())
    }

    /// Writes a record of `words`, of which there are at most [`VALUES_MAX`].
    /// Errors: [`Fault`] if the flash does not take both copies. The record before them, or the first of them, counts
    /// then; the next goes to another place.
    pub fn append(&mut self, kind: Kind, words: &[u32]) -> Result<(), Fault> {
        let mut record = [BLANK_WORD; _];
        record[1] = words.len() as u32;
        record[FIRST_VALUE_WORD..CHECKSUM_WORD].iter_mut().zip(words).for_each(|(place, word)| *place = *word);
        self.put(kind, &mut record)?;
        self.lost[kind as usize] = false;
        // The other kind's is to know of it.
        let other = kind.other();
        match self.newest(other) {
            Some(newest) if !newest.knows_other() => {
                let mut record = self.record(newest)?;
                self.put(other, &mut record)
            }
            _ => Ok(()),
        }
    }

    /// What the flash has of a record.
    fn record(&mut self, newest: Newest) -> Result<Record, Fault> {
        let place = self.flash.read(newest.place)?;
        whole(&place).find_map(|(_, record)| (record[0] == newest.number).then_some(record)).ok_or(Fault)
    }

    /// A kind's newest record; none if that is lost, whatever older one there is.
    fn newest(&self, kind: Kind) -> Option<Newest> {
        self.newest[kind as usize].filter(|_| !self.is_lost(kind))
    }

    /// Writes both copies of a record, one behind the other.
    fn put(&mut self, kind: Kind, record: &mut Record) -> Result<(), Fault> {
        self.make_room(kind.other())?;
        (0..RECORD_COPIES).try_for_each(|_| self.write(kind, record))
    }

    /// Erases the other sector where this one has no room for both copies, and copies the newest of the kind that would
    /// be `left` behind.
    fn make_room(&mut self, left: Kind) -> Result<(), Fault> {
        if self.next + RECORD_COPIES > self.end {
            let other = 1 - self.sector;
            let newest = [Kind::Parameters, Kind::Signing].map(|kind| self.newest(kind));
            if newest.iter().flatten().any(|newest| newest.place / F::RECORDS_PER_SECTOR == other) {
                return Err(Fault);
            }
            if !self.is_blank {
                self.flash.erase(other)?;
            }
            (self.next, self.end) = (other * F::RECORDS_PER_SECTOR, (other + 1) * F::RECORDS_PER_SECTOR);
        }
        match self.newest(left) {
            Some(newest) if newest.place / F::RECORDS_PER_SECTOR != self.next / F::RECORDS_PER_SECTOR => {
                let mut record = self.record(newest)?;
                (0..RECORD_COPIES).try_for_each(|_| self.write(left, &mut record))
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
        let other = match self.newest(kind.other()) {
            Some(newest) => stated(newest.number.wrapping_sub(newest.is_doubled.into())),
            None if self.is_lost(kind.other()) => HAS_OTHER_BIT | OTHER_LOST_BIT,
            None => 0,
        };
        record[0] = self.number;
        record[1] = record[1] & COUNT_MASK | other;
        record[CHECKSUM_WORD] = checksum(&record[..CHECKSUM_WORD]) ^ CHECKSUM_MASKS[kind as usize];
        self.flash.write(place, record)?;
        if self.flash.read(place)? != *record {
            return Err(Fault);
        }
        self.find(kind as usize, place, record);
        Ok(())
    }
}

impl Newest {
    /// How many words it holds.
    fn count(&self) -> u32 {
        self.head & COUNT_MASK
    }

    /// Whether it knows that there is a record of the other kind.
    fn knows_other(&self) -> bool {
        self.head & HAS_OTHER_BIT != 0
    }
}

/// What a record says of the other kind's newest, the first copy of which has this number.
fn stated(number: u32) -> u32 {
    HAS_OTHER_BIT | (number & ((1 << OTHER_SHIFT) - 1)) << (u32::BITS / 2)
}

impl Kind {
    fn other(self) -> Self {
        match self {
            Self::Parameters => Self::Signing,
            Self::Signing => Self::Parameters,
        }
    }
}

/// The whole records in a place, with what they hold: one, or those of older firmware as they would be written today.
fn whole(place: &Record) -> impl Iterator<Item = (usize, Record)> {
    let older = place.as_chunks::<OLDER_RECORD_WORDS>().0.iter().filter_map(|words| {
        let (_, values) = words.split_last()?;
        let mut record = [BLANK_WORD; _];
        record.iter_mut().zip(values).for_each(|(word, value)| *word = *value);
        Some((kind(words)?, record))
    });
    kind(place).map(|kind| (kind, *place)).into_iter().chain(older)
}

/// What a record holds, if it is whole.
fn kind(record: &[u32]) -> Option<usize> {
    let (found, others) = record.split_last()?;
    let seal = found ^ checksum(others);
    CHECKSUM_MASKS.iter().position(|known| *known == seal)
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
