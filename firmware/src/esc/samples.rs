//! From samples of a port's pins to an answer's levels.
//!
//! ```text
//! samples, SAMPLES_PER_BIT a bit -> runs of one level -> each a whole number of bits -> 21 levels
//! ```
//!
//! A line rests high; the answer begins with the first low sample. Every edge sets the count of bits anew, so that a
//! controller's clock may differ by a twelfth: a run is of three bits at most, and half a bit may be missing of it.

use super::gcr::LEVEL_COUNT;
use crate::dshot::BIT_RATE_HZ;

/// Samples in a bit of an answer.
pub const SAMPLES_PER_BIT: usize = 4;

/// A controller answers at 5/4 of the rate of its frames.
pub const SAMPLE_RATE_HZ: u32 = BIT_RATE_HZ / 4 * 5 * SAMPLES_PER_BIT as u32;

/// Samples of a frame's answer: 107 us. It comes some 30 us after the frame and takes 56.
pub const SAMPLE_COUNT: usize = 160;

/// Bits that a level lasts at most: the line code has no more than two zeros in a row.
const RUN_BITS_MAX: usize = 3;

/// The levels of the answer on a `pin` (0 to 15) of a port; none where no answer came, or only a part of one.
pub fn levels(samples: &[u16], pin: u8) -> Option<u32> {
    let mut high = samples.iter().map(|sample| sample >> (pin & 15) & 1 == 1).peekable();
    // It rests, or is what is left of the frame.
    while high.next_if_eq(&true).is_some() {}
    let (mut levels, mut count) = (0, 0);
    while count < LEVEL_COUNT {
        let &level = high.peek()?;
        let mut length = 0;
        while high.next_if_eq(&level).is_some() {
            length += 1;
        }
        let bits = (length + SAMPLES_PER_BIT / 2) / SAMPLES_PER_BIT;
        let left = LEVEL_COUNT - count;
        // The last level, if it is high, goes on as rest; a low one ends where the line rises.
        let bits = if level { bits.min(left) } else { bits };
        if !(1..=RUN_BITS_MAX).contains(&bits) || bits > left {
            return None;
        }
        levels = levels << bits | if level { (1 << bits) - 1 } else { 0 };
        count += bits;
    }
    Some(levels)
}

#[cfg(test)]
mod tests;
