//! Commands: COMMAND_LONG, and what this vehicle makes of it.
//!
//! | command | does |
//! |---|---|
//! | 400 COMPONENT_ARM_DISARM | 1 asks the flight rules to arm, 0 disarms at once; forcing (parameter 2) is not listened to |
//! | 209 DO_MOTOR_TEST | asks the flight rules for one motor (1 to 4), throttle in percent, for a time in seconds |
//! | 176 DO_SET_MODE | guided flight is the only mode there is; with the HIL flag, while disarmed: sensors from a simulator |
//! | any other | is answered as unsupported |

use super::frame::{Frame, Header};
use super::message::mode;
use super::reply::CommandResult;
use crate::hardware::MOTORS;
use controller_core::flight::{MotorTest, Request};

/// MAV_CMD_COMPONENT_ARM_DISARM.
pub const ARM_DISARM: u16 = 400;
/// MAV_CMD_DO_MOTOR_TEST.
pub const MOTOR_TEST: u16 = 209;
/// MAV_CMD_DO_SET_MODE.
pub const SET_MODE: u16 = 176;

/// MOTOR_TEST_THROTTLE_PERCENT.
const THROTTLE_PERCENT: f32 = 0.0;

/// The custom main mode by which PX4's clients ask for flight by setpoints (OFFBOARD).
const CUSTOM_OFFBOARD: f32 = 6.0;

/// How long the same frame again is a repetition, us. Its sequence number returns after 256 frames, which take longer.
const REPETITION: u64 = 1_000_000;

/// A COMMAND_LONG.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    /// Parameters 1 to 7.
    pub parameters: [f32; 7],
    /// MAV_CMD.
    pub command: u16,
}

impl Command {
    /// The command in a COMMAND_LONG.
    #[must_use]
    pub fn from_frame(frame: &Frame<'_>) -> Self {
        Self { parameters: core::array::from_fn(|index| frame.f32(4 * index)), command: frame.u16(28) }
    }
}

/// What to do about a command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Put it to the flight rules, which answer.
    Ask(Request),
    /// Disarm, and say so.
    Disarm,
    /// Take sensors from a simulator from now on, and say so.
    EnterHil,
    /// Only answer.
    Answer(CommandResult),
}

/// What to do about `command` while armed or not.
#[must_use]
pub fn action(command: &Command, armed: bool) -> Action {
    let denied = Action::Answer(CommandResult::Denied);
    let [first, second, third, fourth, fifth, ..] = command.parameters;
    match command.command {
        ARM_DISARM if first == 0.0 => Action::Disarm,
        ARM_DISARM if first == 1.0 => Action::Ask(Request::Arm),
        ARM_DISARM => denied,
        MOTOR_TEST => {
            let rotor = (1..=MOTORS).find(|&number| first == number as f32);
            let one = fifth == 0.0 || fifth == 1.0;
            match rotor {
                Some(number) if one && second == THROTTLE_PERCENT && third.is_finite() && fourth.is_finite() => {
                    // What is too much or too long is the flight rules' to refuse; negative ones become zero, which is
                    // refused as well.
                    let (level, duration) = (third / 100.0, u64::from((fourth * 1e6) as u32));
                    Action::Ask(Request::MotorTest(MotorTest { rotor: number - 1, level, duration }))
                }
                _ => denied,
            }
        }
        SET_MODE => set_mode(first, second, armed),
        _ => Action::Answer(CommandResult::Unsupported),
    }
}

fn set_mode(base: f32, custom: f32, armed: bool) -> Action {
    let denied = Action::Answer(CommandResult::Denied);
    if !(0.0..=255.0).contains(&base) {
        return denied;
    }
    let base = base as u8;
    if base & mode::HIL != 0 {
        return if armed { denied } else { Action::EnterHil };
    }
    let guided = if base & mode::CUSTOM != 0 { custom == CUSTOM_OFFBOARD } else { base & mode::GUIDED != 0 };
    if guided { Action::Answer(CommandResult::Accepted) } else { denied }
}

/// Knows a command that was delivered twice.
///
/// A command sent again on purpose carries a new sequence number and acts again: arming twice is refused by the flight
/// rules, disarming twice is disarming. The same frame twice is the link's doing, and must not start a second motor test.
#[derive(Debug, Default)]
pub struct Repetitions(Option<(Header, u16, u64)>);

impl Repetitions {
    /// Whether this command's frame is the last one's again.
    pub fn is_repeated(&mut self, frame: &Frame<'_>) -> bool {
        let last = self.0.replace((frame.header, frame.checksum, frame.time));
        last.is_some_and(|(header, checksum, time)| {
            (header, checksum) == (frame.header, frame.checksum) && frame.time.saturating_sub(time) < REPETITION
        })
    }
}
