//! Telemetry: reports, answers and events as MAVLink messages, in MAVLink's frames.

use super::draft::Draft;
use super::message::{self, mode};
use super::reply::CommandResult;
use crate::frames;
use crate::parameters::table::{Name, PARAMETERS};
use crate::shared::{Event, Origin, Report, Severity, Traffic};
use crate::time::milliseconds;
use controller_core::flight::{Mode, PERIOD};
use controller_core::state::State;

/// MAV_TYPE_QUADROTOR.
const QUADROTOR: u8 = 2;
/// MAV_AUTOPILOT_GENERIC.
const GENERIC: u8 = 0;
/// The version of the protocol that HEARTBEAT names.
const PROTOCOL: u8 = 3;
/// SYS_STATUS: voltage, current or charge unknown.
const UNKNOWN: u16 = u16::MAX;

/// What the vehicle is and how it does; no mode without a fresh report. The custom mode counts the flight rules' modes
/// from 1.
pub fn heartbeat(draft: &mut Draft, mode: Option<Mode>, hil: bool) {
    let armed = if mode.is_some_and(Mode::is_armed) { mode::ARMED } else { 0 };
    let test = if mode == Some(Mode::MotorTest) { mode::TEST } else { 0 };
    let base = mode::STABILIZE | mode::GUIDED | mode::CUSTOM | armed | test | if hil { mode::HIL } else { 0 };
    // With MAV_STATE: boot, standby, active, critical, emergency.
    let (custom, state) = match mode {
        None => (0, 1),
        Some(Mode::Disarmed) => (1, 3),
        Some(Mode::MotorTest) => (2, 3),
        Some(Mode::Flying) => (3, 4),
        Some(Mode::Holding) => (4, 5),
        Some(Mode::Levelling) => (5, 6),
    };
    draft.begin(message::HEARTBEAT).bytes(&[custom, 0, 0, 0, QUADROTOR, GENERIC, base, state, PROTOCOL]);
}

/// Attitude and body rates at `time`, us.
pub fn attitude(draft: &mut Draft, time: u64, state: &State) {
    let q = frames::attitude(&state.attitude);
    let rates = frames::body(&state.angular_velocity);
    let fields = [q.w, q.i, q.j, q.k, rates.x, rates.y, rates.z];
    draft.begin(message::ATTITUDE_QUATERNION).bytes(&milliseconds(time).to_le_bytes()).floats(&fields);
}

/// Position and velocity at `time`, us.
pub fn position(draft: &mut Draft, time: u64, state: &State) {
    let (p, v) = (frames::world(&state.position), frames::world(&state.velocity));
    let fields = [p.x, p.y, p.z, v.x, v.y, v.z];
    draft.begin(message::LOCAL_POSITION_NED).bytes(&milliseconds(time).to_le_bytes()).floats(&fields);
}

/// Battery (V, if known), how much of its period the longest tick took, and what the line lost.
pub fn status(draft: &mut Draft, voltage: Option<f32>, report: Option<&Report>, traffic: Traffic) {
    let longest = report.map_or(0, |report| report.timing.worst_duration);
    // Tenths of a percent.
    let load = (longest / (PERIOD / 1000) as u32).min(1000) as u16;
    let voltage = voltage.map_or(UNKNOWN, |volts| (volts * 1000.0) as u16);
    let errors = traffic.refused.min(u32::from(u16::MAX)) as u16;
    // No sensors' health; load, voltage, current, losses that nobody counts, errors, four more counts; charge.
    let fields = [load, voltage, UNKNOWN, 0, errors, 0, 0, 0, 0];
    draft.begin(message::SYS_STATUS).bytes(&[0; 12]).shorts(&fields).bytes(&[UNKNOWN as u8]);
}

/// An event in words.
pub fn text(draft: &mut Draft, event: &Event) {
    let severity = match event.severity {
        Severity::Information => 6,
        Severity::Warning => 4,
        Severity::Critical => 2,
    };
    draft.begin(message::STATUSTEXT).bytes(&[severity]).bytes(event.text.as_str().as_bytes());
}

/// A parameter's present value.
pub fn parameter(draft: &mut Draft, name: Name, value: f32) {
    let place = [PARAMETERS.len() as u16, name as u16];
    draft
        .begin(message::PARAM_VALUE)
        .floats(&[value])
        .shorts(&place)
        .text(name.row().name, 16)
        .bytes(&[message::REAL32]);
}

/// What became of a command, with the fields of version 2 that name the addressee.
pub fn acknowledgement(draft: &mut Draft, origin: &Origin, result: CommandResult) {
    let [low, high] = origin.command.to_le_bytes();
    // Command, result, progress, the 4 bytes of a second result, addressee.
    let fields = [low, high, result as u8, 0, 0, 0, 0, 0, origin.system, origin.component];
    draft.begin(message::COMMAND_ACK).bytes(&fields);
}

/// A ping, back to whoever sent it.
pub fn ping(draft: &mut Draft, time: u64, sequence: u32, system: u8, component: u8) {
    let draft = draft.begin(message::PING).bytes(&time.to_le_bytes()).bytes(&sequence.to_le_bytes());
    draft.bytes(&[system, component]);
}
