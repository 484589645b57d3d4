//! When controllers are asked for extended answers: until they send some.
//!
//! A controller sends temperature, voltage and current once it has had the word for that six times in a row, and takes
//! it only while its motor stands still. So while every motor is stopped, each [`INTERVAL_FRAMES`] frames begin with
//! [`REQUEST_FRAMES`] that carry the word to the controllers that have sent nothing extended since the last start. What
//! carries the word stops the motor as the stop command does.

use super::answer::Answer;
use crate::hardware::MOTOR_COUNT;

/// Frames that carry the word, in a row: some may be lost.
pub const REQUEST_FRAMES: u16 = 10;

/// From one request to the next: a second at a thousand frames a second.
pub const INTERVAL_FRAMES: u16 = 1_000;

/// Which controllers still have to be asked.
#[derive(Debug, Default)]
pub struct Request {
    /// Frames since the last request began.
    frames: u16,
    extended: [bool; MOTOR_COUNT],
}

impl Request {
    /// The motors to which the next frame carries the word, where all of them are `stopped` or not.
    pub fn next(&mut self, stopped: bool) -> [bool; MOTOR_COUNT] {
        // Six in a row: a start begins anew.
        self.frames = if stopped { (self.frames + 1) % INTERVAL_FRAMES } else { 0 };
        // The first second is theirs, to start in.
        let asks = stopped && self.frames >= INTERVAL_FRAMES - REQUEST_FRAMES;
        self.extended.map(|extended| asks && !extended)
    }

    /// Takes note of what was answered.
    pub fn note(&mut self, answers: &[Option<Answer>; MOTOR_COUNT]) {
        for (extended, answer) in self.extended.iter_mut().zip(answers) {
            *extended |= answer.is_some_and(|answer| !matches!(answer, Answer::Period(_) | Answer::AtRest));
        }
    }
}

#[cfg(test)]
mod tests;
