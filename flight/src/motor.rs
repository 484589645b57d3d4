//! Requests for one motor, and for its controller, while nothing else turns.

/// One motor to be turned slowly for a while, to see which it is and which way it turns. While it turns, another test
/// of the same motor takes the place of this one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorTest {
    /// Its index in the rotors' order.
    pub rotor: usize,
    /// Part of the command's range, in (0, [`super::rules::MOTOR_TEST_LEVEL_MAX`]].
    pub level: f32,
    /// How long, us, in (0, [`super::rules::MOTOR_TEST_MAX_US`]].
    pub duration: u64,
}

/// Something for one motor's controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MotorSetting {
    /// The motor's index in the rotors' order.
    pub rotor: usize,
    /// What it is to do.
    pub setting: Setting,
}

/// A command to a motor's controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Setting {
    /// Beep.
    Beep,
    /// Turn the motor as it is wired, from now on.
    Normal,
    /// Turn the motor the other way, from now on.
    Reversed,
}

/// One word to a motor's controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Word {
    /// Beep.
    Beep,
    /// Turn as it is wired.
    Normal,
    /// Turn the other way.
    Reversed,
    /// Keep that.
    Save,
}
