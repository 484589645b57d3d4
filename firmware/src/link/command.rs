//! Commands: COMMAND_LONG, and what this vehicle makes of it.
//!
//! | command | does |
//! |---|---|
//! | 400 COMPONENT_ARM_DISARM | asks the flight rules to arm (1) or disarm (0); 0 with parameter 2 = 21196 disarms at once, in the air as well |
//! | 22 NAV_TAKEOFF | asks to take off, parameter 7 high (m) above where it stands; NaN or 0: as high as `TKO_ALT` says |
//! | 21 NAV_LAND | asks to land here |
//! | 176 DO_SET_MODE | PX4's custom modes: asks to fly setpoints (6), to hold (4, 3), to take off (4, 2), to land (4, 6). The HIL flag alone: sensors from a simulator, while disarmed |
//! | 209 DO_MOTOR_TEST | asks the flight rules for one motor (1 to 4), throttle in percent, for a time in seconds |
//! | 241 PREFLIGHT_CALIBRATION | while disarmed: gyro (parameter 1 = 1), accelerometer (parameter 5 = 1, 2 or 4); all zero ends it |
//! | any other of the dialect | is answered as unsupported |

use super::frame::{Frame, Header};
use crate::hardware::MOTORS;
use crate::shared::Procedure;
use controller_core::flight::{MotorTest, Request};
use mavlink::dialects::common::{COMMAND_LONG_DATA, MavCmd, MavModeFlag, MavResult, MotorTestThrottleType};

/// The number that forces (MAVLink's, in parameter 2 of an arm command).
const FORCE: f32 = 21196.0;

/// PX4's custom main modes, and what AUTO is divided into.
const AUTO: f32 = 4.0;
const OFFBOARD: f32 = 6.0;
const AUTO_TAKEOFF: f32 = 2.0;
const AUTO_LOITER: f32 = 3.0;
const AUTO_LAND: f32 = 6.0;

/// How long the same frame again is a repetition, us. Its sequence number returns after 256 frames, which take longer.
const REPETITION: u64 = 1_000_000;

/// What to do about a command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Put it to the flight rules, which answer.
    Ask(Request),
    /// Disarm at once, in the air as well, and say so.
    ForceDisarm,
    /// Take sensors from a simulator from now on, and say so.
    EnterHil,
    /// Calibrate, or end a calibration; the IMU task answers.
    Calibrate(Option<Procedure>),
    /// Only answer.
    Answer(MavResult),
}

/// What to do about `command` while armed or not.
#[must_use]
pub fn action(command: &COMMAND_LONG_DATA, armed: bool) -> Action {
    match command.command {
        MavCmd::MAV_CMD_COMPONENT_ARM_DISARM => match command.param1 {
            0.0 if command.param2 == FORCE => Action::ForceDisarm,
            0.0 => Action::Ask(Request::Disarm),
            1.0 => Action::Ask(Request::Arm),
            _ => DENIED,
        },
        MavCmd::MAV_CMD_NAV_TAKEOFF => {
            // Most clients that name no height send NaN, some zero.
            let height = Some(command.param7).filter(|height| !height.is_nan() && *height != 0.0);
            Action::Ask(Request::TakeOff(height))
        }
        MavCmd::MAV_CMD_NAV_LAND => Action::Ask(Request::Land),
        MavCmd::MAV_CMD_DO_MOTOR_TEST => {
            motor_test(command).map_or(DENIED, |test| Action::Ask(Request::MotorTest(test)))
        }
        MavCmd::MAV_CMD_DO_SET_MODE => set_mode(command, armed),
        MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION => calibration(command),
        _ => Action::Answer(MavResult::MAV_RESULT_UNSUPPORTED),
    }
}

const DENIED: Action = Action::Answer(MavResult::MAV_RESULT_DENIED);

/// The test of one motor that a command asks for. What is too much or too long is the flight rules' to refuse; negative times
/// become zero, which is refused as well.
fn motor_test(command: &COMMAND_LONG_DATA) -> Option<MotorTest> {
    let COMMAND_LONG_DATA { param1: motor, param2: unit, param3: throttle, param4: seconds, param5: count, .. } =
        *command;
    let rotor = (0..MOTORS).find(|&rotor| motor == (rotor + 1) as f32)?;
    let in_percent = unit == MotorTestThrottleType::MOTOR_TEST_THROTTLE_PERCENT as u32 as f32;
    let is_one = count == 0.0 || count == 1.0;
    let usable = in_percent && is_one && throttle.is_finite() && seconds.is_finite();
    usable.then(|| MotorTest { rotor, level: throttle / 100.0, duration: (seconds * 1e6) as u64 })
}

/// One calibration at a time, of what there is. Magnetometer, barometer, radio and temperature are not.
fn calibration(command: &COMMAND_LONG_DATA) -> Action {
    let COMMAND_LONG_DATA { param1: gyro, param2, param3, param4, param5: accelerometer, param6, param7, .. } =
        *command;
    if [param2, param3, param4, param6, param7].iter().any(|other| *other != 0.0) {
        return Action::Answer(MavResult::MAV_RESULT_UNSUPPORTED);
    }
    let procedure = match (gyro, accelerometer) {
        (0.0, 0.0) => None,
        (1.0, 0.0) => Some(Procedure::Gyro),
        (0.0, 1.0) => Some(Procedure::SixSides),
        (0.0, 2.0) => Some(Procedure::Level),
        (0.0, 4.0) => Some(Procedure::OneSide),
        _ => return Action::Answer(MavResult::MAV_RESULT_UNSUPPORTED),
    };
    Action::Calibrate(procedure)
}

/// PX4's clients say the custom mode, and echo what flags the heartbeat has. Without one, the HIL flag asks for a simulator and the
/// guided flag for flight by setpoints.
fn set_mode(command: &COMMAND_LONG_DATA, armed: bool) -> Action {
    let COMMAND_LONG_DATA { param1: base, param2: main, param3: sub, .. } = *command;
    if !(0.0..=255.0).contains(&base) {
        return DENIED;
    }
    let base = MavModeFlag::from_bits_retain(base as u8);
    if base.contains(MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED) {
        return match (main, sub) {
            (OFFBOARD, _) => Action::Ask(Request::FlySetpoints),
            (AUTO, AUTO_LOITER) => Action::Ask(Request::Hold),
            (AUTO, AUTO_TAKEOFF) => Action::Ask(Request::TakeOff(None)),
            (AUTO, AUTO_LAND) => Action::Ask(Request::Land),
            _ => DENIED,
        };
    }
    if base.contains(MavModeFlag::MAV_MODE_FLAG_HIL_ENABLED) {
        return if armed { DENIED } else { Action::EnterHil };
    }
    let guided = base.contains(MavModeFlag::MAV_MODE_FLAG_GUIDED_ENABLED);
    if guided { Action::Ask(Request::FlySetpoints) } else { DENIED }
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
