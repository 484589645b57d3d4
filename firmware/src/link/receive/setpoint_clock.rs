//! When a setpoint was true, by its sender's clock: a line, and a sender's scheduler, deliver it by milliseconds too
//! late, now more, now less.
//!
//! ```text
//! o_k = min(a_k - s_k, o_(k-1) + drift (a_k - a_(k-1))),    true at s_k + o_k
//! ```
//!
//! with a the arrival and s the sender's time, ms. The least delay stays part of o, so a setpoint is never later than
//! the line's quickest. A stream of moving points needs the time between two of them to know how acceleration changes
//! ([`controller_core::governor::Governor::accept_late`]). A sender without times, whose time does not go on, or that
//! would be more than [`SETPOINT_AGE_MAX_S`](controller_core::governor::SETPOINT_AGE_MAX_S) late, has its setpoints
//! counted as true when they come; from there on a clock is learnt anew. It refuses nothing, and takes a tenth of the
//! memory of [`sender_clock`](crate::link::sender_clock), which keeps old and forged poses out.

use crate::link::sender_clock::INVERSE_DRIFT;
use controller_core::governor::SETPOINT_AGE_MAX_S;

/// A sender's clock.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SetpointClock {
    /// o, us.
    offset: i64,
    /// The sender's last time, ms; zero before the first.
    last: u32,
    /// When that arrived, us.
    arrived: u64,
}

impl SetpointClock {
    /// When a setpoint of the sender's `time`, ms, that arrived at `arrived`, us, was true, us.
    pub fn stamp(&mut self, time: u32, arrived: u64) -> u64 {
        let found = arrived as i64 - i64::from(time) * 1_000;
        let drifted = self.offset + arrived.saturating_sub(self.arrived) as i64 / INVERSE_DRIFT as i64;
        let goes_on = self.last > 0 && time > self.last;
        let is_late = (found - drifted) as f32 * 1e-6 > SETPOINT_AGE_MAX_S;
        let offset = if goes_on && !is_late { found.min(drifted) } else { found };
        *self = Self { offset, last: time, arrived };
        arrived - (found - offset) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn setpoints_that_come_unevenly_are_as_far_apart_as_their_sender_says() {
        let mut clock = SetpointClock::default();
        let delays = [9, 3, 12, 3, 5, 14, 4, 8];
        let stamps: Vec<u64> = (0..8)
            .zip(delays)
            .map(|(number, delay)| {
                clock.stamp(700 + 20 * number, 5_000_000 + 20_000 * u64::from(number) + 1_000 * delay)
            })
            .collect();
        // The second was the quickest.
        for pair in stamps[1..].windows(2) {
            assert!((pair[1] - pair[0]).abs_diff(20_000) <= 20, "{stamps:?}");
        }
    }

    #[test]
    fn a_sender_without_times_counts_from_when_its_setpoints_come() {
        let mut clock = SetpointClock::default();
        for arrived in [1_000, 21_000, 45_000] {
            assert_eq!(clock.stamp(0, arrived), arrived);
            assert_eq!(SetpointClock::default().stamp(77, arrived), arrived);
        }
    }

    #[test]
    fn a_clock_that_was_set_or_began_anew_is_learnt_anew() {
        let mut clock = SetpointClock::default();
        clock.stamp(50_000, 1_000_000);
        assert_eq!(clock.stamp(50_020, 1_023_000), 1_020_004);
        // Begun anew, then stood still for a second.
        assert_eq!(clock.stamp(20, 1_040_000), 1_040_000);
        assert_eq!(clock.stamp(40, 2_060_000), 2_060_000);
        assert_eq!(clock.stamp(60, 2_080_000), 2_080_000);
        // A time far ahead is believed, and never leads a setpoint to the future.
        assert_eq!(clock.stamp(4_000_000_000, 2_100_000), 2_100_000);
    }
}
