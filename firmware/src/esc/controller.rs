//! A motor's speed controller, as its answers tell.

use super::answer::Answer;
use crate::hardware::MOTOR_COUNT;
use flight::Stamped;

/// How long a speed counts: some seventeen frames.
pub const SPEED_AGE_MAX_US: u64 = 20_000;

/// How fast the rotors turn, rad/s, in their order; none of a rotor whose controller has not answered of late.
pub type RotorSpeeds = [Option<f32>; MOTOR_COUNT];

/// A controller, as its answers tell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Controller {
    /// The motor's speed, rad/s.
    pub speed: Option<Stamped<f32>>,
    /// Degrees Celsius.
    pub temperature: Option<u8>,
    /// V.
    pub voltage: Option<f32>,
    /// A.
    pub current: Option<u8>,
    /// See [`Answer::Stress`].
    pub stress: Option<u8>,
    /// See [`Answer::Status`].
    pub status: Option<u8>,
    /// Answers, and frames without a valid one since the first; each count starts again after 2^32.
    pub answered: u32,
    /// See [`Self::answered`].
    pub missed: u32,
}

impl Controller {
    /// Takes an answer, or that there was none, at `now`, us, of a motor of so many `poles`.
    pub(super) fn take(&mut self, answer: Option<Answer>, poles: f32, now: u64) {
        let Some(answer) = answer else {
            self.missed = self.missed.wrapping_add(u32::from(self.answered > 0));
            return;
        };
        self.answered = self.answered.wrapping_add(1);
        match answer {
            Answer::Period(_) | Answer::AtRest => {
                self.speed = answer.speed(poles).map(|value| Stamped { value, time: now });
            }
            Answer::Temperature(degrees) => self.temperature = Some(degrees),
            Answer::Voltage(volts) => self.voltage = Some(volts),
            Answer::Current(amperes) => self.current = Some(amperes),
            Answer::Stress(stress) => self.stress = Some(stress),
            Answer::Status(status) => self.status = Some(status),
            Answer::Debug(..) => {}
        }
    }
}
