//! Records of equal length in memory that a start does not clear, the oldest overwritten first.
//!
//! ```text
//! slot = record | number, 4 bytes | flight, 2 bytes | checksum of all that, 2 bytes
//! ```
//!
//! Numbers go on for ever, one a record. What can be read is the run that ends with the greatest number of a slot whose
//! checksum is right and goes back while numbers follow one another within one flight. So a write that a reset cut
//! short loses that record and the oldest one, which was there before; and memory that was never written holds nothing.

use super::tick;
use mavlink::calculate_crc;

/// Bytes of a slot.
pub const SLOT_BYTES: usize = tick::TICK_BYTES + TAIL_BYTES;

/// Number, flight and checksum.
const TAIL_BYTES: usize = 8;

/// What the checksum begins with: another layout of the record is no record.
const CHECKSUM_SEED: u8 = tick::FORMAT.len() as u8;

/// A slot of the memory.
pub type Slot = [u8; SLOT_BYTES];

/// What stands in a slot beside its record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Label {
    number: u32,
    flight: u16,
}

impl Label {
    /// The label of a slot whose checksum is right.
    fn read(slot: &Slot) -> Option<Self> {
        let (rest, checksum) = slot.split_last_chunk::<2>()?;
        let (rest, flight) = rest.split_last_chunk::<2>()?;
        let (_, number) = rest.split_last_chunk::<4>()?;
        let covered = slot.first_chunk::<{ SLOT_BYTES - 2 }>()?;
        let label = Self { number: u32::from_le_bytes(*number), flight: u16::from_le_bytes(*flight) };
        (calculate_crc(covered, CHECKSUM_SEED) == u16::from_le_bytes(*checksum)).then_some(label)
    }
}

/// The ring.
#[derive(Debug)]
pub struct Ring<'m> {
    slots: &'m mut [Slot],
    /// Where the next record goes.
    next: usize,
    label: Label,
    /// Records of this flight.
    count: usize,
}

impl<'m> Ring<'m> {
    /// Finds what `slots` have kept.
    pub fn recover(slots: &'m mut [Slot]) -> Self {
        let labelled = slots.iter().enumerate().filter_map(|(index, slot)| Some((index, Label::read(slot)?)));
        let Some((newest, label)) = labelled.max_by_key(|(_, label)| label.number) else {
            return Self { slots, next: 0, label: Label { number: 0, flight: 0 }, count: 0 };
        };
        let length = slots.len();
        let follows = |back: &usize| {
            let slot = slots.get((newest + length - back) % length);
            let number = label.number.checked_sub(*back as u32);
            number.is_some_and(|number| slot.and_then(Label::read) == Some(Label { number, ..label }))
        };
        let count = (0..length).take_while(follows).count();
        Self { slots, next: (newest + 1) % length, label, count }
    }

    /// A new flight: the records of the last are no longer read.
    pub fn begin(&mut self) {
        self.label.flight = self.label.flight.wrapping_add(1);
        self.count = 0;
    }

    /// Writes one record.
    pub fn put(&mut self, record: &[u8; tick::TICK_BYTES]) {
        let number = self.label.number.wrapping_add(1);
        let Some(slot) = self.slots.get_mut(self.next) else { return };
        let mut written: Slot = [0; SLOT_BYTES];
        let tail = number.to_le_bytes().into_iter().chain(self.label.flight.to_le_bytes());
        written.iter_mut().zip(record.iter().copied().chain(tail)).for_each(|(to, from)| *to = from);
        let checksum =
            written.first_chunk::<{ SLOT_BYTES - 2 }>().map_or(0, |covered| calculate_crc(covered, CHECKSUM_SEED));
        if let Some(last) = written.last_chunk_mut::<2>() {
            *last = checksum.to_le_bytes();
        }
        *slot = written;
        self.label.number = number;
        self.next = (self.next + 1) % self.slots.len();
        self.count = (self.count + 1).min(self.slots.len());
    }

    /// How many records there are.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// A record, the oldest first.
    pub fn get(&self, index: usize) -> Option<&[u8; tick::TICK_BYTES]> {
        let back = self.count.checked_sub(index).filter(|&back| back > 0)?;
        let length = self.slots.len();
        self.slots.get((self.next + length - back) % length)?.first_chunk()
    }

    /// The flight's number, and the number that the next record gets. Records count on from flight to flight.
    pub fn position(&self) -> (u16, u32) {
        (self.label.flight, self.label.number.wrapping_add(1))
    }

    /// Forgets every record: after a reset, too.
    pub fn erase(&mut self) {
        self.slots.as_flattened_mut().fill(0);
        self.count = 0;
    }
}

#[cfg(test)]
mod tests;
