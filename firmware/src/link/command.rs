//! Commands: COMMAND_LONG and COMMAND_INT, and SET_MODE, which means 176; and their actions.
//!
//! | command | does |
//! |---|---|
//! | 400 COMPONENT_ARM_DISARM | requests arming (1) or disarming (0); 0 with parameter 2 = 21196 disarms at once, in the air as well |
//! | 22 NAV_TAKEOFF | requests a take-off, parameter 7 high (m) above where it stands; NaN or 0: as high as `TKO_ALT`. By COMMAND_INT in a global frame, and from here only |
//! | 21 NAV_LAND | requests a landing here |
//! | 176 DO_SET_MODE | PX4's custom modes: requests to fly setpoints (6), to hold (4, 3), to fly the mission (4, 4), to take off (4, 2), to land (4, 6), to let the policy fly that is built in (4, 11). The HIL flag alone: sensors from a simulator, while disarmed |
//! | 300 MISSION_START | requests to fly the mission from item parameter 1 on; NaN or below 0: from where it was left |
//! | 193 DO_PAUSE_CONTINUE | requests to hold (0), to go on with the mission (1) |
//! | 224 DO_SET_MISSION_CURRENT | makes item parameter 1 the mission's next |
//! | 209 DO_MOTOR_TEST | requests a test of one motor (1 to 4), throttle in percent, for a time in seconds |
//! | 310 ACTUATOR_TEST | the same, by a value from 0 to 1 (parameter 1; NaN ends it), for a time (parameter 2, s; 0 ends it), of motor 1 to 4 (parameter 5), or 1101 to 1104 as QGroundControl counts PX4's; a test of the motor that turns goes on |
//! | 311 CONFIGURE_ACTUATOR | requests one motor (parameter 5, 1 to 4) to beep (1), or turn as wired (4) or the other way (5) from now on |
//! | 241 PREFLIGHT_CALIBRATION | while disarmed: gyro (parameter 1 = 1), accelerometer (parameter 5 = 1, 2 or 4); all zero ends it |
//! | 246 PREFLIGHT_REBOOT_SHUTDOWN | parameter 1 = 1: restarts the vehicle, disarmed and with no motor turning; 3: into the chip's bootloader. Anything else is not done here |
//! | 401 RUN_PREARM_CHECKS | while disarmed: the [bench report](super::bench_report), in texts |
//! | 192 DO_REPOSITION | by COMMAND_INT: requests a flight to a latitude, longitude and altitude and to hold there |
//! | 512 REQUEST_MESSAGE, 511, 510 SET and GET_MESSAGE_INTERVAL | any message of [`STREAMS`](super::telemetry::kind::STREAMS); 435 AVAILABLE_MODES on request |
//! | any other | is answered as unsupported |

#![expect(deprecated, reason = "superseded commands and frames: clients still send them")]

use super::mission::MISSION_CAPACITY;
use super::origin::{Origin, Place};
use super::set_mode::SetMode;
use super::telemetry::kind::Kind;
use super::telemetry::vehicle;
use crate::frames;
use crate::hardware::MOTOR_COUNT;
use crate::shared::{Procedure, Reply};
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use flight::{MotorSetting, MotorTest, Request, Setting};
use mavlink::dialects::common::{
    ActuatorConfiguration, COMMAND_INT_DATA, COMMAND_LONG_DATA, MavCmd, MavFrame, MavModeFlag, MavResult,
    MotorTestThrottleType,
};
use nalgebra::Vector3;

/// The number that forces (MAVLink's, in parameter 2 of an arm command).
const FORCE_NUMBER: f32 = 21196.0;

/// PX4's custom main modes, and what AUTO is divided into.
const MAIN_AUTO: f32 = 4.0;
const MAIN_OFFBOARD: f32 = 6.0;
const AUTO_TAKEOFF: f32 = 2.0;
const AUTO_LOITER: f32 = 3.0;
const AUTO_MISSION: f32 = 4.0;
const AUTO_LAND: f32 = 6.0;
const AUTO_EXTERNAL1: f32 = 11.0;

/// The bit of DO_REPOSITION's parameter 2 by which its yaw counts from the present one
/// (MAV_DO_REPOSITION_FLAGS_RELATIVE_YAW).
const RELATIVE_YAW: u32 = 2;

