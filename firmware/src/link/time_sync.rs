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
#[must_use]
pub fn question(now: u64) -> TIMESYNC_DATA {
    TIMESYNC_DATA { tc1: 0, ts1: nanoseconds(now) }
}

/// The answer, at `now`, us, to a question of `ts1` of its sender's clock.
#[must_use]
pub fn answer(ts1: i64, now: u64) -> TIMESYNC_DATA {
    TIMESYNC_DATA { tc1: nanoseconds(now), ts1 }
}

/// Beyond 292 years it stands still.
fn nanoseconds(time: u64) -> i64 {
    i64::try_from(time).unwrap_or(i64::MAX).saturating_mul(1_000)
}

impl TimeSync {
    /// Of a clock that differs by about `value`, us, at `now`, us: any answer replaces it.
    #[must_use]
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
    #[must_use]
    pub fn recent(&self, now: u64) -> Option<Offset> {
        let confirmed = self.confirmed?;
        self.offset(now).filter(|_| now.saturating_sub(confirmed) <= ANSWER_AGE_MAX_US)
    }

    /// The offset at `now`, us.
    #[must_use]
    pub fn offset(&self, now: u64) -> Option<Offset> {
        let (offset, arrived) = self.best?;
        Some(Offset { error: offset.error + now.saturating_sub(arrived).div_ceil(INVERSE_DRIFT), ..offset })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sender whose clock is `ahead` us ahead answers a question of `asked`; its way back takes `back` us.
    fn exchange(sync: &mut TimeSync, asked: u64, ahead: u64, there: u64, back: u64) {
        let message = TIMESYNC_DATA { tc1: nanoseconds(asked + there + ahead), ts1: question(asked).ts1 };
        sync.take(&message, asked + there + back);
    }

    #[test]
    fn a_symmetric_line_leaves_no_error_and_another_no_more_than_it_says() {
        for (there, back) in [(1_000, 1_000), (9_000, 1_000), (100, 19_900), (0, 0)] {
            for ahead in [0, 7, 1_800_000_000_000_000] {
                let mut sync = TimeSync::default();
                exchange(&mut sync, 5_000_000, ahead, there, back);
                let Offset { value, error } = sync.offset(5_000_000).unwrap();
                let found = value + i128::from(ahead);
                assert_eq!(found, (i128::from(back) - i128::from(there)) / 2);
                assert!(found.unsigned_abs() <= error.into() && error == (there + back).div_ceil(2));
            }
        }
    }

    #[test]
    fn the_quickest_answer_counts_until_its_clock_has_parted() {
        let mut sync = TimeSync::default();
        exchange(&mut sync, 0, 50, 500, 500);
        exchange(&mut sync, 1_000_000, 9_000, 4_000, 4_000);
        assert_eq!(sync.offset(1_000_000).unwrap().value, -50);
        // 200 ppm: after 20 s the first is as doubtful as the second.
        exchange(&mut sync, 20_000_000, 9_000, 4_000, 4_000);
        assert_eq!(sync.offset(20_008_000), Some(Offset { value: -9_000, error: 4_000 }));
    }

    #[test]
    fn a_clock_that_was_set_is_known_by_its_second_answer() {
        let mut sync = TimeSync::default();
        exchange(&mut sync, 0, 700_000, 500, 500);
        exchange(&mut sync, 1_000_000, 900_000, 4_000, 4_000);
        assert_eq!(sync.offset(1_000_000).unwrap().value, -700_000);
        // A single one may be of another clock.
        exchange(&mut sync, 2_000_000, 700_000, 4_000, 4_000);
        exchange(&mut sync, 3_000_000, 900_000, 4_000, 4_000);
        assert_eq!(sync.offset(3_000_000).unwrap().value, -700_000);
        assert!(sync.recent(5_008_000).is_some() && sync.recent(5_008_001).is_none());
        exchange(&mut sync, 4_000_000, 900_000, 4_000, 4_000);
        assert_eq!(sync.recent(4_008_000), Some(Offset { value: -900_000, error: 4_000 }));
    }

    #[test]
    fn the_presumed_delay_gives_way_to_any_answer() {
        let mut sync = TimeSync::presumed(-3, 0);
        assert_eq!((sync.offset(0).unwrap().value, sync.recent(0)), (-3, None));
        exchange(&mut sync, 1_000_000, 9_000, 10_000, 90_000);
        assert!(sync.recent(1_100_000).unwrap().value > 0);
    }

    #[test]
    fn an_answer_to_no_question_or_an_old_one_is_ignored() {
        let mut sync = TimeSync::default();
        for (ts1, arrived) in
            [(2_000_001_000, 2_000_000), (-1_000, 5), (i64::MIN, 5), (i64::MAX, u64::MAX), (0, ANSWER_DELAY_MAX_US + 1)]
        {
            sync.take(&TIMESYNC_DATA { tc1: i64::MIN, ts1 }, arrived);
            assert_eq!(sync.offset(arrived), None, "{ts1} {arrived}");
        }
        // Numbers at their limits are numbers.
        sync.take(&TIMESYNC_DATA { tc1: i64::MIN, ts1: 0 }, 0);
        assert!(sync.offset(u64::MAX).is_some());
    }
}
