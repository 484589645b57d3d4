//! A sender's clock against the vehicle's: when a message was true, and whether its time is a new one.
//!
//! A message that arrives at a (the vehicle's clock) and says s (the sender's) was true at s + o, where o is what the clocks differ by.
//! Every arrival is late by what the line took: a - s = o + delay. So the least a - s seen is nearest to o:
//!
//! ```text
//! o_k = min(a_k - s_k, o_(k-1) + drift (a_k - a_(k-1)))      drift: 200 ppm, more than two quartz clocks part
//! ```
//!
//! What every message takes at least is not seen that way and stays part of o. A message is never stamped later than it arrived.
//!
//! A time that does not advance is a frame sent again, or one overtaken: it is refused, for however long. A clock that was set back, or
//! begins anew, advances from frame to frame as the vehicle's does. After [`STEADY`] such frames it is believed, and o is found anew.

/// Frames in a row that prove a clock that was set back: 50 ms at 100 Hz.
pub const STEADY: u8 = 5;

/// How much two clocks may differ over the time between two frames, us: what a line's delay may change by.
const SPACING_ERROR: u64 = 50_000;

/// One over the drift between two clocks.
const DRIFT: u64 = 5_000;

/// What is known of a sender's clock.
#[derive(Debug, Clone, Copy)]
pub struct SenderClock {
    /// o, us.
    offset: i128,
    /// The sender's time of the last message that was taken, and when that arrived, us.
    last: (u64, u64),
    /// The same of the last message whose time did not advance, and how many like it came in a row.
    back: Option<(u64, u64, u8)>,
}

impl SenderClock {
    /// From a sender's first message.
    #[must_use]
    pub fn new(time: u64, arrived: u64) -> Self {
        Self { offset: difference(arrived, time), last: (time, arrived), back: None }
    }

    /// When a message that says `time` and arrived at `arrived` was true, us of the vehicle's clock; none if its time is not a new
    /// one.
    pub fn stamp(&mut self, time: u64, arrived: u64) -> Option<u64> {
        if time > self.last.0 {
            let elapsed = arrived.saturating_sub(self.last.1);
            let drifted = self.offset + i128::from(elapsed / DRIFT);
            self.offset = drifted.min(difference(arrived, time));
            (self.last, self.back) = ((time, arrived), None);
        } else {
            let steady = self.back.filter(|&(before, then, _)| is_steady(before, then, time, arrived));
            let count = steady.map_or(1, |(.., count)| count + 1);
            self.back = Some((time, arrived, count));
            if count < STEADY {
                return None;
            }
            *self = Self::new(time, arrived);
        }
        u64::try_from(i128::from(time) + self.offset).ok()
    }
}

/// Whether a clock has advanced from one message to the next as the vehicle's has.
fn is_steady(before: u64, then: u64, time: u64, arrived: u64) -> bool {
    let elapsed = arrived.saturating_sub(then);
    time > before && (time - before).abs_diff(elapsed) < SPACING_ERROR
}

fn difference(a: u64, b: u64) -> i128 {
    i128::from(a) - i128::from(b)
}

#[cfg(test)]
mod tests;