/// The action of a command.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Put it to the flight rules, which answer.
    Request(Request),
    /// Disarm at once, in the air as well, and acknowledge.
    ForceDisarm,
    /// Take sensors from a simulator from now on, and acknowledge.
    EnterHil,
    /// Restart the vehicle.
    Restart,
    /// Restart it into a bootloader.
    StartBootloader,
    /// Announce this, and answer so.
    Refuse(MavResult, &'static str),
    /// Calibrate, or end a calibration; the IMU task answers.
    Calibrate(Option<Procedure>),
    /// Only answer.
    Answer(MavResult),
    /// Send this message, and answer whether there was anything to send.
    Send(Kind),
    /// Accept, and send a reply besides.
    Reply(Reply),
    /// Accept, and name every mode.
    ReplyModes,
}

/// A command, however it came.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Call {
    /// Which.
    pub command: MavCmd,
    /// Its parameters; of a COMMAND_INT the fifth and sixth are not numbers of this kind.
    pub parameters: [f32; 7],
    /// The place, units of degrees, and the frame of COMMAND_INT.
    pub place: Option<(i32, i32, MavFrame)>,
}

impl From<&COMMAND_LONG_DATA> for Call {
    fn from(message: &COMMAND_LONG_DATA) -> Self {
        let &COMMAND_LONG_DATA { command, param1, param2, param3, param4, param5, param6, param7, .. } = message;
        Self { command, parameters: [param1, param2, param3, param4, param5, param6, param7], place: None }
    }
}

impl From<&SetMode> for Call {
    fn from(message: &SetMode) -> Self {
        let [base, main, sub] = [message.base, message.main, message.sub].map(f32::from);
        let command = MavCmd::MAV_CMD_DO_SET_MODE;
        Self { command, parameters: [base, main, sub, 0.0, 0.0, 0.0, 0.0], place: None }
    }
}

impl From<&COMMAND_INT_DATA> for Call {
    fn from(message: &COMMAND_INT_DATA) -> Self {
        let &COMMAND_INT_DATA { command, param1, param2, param3, param4, x, y, z, frame, .. } = message;
        let parameters = [param1, param2, param3, param4, x as f32, y as f32, z];
        Self { command, parameters, place: Some((x, y, frame)) }
    }
}

