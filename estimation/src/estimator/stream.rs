//! The stream of poses, judged by itself: its sender's quality, its time stamps, and whether it moves at all.
//!
//! - A pose whose sender reports failed tracking is refused.
//! - A time stamp serves once. The last [`STAMPS_KEPT`] are remembered; what is older than all of them might be one of
//!   those forgotten.
//! - A stream is frozen after [`IDENTICAL_MAX`] poses in a row that are the same to the last bit, if the IMU has moved
//!   meanwhile. A simulated vehicle that stands still may send such poses for ever; a camera never does. In the air the
//!   least of the IMU's noise is motion enough: a vehicle that hovers well hardly moves, and poses that stand still
//!   would be believed while it drifts away. What counted as motion in the air only says nothing about a vehicle that
//!   has come to stand since. Poses that were rounded on their way may be the same [`ROUNDED_IDENTICAL_MAX`] times.

use super::measurement::PoseMeasurement;
use super::verdict::Rejected;
use crate::measurement::{STAMP_LEAD_MAX_US, Stamped};
use heapless::Deque;

/// Time stamps that are remembered: 160 ms of them at 100 Hz.
const STAMPS_KEPT: usize = 32;

/// Poses in a row that may be the same.
pub const IDENTICAL_MAX: u16 = 9;

/// And if they were rounded, to millimetres: a second of them at 100 Hz.
pub const ROUNDED_IDENTICAL_MAX: u16 = 99;

/// Increments that must have moved for identical poses to be frozen ones: a single one may be a knock against the
/// table.
const MOVED_MIN: u16 = 3;

/// What is remembered of the stream.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stream {
    seen: Deque<u64, STAMPS_KEPT>,
    newest: Option<Stamped<PoseMeasurement>>,
    identical: u16,
    moved: u16,
}

impl Stream {
    pub const EMPTY: Self = Self { seen: Deque::new(), newest: None, identical: 0, moved: 0 };

    /// Takes note of an increment of the IMU: whether the vehicle moved.
    pub fn note(&mut self, moves: bool) {
        self.moved = self.moved.saturating_add(u16::from(moves));
    }

    /// The vehicle has come to stand: it may have done so without a motion.
    pub fn come_to_stand(&mut self) {
        self.moved = 0;
    }

    /// Judges a pose at `now`, us.
    ///
    /// # Errors
    /// The reason for a refusal.
    pub fn admit(&mut self, pose: &Stamped<PoseMeasurement>, now: u64) -> Result<(), Rejected> {
        if pose.time > now.saturating_add(STAMP_LEAD_MAX_US) {
            return Err(Rejected::Future);
        }
        self.remember(pose.time)?;
        self.compare(pose);
        let identical_max = if pose.value.is_rounded { ROUNDED_IDENTICAL_MAX } else { IDENTICAL_MAX };
        if pose.value.failed {
            Err(Rejected::Quality)
        } else if self.identical >= identical_max && self.moved >= MOVED_MIN {
            Err(Rejected::Frozen)
        } else {
            Ok(())
        }
    }

    fn remember(&mut self, time: u64) -> Result<(), Rejected> {
        if self.seen.iter().any(|&seen| seen == time) {
            return Err(Rejected::Repeated);
        }
        if self.seen.is_full() {
            if self.seen.iter().all(|&seen| seen > time) {
                return Err(Rejected::TooOld);
            }
            self.seen.pop_front();
        }
        // There is room for it now.
        let _ = self.seen.push_back(time);
        Ok(())
    }

    /// Counts poses that are the same as the one before them in time.
    fn compare(&mut self, pose: &Stamped<PoseMeasurement>) {
        match &self.newest {
            Some(newest) if newest.time > pose.time => return,
            Some(newest) if newest.value.is_identical(&pose.value) => self.identical = self.identical.saturating_add(1),
            _ => (self.identical, self.moved) = (0, 0),
        }
        self.newest = Some(*pose);
    }
}

#[cfg(test)]
mod tests;
