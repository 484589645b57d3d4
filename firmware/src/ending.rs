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
pub struct Ending(AtomicBool);

impl Ending {
    /// Not yet.
    #[must_use]
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

impl Default for Ending {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    #[test]
    fn motors_are_stopped_before_anything_is_reported() {
        let acts = RefCell::new(Vec::new());
        Ending::new()
            .act(|frames| acts.borrow_mut().push(format!("stop {frames}")), || acts.borrow_mut().push("say".into()));
        assert_eq!(*acts.borrow(), ["stop 10", "say", "stop 200"]);
    }

    #[test]
    fn a_panic_while_reporting_is_not_reported_again() {
        let (acts, ending) = (RefCell::new(Vec::new()), Ending::new());
        let stop = |frames| acts.borrow_mut().push(format!("stop {frames}"));
        let reported_again = || panic!("reported again");
        // As on a board: a panic in there comes back to the same acts, and a restart follows them.
        ending.act(stop, || ending.act(stop, reported_again));
        assert_eq!(*acts.borrow(), ["stop 10", "stop 200"]);
    }
}