/// The action of a command while armed or not, where the local frame is at `origin` and home at `home`, m, NED.
pub fn action(call: &Call, armed: bool, origin: &Origin, home: &Vector3<f32>) -> Action {
    let [first, second, ..] = call.parameters;
    match call.command {
        MavCmd::MAV_CMD_COMPONENT_ARM_DISARM => match first {
            0.0 if second == FORCE_NUMBER => Action::ForceDisarm,
            0.0 => Action::Request(Request::Disarm),
            1.0 => Action::Request(Request::Arm),
            _ => denied("Arm: parameter 1 is 1 to arm, 0 to disarm"),
        },
        MavCmd::MAV_CMD_NAV_TAKEOFF => take_off(call, origin, home),
        MavCmd::MAV_CMD_NAV_LAND => Action::Request(Request::Land),
        MavCmd::MAV_CMD_DO_REPOSITION => reposition(call, origin, home),
        MavCmd::MAV_CMD_DO_MOTOR_TEST => motor_test(call),
        MavCmd::MAV_CMD_ACTUATOR_TEST => actuator_test(call),
        MavCmd::MAV_CMD_RUN_PREARM_CHECKS if armed => Action::Answer(MavResult::MAV_RESULT_TEMPORARILY_REJECTED),
        MavCmd::MAV_CMD_RUN_PREARM_CHECKS => Action::Reply(Reply::BenchReport),
        MavCmd::MAV_CMD_CONFIGURE_ACTUATOR => configure_actuator(call),
        MavCmd::MAV_CMD_DO_SET_MODE => set_mode(call, armed),
        MavCmd::MAV_CMD_MISSION_START => mission_start(call),
        MavCmd::MAV_CMD_DO_PAUSE_CONTINUE => match first {
            0.0 => Action::Request(Request::Hold),
            1.0 => Action::Request(Request::FlyMission(None)),
            _ => denied("Pause: parameter 1 is 0, or 1 to go on"),
        },
        MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT => match mission_item(first) {
            Some(item) => Action::Request(Request::SetMissionItem(item)),
            None => denied("Mission item: parameter 1 is its number"),
        },
        MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION => calibration(call),
        MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN => restart(call),
        MavCmd::MAV_CMD_REQUEST_MESSAGE if first == AVAILABLE_MODES_NUMBER => match second {
            0.0 => Action::ReplyModes,
            index if (1.0..=f32::from(vehicle::MODE_COUNT)).contains(&index) => Action::Reply(Reply::Mode(index as u8)),
            _ => denied("Modes: parameter 2 is 0 or a mode's index"),
        },
        MavCmd::MAV_CMD_REQUEST_MESSAGE => of_kind(first, Action::Send),
        MavCmd::MAV_CMD_GET_MESSAGE_INTERVAL => of_kind(first, |kind| Action::Reply(Reply::IntervalOf(kind))),
        MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL if second.is_finite() => of_kind(first, |kind| match kind {
            // Other systems detect the vehicle by it.
            Kind::Heartbeat if !(0.0..=HEARTBEAT_INTERVAL_MAX_US).contains(&second) => {
                denied("HEARTBEAT: once a second, or more often")
            }
            _ => Action::Reply(Reply::Interval { kind, interval: second as i64 }),
        }),
        MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL => denied("Message interval: parameter 2 is not a number"),
        // Older clients' REQUEST_MESSAGE.
        MavCmd::MAV_CMD_GET_HOME_POSITION => Action::Send(Kind::HomePosition),
        MavCmd::MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES => Action::Send(Kind::AutopilotVersion),
        MavCmd::MAV_CMD_REQUEST_PROTOCOL_VERSION => Action::Send(Kind::ProtocolVersion),
        _ => Action::Answer(MavResult::MAV_RESULT_UNSUPPORTED),
    }
}

const AVAILABLE_MODES_NUMBER: f32 = 435.0;

/// The longest time between heartbeats.
const HEARTBEAT_INTERVAL_MAX_US: f32 = 1e6;

/// An action on the message of this number; unsupported if the vehicle does not send it.
fn of_kind(number: f32, act: impl Fn(Kind) -> Action) -> Action {
    // NaN or a negative number becomes that of HEARTBEAT, which is not requested that way.
    let kind = Some(number).filter(|number| *number >= 0.0).and_then(|number| Kind::from_number(number as u32));
    kind.map_or(Action::Answer(MavResult::MAV_RESULT_UNSUPPORTED), act)
}

/// How high above home, m, an altitude in this frame is; none in a frame that is not of the globe.
fn above_home(frame: MavFrame, altitude: f32, home: f32) -> Option<f32> {
    match frame {
        MavFrame::MAV_FRAME_GLOBAL | MavFrame::MAV_FRAME_GLOBAL_INT => Some(altitude - home),
        MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT | MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT => Some(altitude),
        _ => None,
    }
}

/// How far from home a take-off may be requested.
const TAKE_OFF_DISTANCE_MAX_M: f32 = 2.0;

/// Taking off, straight up. Most clients that name no height or place send NaN or the greatest number, some zero.
fn take_off(call: &Call, origin: &Origin, home: &Vector3<f32>) -> Action {
    let [.., latitude, longitude, altitude] = call.parameters;
    let is_named = !altitude.is_nan() && altitude != 0.0;
    let (place, height) = match call.place {
        // A place of COMMAND_LONG is in degrees, rounded to half a metre; NaN and zero are missing.
        None => {
            let degrees = [latitude, longitude].map(|degrees| (degrees * 1e7) as i32);
            ((degrees[0], degrees[1]), Some(altitude))
        }
        Some((latitude, longitude, frame)) => {
            ((latitude, longitude), above_home(frame, altitude, origin.place(home).altitude))
        }
    };
    let Some(height) = height else { return unsupported("Take-off: in a global frame only") };
    let (latitude, longitude) = place;
    let away = origin.local(&Place { latitude, longitude, altitude }) - home;
    if place != (0, 0)
        && latitude != i32::MAX
        && away.xy().norm_squared() > TAKE_OFF_DISTANCE_MAX_M * TAKE_OFF_DISTANCE_MAX_M
    {
        return denied("Take-off: from here, not from another place");
    }
    Action::Request(Request::TakeOff(is_named.then_some(height)))
}

