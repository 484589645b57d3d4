//! Following a recording while it is made: every record once, in order, and how many were overwritten before they were
//! read.
//!
//! The ring is the queue between control, which never waits, and a reader: it may fall behind by as many records as the
//! ring holds.

use super::ring::Ring;
use super::tick;
use super::{Recorder, Recording};
use embassy_sync::blocking_mutex::raw::RawMutex;

/// A reader's position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Follower {
    flight: u16,
    /// The number of the next record.
    next: u32,
}

impl Follower {
    /// Reads the last `count` records again, if they are still there.
    pub fn go_back(&mut self, count: u32) {
        self.next = self.next.wrapping_sub(count);
    }
}

/// What comes next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Followed {
    /// A record.
    Record {
        /// It.
        record: [u8; tick::TICK_BYTES],
        /// How many were overwritten before it.
        missed: u32,
        /// Whether a flight begins with what was read of it.
        is_first: bool,
    },
    /// Nothing yet.
    Nothing {
        /// Whether a recording is being made: more will come.
        is_recording: bool,
    },
}

impl<M: RawMutex> Recorder<M> {
    /// A reader of the records from now on.
    pub fn follower(&self) -> Follower {
        let (flight, next) = self.with(|recording| recording.ring.position()).unwrap_or((0, 1));
        Follower { flight, next }
    }

    /// The next record, if there is one. Where a flight has begun since, what was not read of the one before is gone.
    pub fn follow(&self, follower: &mut Follower) -> Followed {
        let nothing = Followed::Nothing { is_recording: false };
        self.with(|recording| next(recording, follower)).unwrap_or(nothing)
    }
}

fn next(Recording { ring, left, .. }: &mut Recording, follower: &mut Follower) -> Followed {
    let (flight, end) = ring.position();
    let oldest = end.wrapping_sub(u32::try_from(Ring::len(ring)).unwrap_or(u32::MAX));
    let is_first = flight != follower.flight;
    if is_first && !ring.is_empty() {
        *follower = Follower { flight, next: oldest };
    }
    // Numbers that follow one another differ by less than the ring's length, so differences give their order.
    let missed = oldest.wrapping_sub(follower.next).cast_signed().max(0).cast_unsigned();
    let number = follower.next.wrapping_add(missed);
    let record = (follower.flight == flight).then(|| ring.get(number.wrapping_sub(oldest) as usize)).flatten();
    let Some(record) = record else { return Followed::Nothing { is_recording: *left > 0 } };
    follower.next = number.wrapping_add(1);
    Followed::Record { record: *record, missed, is_first }
}
