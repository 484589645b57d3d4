//! A sender's clock against the vehicle's: when a message was true, and whether its time is a new one.
//!
//! A message that arrives at a (the vehicle's clock) with the time s (the sender's) was true at s + o, where o is the
//! clocks' offset. Every arrival is late by the line's delay: a - s = o + delay. So the least a - s seen is nearest to
//! o:
//!
//! ```text
//! o_k = min(a_k - s_k, o_(k-1) + drift (a_k - a_(k-1)))      drift: 200 ppm, more than two quartz clocks part
//! ```
//!
//! The least delay is not observable that way and stays part of o: [`super::time_sync`] may give it, or a measurement.
//! A message is never stamped later than it arrived.
//!
//! One message that is stamped too early, by either clock, would bring o down for minutes. Where TIMESYNC gives the
//! least that o can be, since no message arrives before it is sent, the next message that keeps to it brings o back.
//!
//! A time that does not advance is a frame sent again, or one overtaken: it is refused, for however long. So is one
//! that would be more than [`LATE_MAX_US`] late, or that would bring o down by more than a line becomes quicker: by
//! [`LEAD_MAX_US`] since the first message, and what two clocks part by. A clock that was set, back or forward, or
//! stood still, or begins anew, goes on from frame to frame as the vehicle's does. After [`TRIAL_FRAMES`] such frames,
//! and more than were taken meanwhile, it is believed, and o is found anew: forging fewer messages than are true does
//! not suffice. A line that is that late from some time on looks the same; with TIMESYNC the caller must refuse its
//! messages first.

/// Frames that prove a clock that is not where it was: 50 ms at 100 Hz.
pub const TRIAL_FRAMES: u8 = 5;

/// How late a message may be.
pub const LATE_MAX_US: u64 = 500_000;

/// How much quicker a line may become than at its first message.
pub const LEAD_MAX_US: u64 = 100_000;

/// By how much the clocks may differ over the frames that prove another clock, and how much quicker than those a line
/// may become. Frames that come too early may differ by [`LEAD_MAX_US`]: the first message may have been a slow one on
/// a line whose delay varies.
const SPACING_ERROR_MAX_US: u64 = 20_000;

/// One over the drift between two clocks.
pub(super) const INVERSE_DRIFT: u64 = 5_000;

/// The estimate of a sender's clock.
#[derive(Debug, Clone, Copy)]
pub struct SenderClock {
    /// o, us.
    offset: i128,
    /// By how much it may still come down, us.
    spare: u64,
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
    /// The least that o would be, us.
    offset_min: i128,
    /// Frames of it, and frames that were taken meanwhile.
    count: u8,
    taken: u8,
}

impl SenderClock {
    /// From a sender's first message.
    pub fn new(time: u64, arrived: u64) -> Self {
        Self {
            offset: difference(arrived, time),
            spare: LEAD_MAX_US,
            last: (time, arrived),
            begun: arrived,
            trial: None,
        }
    }

    /// o, with what every message takes at least, us: the vehicle's clock less the sender's.
    pub fn offset(&self) -> i128 {
        self.offset
    }

    /// When it was found, us. It changes when the sender's clock was set and is believed again.
    pub fn begun(&self) -> u64 {
        self.begun
    }

    /// Whether a message of `time` comes after the last one by its sender's clock.
    pub fn advances(&self, time: u64) -> bool {
        time > self.last.0
    }

    /// Brings o back to `offset_min`, us, its minimum, if the message of `time` that arrived at `arrived` keeps
    /// to that.
    pub fn restore(&mut self, offset_min: i128, time: u64, arrived: u64) {
        if self.offset < offset_min && offset_min <= difference(arrived, time) {
            let raised = u64::try_from(offset_min - self.offset).unwrap_or(u64::MAX);
            *self = Self { offset: offset_min, spare: self.spare.saturating_add(raised).min(LEAD_MAX_US), ..*self };
        }
    }

    /// When a message of `time` that arrived at `arrived` was true, us of the vehicle's clock; none if its time is not
    /// a new one.
    pub fn stamp(&mut self, time: u64, arrived: u64) -> Option<u64> {
        let parted = arrived.saturating_sub(self.last.1) / INVERSE_DRIFT;
        let drifted = self.offset + i128::from(parted);
        let offset = drifted.min(difference(arrived, time));
        let late = difference(arrived, time) - drifted;
        let lowered = u64::try_from((self.offset - offset).max(0)).unwrap_or(u64::MAX);
        let spare = self.spare.max(self.spare.saturating_add(parted).min(SPACING_ERROR_MAX_US)).checked_sub(lowered);
        if let (true, Some(spare)) = (self.advances(time) && late <= i128::from(LATE_MAX_US), spare) {
            let trial = self.trial.and_then(Trial::doubt);
            *self = Self { offset, spare, last: (time, arrived), trial, ..*self };
        } else {
            let apart_max = if spare.is_none() { LEAD_MAX_US } else { SPACING_ERROR_MAX_US };
            let trial = self.trial.and_then(|trial| trial.next(time, arrived, apart_max));
            let trial = trial.unwrap_or_else(|| Trial::new(time, arrived));
            self.trial = Some(trial);
            if trial.count < TRIAL_FRAMES {
                return None;
            }
            *self = Self { offset: trial.offset_min, spare: SPACING_ERROR_MAX_US, ..Self::new(time, arrived) };
        }
        u64::try_from(i128::from(time) + self.offset).ok()
    }
}

impl Trial {
    fn new(time: u64, arrived: u64) -> Self {
        Self { first: (time, arrived), last: time, offset_min: difference(arrived, time), count: 1, taken: 0 }
    }

    /// With one more frame, if its clock has gone on as the vehicle's has.
    fn next(self, time: u64, arrived: u64, apart_max: u64) -> Option<Self> {
        let Self { first, last, offset_min, count, .. } = self;
        let apart = time.saturating_sub(first.0).abs_diff(arrived.saturating_sub(first.1));
        let offset_min = offset_min.min(difference(arrived, time));
        (time > last && apart < apart_max).then_some(Self { last: time, offset_min, count: count + 1, ..self })
    }

    /// Another frame is taken: none, where more of those are than of its own.
    fn doubt(self) -> Option<Self> {
        let taken = self.taken + 1;
        (taken < self.count).then_some(Self { taken, ..self })
    }
}

fn difference(a: u64, b: u64) -> i128 {
    i128::from(a) - i128::from(b)
}

#[cfg(test)]
mod tests;
