//! TIMESYNC: the offset of a sender's clock from the vehicle's, from questions and answers.
//!
//! The vehicle asks at t_1 (its clock), the sender answers at s (its own), the answer is here at t_2. If the ways there
//! and back take as long,
//!
//! ```text
//! o = (t_1 + t_2) / 2 - s          and if they do not, |error| <= (t_2 - t_1) / 2
//! ```
//!
//! The answer with the least error counts. An old one's error grows by the clocks' drift. Where two answers in a row
//! cannot be of the same clock, it was set, and the last of them counts. So o holds no delay of the line, which
//! [`SenderClock`](super::sender_clock::SenderClock) cannot distinguish from a clock that is behind.

use super::sender_clock::INVERSE_DRIFT;
use mavlink::dialects::common::TIMESYNC_DATA;

/// The longest that an answer may take.
pub const ANSWER_DELAY_MAX_US: u64 = 100_000;

/// Answers in a row that contradict the best one and prove that the clock was set: a single one may be of another clock
/// in the same system.
const CONTRADICTIONS_MAX: u8 = 2;

/// The greatest age of an answer that counts: three questions' time.
const ANSWER_AGE_MAX_US: u64 = 3_000_000;

/// The clocks' offset, the vehicle's less the sender's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Offset {
    /// o, us.
    pub value: i128,
    /// The greatest error, us.
    pub error: u64,
}

/// The estimate from one sender's answers.
#[derive(Debug, Clone, Copy, Default)]
pub struct TimeSync {
    /// The best answer, and when it came, us.
    best: Option<(Offset, u64)>,
    /// When the last answer came that did not contradict it, us.
    confirmed: Option<u64>,
    /// Answers since that did.
    contradictions: u8,
}

/// The question, at `now`, us.
pub fn question(now: u64) -> TIMESYNC_DATA {
    TIMESYNC_DATA { tc1: 0, ts1: nanoseconds(now) }
}

/// The answer, at `now`, us, to a question of `ts1` of its sender's clock.
pub fn answer(ts1: i64, now: u64) -> TIMESYNC_DATA {
    TIMESYNC_DATA { tc1: nanoseconds(now), ts1 }
}

/// Beyond 292 years it stands still.
fn nanoseconds(time: u64) -> i64 {
    i64::try_from(time).unwrap_or(i64::MAX).saturating_mul(1_000)
}

impl TimeSync {
    /// Of a clock that differs by about `value`, us, at `now`, us: any answer replaces it.
    pub fn presumed(value: i128, now: u64) -> Self {
        Self { best: Some((Offset { value, error: ANSWER_DELAY_MAX_US }, now)), ..Self::default() }
    }

    /// Takes an answer that arrived at `arrived`, us. One to a question of the future, or of long ago, says nothing.
    pub fn take(&mut self, message: &TIMESYNC_DATA, arrived: u64) {
        let asked = u64::try_from(message.ts1 / 1_000).ok();
        let Some(took) = asked.and_then(|asked| arrived.checked_sub(asked)).filter(|&took| took <= ANSWER_DELAY_MAX_US)
        else {
            return;
        };
        let value = i128::from(arrived) - i128::from(took / 2) - i128::from(message.tc1 / 1_000);
        let offset = Offset { value, error: took.div_ceil(2) };
        let best = self.offset(arrived);
        let is_other = best.is_some_and(|best| {
            (offset.value - best.value).unsigned_abs() > u128::from(offset.error) + u128::from(best.error)
        });
        self.contradictions = if is_other { self.contradictions.saturating_add(1) } else { 0 };
        if best.is_none_or(|best| offset.error <= best.error) || self.contradictions >= CONTRADICTIONS_MAX {
            self.best = Some((offset, arrived));
            self.contradictions = 0;
        }
        if self.contradictions == 0 {
            self.confirmed = Some(arrived);
        }
    }

    /// The offset at `now`, us, if a recent answer has agreed.
    pub fn recent(&self, now: u64) -> Option<Offset> {
        let confirmed = self.confirmed?;
        self.offset(now).filter(|_| now.saturating_sub(confirmed) <= ANSWER_AGE_MAX_US)
    }

    /// The offset at `now`, us.
    pub fn offset(&self, now: u64) -> Option<Offset> {
        let (offset, arrived) = self.best?;
        Some(Offset { error: offset.error + now.saturating_sub(arrived).div_ceil(INVERSE_DRIFT), ..offset })
    }
}

#[cfg(test)]
mod tests;
