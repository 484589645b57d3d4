//! Poses that come out of order: the filter as it was before each of the last poses, so that one that belongs between
//! them can be fused in its place and those after it again. The result is that of the same poses in order, to the last
//! bit.

use super::filter::Filter;
use super::measurement::PoseMeasurement;
use crate::measurement::Stamped;
use heapless::{Deque, Vec};

/// Poses that can be taken back: 40 ms of them at 200 Hz, and the jitter of a network at 100 Hz.
pub const CHECKPOINTS_MAX: usize = 8;

/// A pose that was fused, and the filter before that.
#[derive(Debug, Clone, PartialEq)]
struct Checkpoint {
    before: Filter,
    pose: Stamped<PoseMeasurement>,
}

/// The last of them, oldest first.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Checkpoints {
    kept: Deque<Checkpoint, CHECKPOINTS_MAX>,
}

/// Poses that were taken back, newest first.
pub(super) type Later = Vec<Stamped<PoseMeasurement>, CHECKPOINTS_MAX>;

impl Checkpoints {
    pub const EMPTY: Self = Self { kept: Deque::new() };

    /// Remembers the filter `before` it took `pose`.
    pub fn push(&mut self, before: &Filter, pose: &Stamped<PoseMeasurement>) {
        if self.kept.is_full() {
            self.kept.pop_front();
        }
        // There is room for it now.
        let _ = self.kept.push_back(Checkpoint { before: *before, pose: *pose });
    }

    /// Forgets those that the history, which begins at `start` (us), can no longer carry on.
    pub fn forget_before(&mut self, start: u64) {
        while self.kept.front().is_some_and(|oldest| oldest.before.time < start) {
            self.kept.pop_front();
        }
    }

    pub fn clear(&mut self) {
        self.kept.clear();
    }

    /// The filter as it was before the first pose later than `time` (us), and the poses from there on, which are
    /// forgotten here; none if that is not known any more.
    pub fn rewind(&mut self, time: u64) -> Option<(Filter, Later)> {
        self.kept.iter().find(|kept| kept.pose.time > time).filter(|kept| kept.before.time <= time)?;
        let mut later = Later::new();
        let mut filter = None;
        while let Some(newest) = self.kept.pop_back_if(|newest| newest.pose.time > time) {
            filter = Some(newest.before);
            // No more than are kept: it fits.
            let _ = later.push(newest.pose);
        }
        Some((filter?, later))
    }
}
