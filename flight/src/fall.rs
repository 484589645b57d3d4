//! Whether a vehicle whose motors were stopped in the air may still fall.
//!
//! A falling vehicle is still for a moment at most, so one that stays still lies somewhere.

use super::debounce::Debounce;
use super::detectors::{GROUND_DEBOUNCE_US, is_still};
use estimation::estimator::EstimatedState;

/// Since it was stopped.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Fall {
    may_fall: bool,
    still: Debounce,
}

impl Fall {
    /// Once a tick; `is_stopped` in the one that stops it in the air. Without a state the last answer stands.
    pub fn tick(&mut self, is_stopped: bool, state: Option<&EstimatedState>, now: u64) {
        let lies = self.still.holds_for(state.is_some_and(is_still), GROUND_DEBOUNCE_US, now);
        // What has hovered until now was still as well.
        self.still = if is_stopped { Debounce::default() } else { self.still };
        self.may_fall = is_stopped || self.may_fall && !lies;
    }

    /// Whether it may fall.
    pub fn may_fall(&self) -> bool {
        self.may_fall
    }
}
