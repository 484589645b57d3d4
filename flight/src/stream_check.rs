//! Whether a stream of setpoints is flown as it is sent, for the operator.
//!
//! The governor smooths what does not keep the bounds, and what it has not caught up with. That is said where the
//! reference has been farther than [`FOLLOWED_DISTANCE_MAX_M`] from the stream for [`STREAM_DEBOUNCE_US`], and again
//! every [`STREAM_REPORT_INTERVAL_US`]; and the end of it likewise, once.

use controller_core::governor::FollowingReport;
use core::fmt;

/// The distance of the reference beyond which a stream is not flown as it is sent.
pub const FOLLOWED_DISTANCE_MAX_M: f32 = 0.05;

/// The time for which that is so, or no longer so, before it is said.
pub const STREAM_DEBOUNCE_US: u64 = 2_000_000;

/// The time between two reports of the same.
pub const STREAM_REPORT_INTERVAL_US: u64 = 10_000_000;

/// How a stream of setpoints is flown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Streamed {
    /// As it is sent.
    AsSent,
    /// Smoothed, because it is too fast for the bounds; so many times slower it would keep them.
    TooFast(f32),
    /// Smoothed, and not caught up with, although nothing known is too fast.
    Behind,
}

impl fmt::Display for Streamed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AsSent => f.write_str("Setpoints flown as sent"),
            Self::TooFast(slower) => write!(f, "Setpoints too fast: smoothed, {slower:.1}x slower fits"),
            Self::Behind => f.write_str("Setpoints smoothed: not caught up with yet"),
        }
    }
}

/// What was reported.
#[derive(Debug, Default, PartialEq)]
pub(super) struct StreamCheck {
    /// Whether that was that it is smoothed, and when, us.
    smoothed: bool,
    said: u64,
    /// Since when the opposite is so, us.
    since: Option<u64>,
}

impl StreamCheck {
    /// How the stream is flown, in a tick in which that is to be reported.
    pub fn tick(&mut self, following: Option<FollowingReport>, now: u64) -> Option<Streamed> {
        let Some(following) = following else {
            *self = Self::default();
            return None;
        };
        let is_far = following.off > FOLLOWED_DISTANCE_MAX_M;
        let waits = if is_far == self.smoothed {
            self.since = None;
            !is_far || now.saturating_sub(self.said) < STREAM_REPORT_INTERVAL_US
        } else {
            now.saturating_sub(*self.since.get_or_insert(now)) < STREAM_DEBOUNCE_US
        };
        if waits {
            return None;
        }
        *self = Self { smoothed: is_far, said: now, since: None };
        Some(if is_far { Streamed::smoothed(following.slower()) } else { Streamed::AsSent })
    }
}

impl Streamed {
    /// Where the stream would have to be so many times slower. Rounded up, so that what is said fits.
    fn smoothed(slower: f32) -> Self {
        let tenths = (slower * 10.0) as u32;
        if slower > 1.0 { Self::TooFast((tenths + 1) as f32 * 0.1) } else { Self::Behind }
    }
}

#[cfg(test)]
mod tests;
