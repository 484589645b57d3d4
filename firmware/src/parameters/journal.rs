//! A journal of numbers in two sectors of flash: whole records, one after the other, the newest counts.
//!
//! | word of a record | holds |
//! |---|---|
//! | 0 | its number, one more than that of the record before it |
//! | 1 | how many values it holds |
//! | 2 to 62 | values, the rest of them blank |
//! | 63 | CRC-32 of the others |
//!
//! Records fill one sector; then the other is erased and takes the next ones. Power may fail at any point. The sector
//! of the newest record is never erased, so that record is lost by nothing. One that was cut short fails its checksum
//! and is left where it is: what was programmed once cannot be programmed again. An erasure that was cut short is done
//! again, because only the sector of the newest record is ever continued. Reading back after writing finds a place that
//! looked blank and was not.

use crate::hardware::{Fault, Flash, Record};

/// The most values that a record holds.
pub const VALUES_MAX: usize = VALUES_END - VALUES;

/// Where in a record its values start, and where they end, which is where its checksum is.
const VALUES: usize = 2;
const VALUES_END: usize = size_of::<Record>() / size_of::<u32>() - 1;

/// A word without anything in it.
const BLANK: u32 = u32::MAX;

/// The journal and where it goes on.
pub struct Journal<F> {
    flash: F,
    /// The newest record's number; 0 without any.
    number: u32,
    /// The newest record's place.
    newest: usize,
    /// The place of the next; the start of a sector stands for that of the sector that the newest is not in.
    next: usize,
}

impl<F: Flash> Journal<F> {
    /// Finds the newest record and reads it over as many of `values` as it holds. Blank flash holds none.
    ///
    /// # Errors
    /// [`Fault`] if there is something in the flash, but no record.
    pub fn open(flash: F, values: &mut [f32]) -> (Self, Result<(), Fault>) {
        let mut journal = Self { flash, number: 0, newest: 0, next: 0 };
        let found = journal.find(values);
        (journal, found)
    }

    fn find(&mut self, values: &mut [f32]) -> Result<(), Fault> {
        // Where each sector's used part ends.
        let mut ends = [0; 2];
        for place in 0..2 * F::RECORDS {
            let record = self.flash.read(place);
            if record == Ok([BLANK; _]) {
                continue;
            }
            ends[place / F::RECORDS] = place + 1;
            let Ok(record) = record else { continue };
            if is_whole(&record) && record[0] > self.number {
                (self.number, self.newest) = (record[0], place);
                let stored = record[VALUES..VALUES_END].iter().take(record[1] as usize);
                for (value, word) in values.iter_mut().zip(stored) {
                    *value = f32::from_bits(*word);
                }
            }
        }
        if self.number > 0 {
            self.next = ends[self.newest / F::RECORDS];
        } else if ends != [0; 2] {
            return Err(Fault);
        }
        Ok(())
    }

    /// Writes a record of `values`, of which there are at most [`VALUES_MAX`].
    ///
    /// # Errors
    /// [`Fault`] if the flash does not take it. The record before it still counts then; the next goes to another place.
    pub fn append(&mut self, values: &[f32]) -> Result<(), Fault> {
        if self.next.is_multiple_of(F::RECORDS) {
            let other = 1 - self.newest / F::RECORDS;
            self.flash.erase(other)?;
            self.next = other * F::RECORDS;
        }
        let place = self.next;
        self.next += 1;
        self.number = self.number.wrapping_add(1);
        let mut record = [BLANK; _];
        record[0] = self.number;
        record[1] = values.len() as u32;
        for (word, value) in record[VALUES..VALUES_END].iter_mut().zip(values) {
            *word = value.to_bits();
        }
        record[VALUES_END] = checksum(&record);
        self.flash.write(place, &record)?;
        if self.flash.read(place)? != record {
            return Err(Fault);
        }
        self.newest = place;
        Ok(())
    }
}

fn is_whole(record: &Record) -> bool {
    record[VALUES_END] == checksum(record)
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
