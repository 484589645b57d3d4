//! What is done with one motor on the bench, while nothing else turns: turning it slowly, and sending words to its
//! controller.
//!
//! | setting | the commands that its controller gets, from the beginning |
//! |---|---|
//! | beep | the word; then the stop command, for as long as the tone sounds |
//! | direction | the word; four times as long the stop command; the word to save; the stop command while it is saved |
//!
//! A word stands for [`WORD_DURATION_US`], rounded up to whole ticks. It goes out every
//! millisecond, so ten times or more: more than the six that such words take to be believed.

use super::exchange::Output;
use super::motor::{MotorSetting, MotorTest, Setting, Word};
use super::refusal::Refusal;
use super::rules::{MOTOR_TEST_LEVEL_MAX, MOTOR_TEST_MAX_US};

/// How long a setting takes: as long as its longest part, the tone of a beep.
const SETTING_DURATION_US: u64 = 300_000;

/// How long a word is sent, at least.
const WORD_DURATION_US: u64 = 10_000;

/// When a direction is saved, in durations of a word after its command.
const SAVED_AFTER_WORDS: u64 = 5;

/// What is under way on the bench.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Bench {
    Turning(MotorTest),
    Setting(MotorSetting),
}

impl Bench {
    /// Nothing.
    pub const NONE: Self = Self::Turning(MotorTest { rotor: 0, level: 0.0, duration: 0 });

    /// Whether a vehicle of so many rotors does it: with one that exists, slowly, not for long.
    pub fn check(&self, rotors: usize) -> Result<(), Refusal> {
        let (rotor, level, duration) = match *self {
            Self::Turning(MotorTest { rotor, level, duration }) => (rotor, level, duration),
            Self::Setting(MotorSetting { rotor, .. }) => (rotor, MOTOR_TEST_LEVEL_MAX, SETTING_DURATION_US),
        };
        // Written so that NaN is refused.
        match () {
            () if rotor >= rotors => Err(Refusal::NoSuchRotor),
            () if !(level > 0.0 && level <= MOTOR_TEST_LEVEL_MAX) => Err(Refusal::MotorTestLevel),
            () if !(1..=MOTOR_TEST_MAX_US).contains(&duration) => Err(Refusal::MotorTestDuration),
            () => Ok(()),
        }
    }

    /// Goes on, `elapsed` us after its beginning, with a test of the motor that turns already; whether it does. The
    /// test passes [`Self::check`].
    pub fn renew(&mut self, test: &MotorTest, elapsed: u64) -> bool {
        match self {
            Self::Turning(turning) if turning.rotor == test.rotor => {
                *turning = MotorTest { duration: elapsed.saturating_add(test.duration), ..*test };
                true
            }
            _ => false,
        }
    }

    /// Whether it is over after `elapsed`, us.
    pub fn is_over(&self, elapsed: u64) -> bool {
        elapsed
            >= match self {
                Self::Turning(test) => test.duration,
                Self::Setting(_) => SETTING_DURATION_US,
            }
    }

    /// For the motors, `elapsed` us after its beginning, in ticks of `period` us.
    pub fn output(&self, elapsed: u64, period: u64) -> Output {
        let MotorSetting { rotor, setting } = match *self {
            Self::Turning(MotorTest { rotor, level, .. }) => return Output::Test { rotor, level },
            Self::Setting(setting) => setting,
        };
        let word_lasts = WORD_DURATION_US.div_ceil(period.max(1)) * period;
        let word = match (setting, elapsed.checked_div(word_lasts)) {
            (Setting::Beep, Some(0)) => Word::Beep,
            (Setting::Normal, Some(0)) => Word::Normal,
            (Setting::Reversed, Some(0)) => Word::Reversed,
            (Setting::Normal | Setting::Reversed, Some(SAVED_AFTER_WORDS)) => Word::Save,
            _ => return Output::Stop,
        };
        Output::Word { rotor, word }
    }
}

#[cfg(test)]
mod tests;
