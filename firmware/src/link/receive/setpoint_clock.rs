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
mod tests;