/// Flying to a place on the globe, given by COMMAND_INT; in a COMMAND_LONG it would be metres off. NaN leaves the
/// heading, and so does zero from where it points.
fn reposition(call: &Call, origin: &Origin, home: &Vector3<f32>) -> Action {
    let [_, flags, _, yaw, _, _, altitude] = call.parameters;
    let Some((latitude, longitude, frame)) = call.place else {
        return unsupported("Reposition: by COMMAND_INT only");
    };
    let base = origin.place(home).altitude;
    let Some(height) = above_home(frame, altitude, base) else {
        return unsupported("Reposition: in a global frame only");
    };
    let altitude = base + height;
    if !altitude.is_finite() || [latitude, longitude].contains(&i32::MAX) {
        return denied("Reposition: needs a place and an altitude");
    }
    let place = origin.local(&Place { latitude, longitude, altitude });
    // Of a yaw that counts from where the vehicle points only none is understood: no turn.
    let is_relative = flags as u32 & RELATIVE_YAW != 0;
    if is_relative && yaw.is_finite() && yaw != 0.0 {
        return unsupported("Reposition: yaw from north only");
    }
    let turn = if yaw.is_finite() && !is_relative {
        HeadingSetpoint::Angle { angle: frames::heading(yaw), rate: 0.0 }
    } else {
        HeadingSetpoint::Keep
    };
    Action::Request(Request::GoTo(Setpoint { motion: Motion::Position(frames::world(&place)), turn }))
}

const fn denied(words: &'static str) -> Action {
    Action::Refuse(MavResult::MAV_RESULT_DENIED, words)
}

const fn unsupported(words: &'static str) -> Action {
    Action::Refuse(MavResult::MAV_RESULT_UNSUPPORTED, words)
}

/// The number of a mission's item.
fn mission_item(number: f32) -> Option<u8> {
    (0..MISSION_CAPACITY as u8).find(|&item| number == f32::from(item))
}

/// Flying the mission from an item on, or from where it was left; always to its end.
fn mission_start(call: &Call) -> Action {
    let [first, last, ..] = call.parameters;
    if last != 0.0 && !last.is_nan() {
        return denied("Mission start: parameter 2 is 0, no last item");
    }
    if first.is_nan() || first < 0.0 {
        return Action::Request(Request::FlyMission(None));
    }
    match mission_item(first) {
        Some(item) => Action::Request(Request::FlyMission(Some(item))),
        None => denied("Mission start: parameter 1 is an item's number"),
    }
}

/// The test of one motor that a command requests. The flight rules refuse what is too much or too long; negative times
/// become zero, which is refused as well.
fn motor_test(call: &Call) -> Action {
    let [number, unit, throttle, seconds, count, ..] = call.parameters;
    let in_percent = unit == MotorTestThrottleType::MOTOR_TEST_THROTTLE_PERCENT as u32 as f32;
    let is_one = count == 0.0 || count == 1.0;
    match motor(number) {
        Some(rotor) if in_percent && is_one && throttle.is_finite() && seconds.is_finite() => {
            let (level, duration) = (throttle / 100.0, (seconds * 1e6) as u64);
            Action::Request(Request::MotorTest(MotorTest { rotor, level, duration }))
        }
        _ => denied("Motor test: one motor, 1 to 4, in percent"),
    }
}

/// What QGroundControl adds to the number that PX4 has for motor 1, 101, and to each after it; motors count from 1.
const QGROUNDCONTROLS_MOTORS: f32 = 1100.0;

/// The same by ACTUATOR_TEST. A client repeats it for as long as a person holds a slider: that goes on.
fn actuator_test(call: &Call) -> Action {
    let [level, seconds, _, _, function, ..] = call.parameters;
    let number = if function > QGROUNDCONTROLS_MOTORS { function - QGROUNDCONTROLS_MOTORS } else { function };
    match motor(number) {
        Some(_) if level.is_nan() || seconds == 0.0 => Action::Request(Request::EndMotorTest),
        Some(rotor) if seconds.is_finite() => {
            Action::Request(Request::MotorTest(MotorTest { rotor, level, duration: (seconds * 1e6) as u64 }))
        }
        _ => denied("Motor test: parameter 5 is motor 1 to 4"),
    }
}

