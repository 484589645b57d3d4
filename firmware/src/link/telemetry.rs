//! Telemetry: reports, answers and events as MAVLink messages, in MAVLink's frames.

use super::reply::CommandResult;
use crate::frames;
use crate::parameters::table::{Name, PARAMETERS};
use crate::shared::{Event, Origin, Report, Severity, Traffic};
use controller_core::flight::{Mode, PERIOD, Stamped};
use mavlink::MessageData;
use mavlink::dialects::common::{
    ATTITUDE_QUATERNION_DATA, COMMAND_ACK_DATA, HEARTBEAT_DATA, LOCAL_POSITION_NED_DATA, MavAutopilot, MavModeFlag,
    MavParamType, MavSeverity, MavState, MavSysStatusSensor, MavType, PARAM_VALUE_DATA, STATUSTEXT_DATA,
    SYS_STATUS_DATA,
};
use mavlink::types::CharArray;

/// SYS_STATUS: voltage unknown.
const VOLTAGE_UNKNOWN: u16 = u16::MAX;

/// What the vehicle is and how it does; no mode without a fresh report. The custom mode counts the flight rules' modes
/// from 1.
#[must_use]
pub fn heartbeat(mode: Option<Mode>, hil: bool) -> HEARTBEAT_DATA {
    let mut base_mode = MavModeFlag::MAV_MODE_FLAG_STABILIZE_ENABLED
        | MavModeFlag::MAV_MODE_FLAG_GUIDED_ENABLED
        | MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED;
    base_mode.set(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED, mode.is_some_and(Mode::is_armed));
    base_mode.set(MavModeFlag::MAV_MODE_FLAG_HIL_ENABLED, hil);
    base_mode.set(MavModeFlag::MAV_MODE_FLAG_TEST_ENABLED, mode == Some(Mode::MotorTest));
    let (custom_mode, system_status) = match mode {
        None => (0, MavState::MAV_STATE_BOOT),
        Some(Mode::Disarmed) => (1, MavState::MAV_STATE_STANDBY),
        Some(Mode::MotorTest) => (2, MavState::MAV_STATE_STANDBY),
        Some(Mode::Flying) => (3, MavState::MAV_STATE_ACTIVE),
        Some(Mode::Holding) => (4, MavState::MAV_STATE_CRITICAL),
        Some(Mode::Levelling) => (5, MavState::MAV_STATE_EMERGENCY),
    };
    HEARTBEAT_DATA {
        custom_mode,
        mavtype: MavType::MAV_TYPE_QUADROTOR,
        autopilot: MavAutopilot::MAV_AUTOPILOT_GENERIC,
        base_mode,
        system_status,
        mavlink_version: 3,
    }
}

/// Milliseconds since boot, as far as 32 bits count them.
fn milliseconds(time: u64) -> u32 {
    (time / 1000) as u32
}

/// Attitude and body rates of a report.
#[must_use]
pub fn attitude(report: &Stamped<Report>) -> Option<ATTITUDE_QUATERNION_DATA> {
    let state = report.value.state?;
    let q = frames::attitude(&state.attitude);
    let rates = frames::body(&state.angular_velocity);
    Some(ATTITUDE_QUATERNION_DATA {
        time_boot_ms: milliseconds(report.time),
        q1: q.w,
        q2: q.i,
        q3: q.j,
        q4: q.k,
        rollspeed: rates.x,
        pitchspeed: rates.y,
        yawspeed: rates.z,
    })
}

/// Position and velocity of a report.
#[must_use]
pub fn position(report: &Stamped<Report>) -> Option<LOCAL_POSITION_NED_DATA> {
    let state = report.value.state?;
    let (p, v) = (frames::world(&state.position), frames::world(&state.velocity));
    let time_boot_ms = milliseconds(report.time);
    Some(LOCAL_POSITION_NED_DATA { time_boot_ms, x: p.x, y: p.y, z: p.z, vx: v.x, vy: v.y, vz: v.z })
}

/// Battery (V, if known), how much of its period the longest tick took, and what the line lost.
#[must_use]
pub fn status(voltage: Option<f32>, report: Option<&Report>, traffic: Traffic) -> SYS_STATUS_DATA {
    let none = MavSysStatusSensor::empty();
    let longest = report.map_or(0, |report| report.timing.worst_duration);
    SYS_STATUS_DATA {
        onboard_control_sensors_present: none,
        onboard_control_sensors_enabled: none,
        onboard_control_sensors_health: none,
        // Tenths of a percent.
        load: (u64::from(longest) * 1000 / PERIOD).min(1000) as u16,
        voltage_battery: voltage.map_or(VOLTAGE_UNKNOWN, |volts| (volts * 1000.0) as u16),
        current_battery: -1,
        drop_rate_comm: 0,
        errors_comm: traffic.refused.min(u32::from(u16::MAX)) as u16,
        errors_count1: 0,
        errors_count2: 0,
        errors_count3: 0,
        errors_count4: 0,
        battery_remaining: -1,
    }
}

/// An event in words.
#[must_use]
pub fn text(event: &Event) -> STATUSTEXT_DATA {
    let severity = match event.severity {
        Severity::Information => MavSeverity::MAV_SEVERITY_INFO,
        Severity::Warning => MavSeverity::MAV_SEVERITY_WARNING,
        Severity::Critical => MavSeverity::MAV_SEVERITY_CRITICAL,
    };
    STATUSTEXT_DATA { severity, text: event.text.as_str().into() }
}

/// A parameter's present value.
#[must_use]
pub fn parameter(name: Name, value: f32) -> PARAM_VALUE_DATA {
    PARAM_VALUE_DATA {
        param_value: value,
        param_count: PARAMETERS.len() as u16,
        param_index: name as u16,
        param_id: CharArray::from(name.row().name),
        param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
    }
}

/// The number of COMMAND_ACK, and of its checksum.
pub const ACKNOWLEDGEMENT: (u32, u8) = (COMMAND_ACK_DATA::ID, COMMAND_ACK_DATA::EXTRA_CRC);

/// The payload of a COMMAND_ACK, with the fields of version 2 that name the addressee. Written here because the dialect's
/// type can hold known commands only, and knows no addressee.
#[must_use]
pub fn acknowledgement(origin: &Origin, result: CommandResult) -> [u8; 10] {
    let [low, high] = origin.command.to_le_bytes();
    // Command, result, progress, the 4 bytes of a second result, addressee.
    [low, high, result as u8, 0, 0, 0, 0, 0, origin.system, origin.component]
}
