//! A sender's clock against the vehicle's: when a message was true, and whether its time is a new one.
//!
//! A message that arrives at a (the vehicle's clock) and says s (the sender's) was true at s + o, where o is what the
//! clocks differ by. Every arrival is late by what the line took: a - s = o + delay. So the least a - s seen is nearest
//! to o:
//!
//! ```text
//! o_k = min(a_k - s_k, o_(k-1) + drift (a_k - a_(k-1)))      drift: 200 ppm, more than two quartz clocks part
//! ```
//!
//! What every message takes at least is not seen that way and stays part of o: [`super::time_sync`] may know it, or
//! somebody who has measured it. A message is never stamped later than it arrived.
//!
//! A time that does not advance is a frame sent again, or one overtaken: it is refused, for however long. So is one
//! that would be more than [`LATE_MAX`] late. A clock that was set back, or stood still, or begins anew, goes on from
//! frame to frame as the vehicle's does. After [`STEADY`] such frames it is believed, and o is found anew. A line that
//! is that late from some time on looks the same; who knows better by TIMESYNC must refuse its messages first.

/// Frames in a row that prove a clock that is not where it was: 50 ms at 100 Hz.
pub const STEADY: u8 = 5;

/// How late a message may be, us.
pub const LATE_MAX: u64 = 500_000;

/// By how much the clocks may differ over those frames, us: what a line's delay may change by.
const SPACING_ERROR: u64 = 20_000;

/// One over the drift between two clocks.
pub(super) const DRIFT: u64 = 5_000;

/// What is known of a sender's clock.
#[derive(Debug, Clone, Copy)]
pub struct SenderClock {
    /// o, us.
    offset: i128,
    /// The sender's time of the last message that was taken, and when that arrived, us.
    last: (u64, u64),
    /// When the first message of what is known arrived, us.
    begun: u64,
    /// Frames that were not taken, and would prove another clock.
    trial: Option<Trial>,
}

#[derive(Debug, Clone, Copy)]
struct Trial {
    /// The sender's time of the first, and when that arrived, us.
    first: (u64, u64),
    /// The sender's time of the last, us.
    last: u64,
    count: u8,
}

impl SenderClock {
    /// From a sender's first message.
    #[must_use]
    pub fn new(time: u64, arrived: u64) -> Self {
        Self { offset: difference(arrived, time), last: (time, arrived), begun: arrived, trial: None }
    }

    /// o, with what every message takes at least, us: the vehicle's clock less the sender's.
    #[must_use]
    pub fn offset(&self) -> i128 {
        self.offset
    }

    /// When it was found, us. It changes when the sender's clock was set and is believed again.
    #[must_use]
    pub fn begun(&self) -> u64 {
        self.begun
    }

    /// Whether a message that says `time` comes after the last one by its sender's clock.
    #[must_use]
    pub fn advances(&self, time: u64) -> bool {
        time > self.last.0
    }

    /// When a message that says `time` and arrived at `arrived` was true, us of the vehicle's clock; none if its time
    /// is not a new one.
    pub fn stamp(&mut self, time: u64, arrived: u64) -> Option<u64> {
        let drifted = self.offset + i128::from(arrived.saturating_sub(self.last.1) / DRIFT);
        let late = difference(arrived, time) - drifted;
        if self.advances(time) && late <= i128::from(LATE_MAX) {
            let offset = drifted.min(difference(arrived, time));
            *self = Self { offset, last: (time, arrived), trial: None, ..*self };
        } else {
            let trial = self.trial.and_then(|trial| trial.next(time, arrived));
            let trial = trial.unwrap_or(Trial { first: (time, arrived), last: time, count: 1 });
            self.trial = Some(trial);
            if trial.count < STEADY {
                return None;
            }
            *self = Self::new(time, arrived);
        }
        u64::try_from(i128::from(time) + self.offset).ok()
    }
}

impl Trial {
    /// With one more frame, if its clock has gone on as the vehicle's has.
    fn next(self, time: u64, arrived: u64) -> Option<Self> {
        let Self { first, last, count } = self;
        let apart = time.saturating_sub(first.0).abs_diff(arrived.saturating_sub(first.1));
        (time > last && apart < SPACING_ERROR).then_some(Self { first, last: time, count: count + 1 })
    }
}

fn difference(a: u64, b: u64) -> i128 {
    i128::from(a) - i128::from(b)
}

#[cfg(test)]
mod tests;
