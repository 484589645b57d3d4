//! What a noisy line says again and again counts once it has come in [`FRAMES_MIN`] frames in a row, over
//! [`SWITCH_DEBOUNCE_US`].
//!
//! CRSF has 8 bits of checksum, so of frames that are corrupted on their way one in some 256 passes. One of these must
//! not move a switch.

/// How long something must have come without anything else between.
pub const SWITCH_DEBOUNCE_US: u64 = 60_000;

/// In how many frames it must have come, also where a frame takes longer than usual.
pub const FRAMES_MIN: u8 = 3;

/// What counts, and what may count next.
#[derive(Debug, Clone, Copy)]
pub struct Debounced<T> {
    counts: Option<T>,
    /// Since when it comes, us, and in how many frames it came.
    coming: Option<(T, u64, u8)>,
}

impl<T> Default for Debounced<T> {
    /// Nothing came yet.
    fn default() -> Self {
        Self { counts: None, coming: None }
    }
}

impl<T: Copy + PartialEq> Debounced<T> {
    /// What counts; none before anything has come for long enough.
    pub fn get(&self) -> Option<T> {
        self.counts
    }

    /// Takes what a frame says at `now`, us; whether it counts from now on and did not before.
    pub fn take(&mut self, value: T, now: u64) -> bool {
        let (_, since, frames) = self.coming.filter(|(coming, ..)| *coming == value).unwrap_or((value, now, 0));
        let frames = frames.saturating_add(1);
        let is_new = self.counts != Some(value);
        let changes = is_new && frames >= FRAMES_MIN && now.saturating_sub(since) >= SWITCH_DEBOUNCE_US;
        if changes {
            self.counts = Some(value);
        }
        self.coming = (is_new && !changes).then_some((value, since, frames));
        changes
    }

    /// Forgets what may count next, after silence; what counts stays.
    pub fn interrupt(&mut self) {
        self.coming = None;
    }
}

#[cfg(test)]
mod tests;
