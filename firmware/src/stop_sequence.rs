//! The order of a board's last acts, whatever went wrong: stop the motors, report why, keep them stopped while that is
//! fetched.
//!
//! Saying why comes second because it may fail: a panic in the middle of logging makes the logger panic again. Whatever
//! goes wrong in these acts begins them anew, finds them begun, and leads to the restart that follows them.

use core::sync::atomic::{AtomicBool, Ordering};

/// Stop frames before anything is reported: controllers may miss some, and want a few in a row.
pub const STOP_FRAMES_BEFORE: usize = 10;

/// Stop frames while the report is fetched.
pub const STOP_FRAMES_AFTER: usize = 200;

/// Whether the last acts have begun.
pub struct StopSequence(AtomicBool);

impl StopSequence {
    /// Not yet.
    pub const fn new() -> Self {
        Self(AtomicBool::new(false))
    }

    /// Acts, the first time: `stop` sends so many stop frames, `say` reports why.
    pub fn act(&self, stop: impl Fn(usize), say: impl FnOnce()) {
        if !self.0.swap(true, Ordering::Relaxed) {
            stop(STOP_FRAMES_BEFORE);
            say();
            stop(STOP_FRAMES_AFTER);
        }
    }
}

#[cfg(test)]
mod tests;