/// A command's setting for one motor's controller. Modes in which a motor turns both ways are not for rotors.
fn configure_actuator(call: &Call) -> Action {
    let [configuration, _, _, _, function, ..] = call.parameters;
    let asked = |kind: ActuatorConfiguration| configuration == kind as u32 as f32;
    let setting = if asked(ActuatorConfiguration::ACTUATOR_CONFIGURATION_BEEP) {
        Setting::Beep
    } else if asked(ActuatorConfiguration::ACTUATOR_CONFIGURATION_SPIN_DIRECTION1) {
        Setting::Normal
    } else if asked(ActuatorConfiguration::ACTUATOR_CONFIGURATION_SPIN_DIRECTION2) {
        Setting::Reversed
    } else {
        return Action::Answer(MavResult::MAV_RESULT_UNSUPPORTED);
    };
    match motor(function) {
        Some(rotor) => Action::Request(Request::MotorSetting(MotorSetting { rotor, setting })),
        None => denied("Motor setting: parameter 5 is 1 to 4"),
    }
}

/// The index of a motor that is counted from 1.
fn motor(number: f32) -> Option<usize> {
    (0..MOTOR_COUNT).find(|&rotor| number == (rotor + 1) as f32)
}

/// A restart of the autopilot, and of nothing else.
fn restart(call: &Call) -> Action {
    let [autopilot, companion, component, ..] = call.parameters;
    match autopilot {
        _ if companion != 0.0 || component != 0.0 => unsupported("Restart: there is only the autopilot"),
        0.0 => Action::Answer(MavResult::MAV_RESULT_ACCEPTED),
        1.0 => Action::Restart,
        3.0 => Action::StartBootloader,
        _ => unsupported("Restart: parameter 1 is 1 or 3, nothing else"),
    }
}

/// One calibration at a time, of what there is. Magnetometer, barometer, radio and temperature are not.
fn calibration(call: &Call) -> Action {
    let [gyro, second, third, fourth, accelerometer, sixth, seventh] = call.parameters;
    if [second, third, fourth, sixth, seventh].iter().any(|other| *other != 0.0) {
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

/// The answer to clients with other numbers, such as ArduPilot's.
const NO_MODE: Action =
    Action::Refuse(MavResult::MAV_RESULT_DENIED, "Mode refused: PX4's 6 0, 4 2, 4 3, 4 4 or 4 6 only");

/// PX4's clients send the custom mode, and echo the heartbeat's flags. Without one, the HIL flag requests a simulator
/// and the guided flag for flight by setpoints.
fn set_mode(call: &Call, armed: bool) -> Action {
    let [base, main, sub, ..] = call.parameters;
    if !(0.0..=255.0).contains(&base) {
        return NO_MODE;
    }
    let base = MavModeFlag::from_bits_retain(base as u8);
    if base.contains(MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED) {
        return match (main, sub) {
            (MAIN_OFFBOARD, _) => Action::Request(Request::FlySetpoints),
            (MAIN_AUTO, AUTO_LOITER) => Action::Request(Request::Hold),
            (MAIN_AUTO, AUTO_MISSION) => Action::Request(Request::FlyMission(None)),
            (MAIN_AUTO, AUTO_TAKEOFF) => Action::Request(Request::TakeOff(None)),
            (MAIN_AUTO, AUTO_LAND) => Action::Request(Request::Land),
            (MAIN_AUTO, AUTO_EXTERNAL1) => Action::Request(Request::FlyPolicy),
            _ => NO_MODE,
        };
    }
    if base.contains(MavModeFlag::MAV_MODE_FLAG_HIL_ENABLED) {
        return if armed { denied("A simulator: disarmed only") } else { Action::EnterHil };
    }
    let guided = base.contains(MavModeFlag::MAV_MODE_FLAG_GUIDED_ENABLED);
    if guided { Action::Request(Request::FlySetpoints) } else { NO_MODE }
}
