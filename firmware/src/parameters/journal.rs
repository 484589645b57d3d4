//! A journal of words in two sectors of flash: whole records of two kinds, one after the other; of each kind the newest
//! counts.
//!
//! | word of a record | holds |
//! |---|---|
//! | 0 | its number, one more than that of the record before it |
//! | 1 | how many words it holds |
//! | 2 to 62 | these, the rest of them blank |
//! | 63 | CRC-32 of the others, and its kind |
//!
//! Records fill one sector; then the other is erased and takes the next ones, first of all a copy of the other kind's
//! newest. Power may fail at any point. A sector in which a kind's newest record is is never erased, so that record is
//! lost by nothing. One that was cut short fails its checksum and is left where it is: what was programmed once cannot
//! be programmed again. An erasure that was cut short is done again, because only the sector of the newest record is
//! ever continued. Reading back after writing finds a place that looked blank and was not.

use crate::hardware::{Fault, Flash, Record};

/// The most values that a record holds.
pub const VALUES_MAX: usize = VALUES_END - VALUES;

/// Where in a record its values start, and where they end, which is where its checksum is.
const VALUES: usize = 2;
const VALUES_END: usize = size_of::<Record>() / size_of::<u32>() - 1;

/// A word without anything in it.
const BLANK: u32 = u32::MAX;

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

/// The journal and where it goes on.
pub struct Journal<F> {
    flash: F,
    /// The newest record's number; 0 without any.
    number: u32,
    /// The places of each kind's newest record.
    newest: [Option<usize>; 2],
    /// The sector of the newest of all.
    sector: usize,
    /// The place of the next; the start of a sector stands for that of the sector that the newest is not in.
    next: usize,
}

impl<F: Flash> Journal<F> {
    /// Finds the newest records. Blank flash holds none.
    ///
    /// # Errors
    /// [`Fault`] if there is something in the flash, but no record.
    pub fn open(flash: F) -> (Self, Result<(), Fault>) {
        let mut journal = Self { flash, number: 0, newest: [None; 2], sector: 0, next: 0 };
        let found = journal.find();
        (journal, found)
    }

    fn find(&mut self) -> Result<(), Fault> {
        // Where each sector's used part ends, and each kind's greatest number.
        let (mut ends, mut numbers) = ([0; 2], [0; 2]);
        for place in 0..2 * F::RECORDS {
            let record = self.flash.read(place);
            if record == Ok([BLANK; _]) {
                continue;
            }
            ends[place / F::RECORDS] = place + 1;
            let Ok(record) = record else { continue };
            let Some(kind) = kind(&record) else { continue };
            if record[0] > numbers[kind] {
                (numbers[kind], self.newest[kind]) = (record[0], Some(place));
            }
            if record[0] > self.number {
                (self.number, self.sector) = (record[0], place / F::RECORDS);
            }
        }
        if self.number > 0 {
            self.next = ends[self.sector];
        } else if ends != [0; 2] {
            return Err(Fault);
        }
        Ok(())
    }

    /// Reads a kind's newest record over as many of `words` as it holds.
    ///
    /// # Errors
    /// [`Fault`] without such a record.
    pub fn read(&mut self, kind: Kind, words: &mut [u32]) -> Result<(), Fault> {
        let record = self.flash.read(self.newest[kind as usize].ok_or(Fault)?)?;
        let stored = record[VALUES..VALUES_END].iter().take(record[1] as usize);
        words.iter_mut().zip(stored).for_each(|(word, stored)| *word = *stored);
        Ok(())
    }

    /// Writes a record of `words`, of which there are at most [`VALUES_MAX`].
    ///
    /// # Errors
    /// [`Fault`] if the flash does not take it. The record before it still counts then; the next goes to another place.
    pub fn append(&mut self, kind: Kind, words: &[u32]) -> Result<(), Fault> {
        if self.next.is_multiple_of(F::RECORDS) {
            let other = 1 - self.sector;
            if self.newest.iter().flatten().any(|place| place / F::RECORDS == other) {
                return Err(Fault);
            }
            self.flash.erase(other)?;
            self.next = other * F::RECORDS;
        }
        // What would be left behind in the other sector.
        let left = match kind {
            Kind::Parameters => Kind::Signing,
            Kind::Signing => Kind::Parameters,
        };
        if let Some(place) = self.newest[left as usize].filter(|place| place / F::RECORDS != self.next / F::RECORDS) {
            let mut record = self.flash.read(place)?;
            self.write(left, &mut record)?;
        }
        let mut record = [BLANK; _];
        record[1] = words.len() as u32;
        record[VALUES..VALUES_END].iter_mut().zip(words).for_each(|(place, word)| *place = *word);
        self.write(kind, &mut record)
    }

    /// Writes a record to the next place, with a number of its own.
    fn write(&mut self, kind: Kind, record: &mut Record) -> Result<(), Fault> {
        let place = self.next;
        self.next += 1;
        self.number = self.number.wrapping_add(1);
        record[0] = self.number;
        record[VALUES_END] = checksum(record) ^ SEALS[kind as usize];
        self.flash.write(place, record)?;
        if self.flash.read(place)? != *record {
            return Err(Fault);
        }
        (self.newest[kind as usize], self.sector) = (Some(place), place / F::RECORDS);
        Ok(())
    }
}

/// What a record holds, if it is whole.
fn kind(record: &Record) -> Option<usize> {
    let seal = record[VALUES_END] ^ checksum(record);
    SEALS.iter().position(|known| *known == seal)
}

/// CRC-32 (that of Ethernet) of all but the last word, each taken low byte first.
fn checksum(record: &Record) -> u32 {
    let mut remainder = u32::MAX;
    for word in &record[..VALUES_END] {
        remainder ^= word;
        for _ in 0..u32::BITS {
            let carry = remainder & 1;
            remainder = (remainder >> 1) ^ (carry * 0xEDB8_8320);
        }
    }
    !remainder
}
