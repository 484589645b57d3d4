//! Telemetry: reports, answers and events as MAVLink messages, in MAVLink's frames.

use crate::frames;
use crate::parameters::table::{Name, PARAMETERS};
use crate::shared::{Event, Report, Severity, Text, Traffic};
use controller_core::flight::{Mode, PERIOD};
use controller_core::state::State;
use mavlink::dialects::common::{
    ATTITUDE_QUATERNION_DATA, HEARTBEAT_DATA, LOCAL_POSITION_NED_DATA, MavAutopilot, MavModeFlag, MavParamType,
    MavSeverity, MavState, MavSysStatusSensor, MavType, PARAM_VALUE_DATA, STATUSTEXT_DATA, SYS_STATUS_DATA,
};

/// The version of the protocol that HEARTBEAT names.
const PROTOCOL: u8 = 3;

/// Main and sub-modes by which PX4's clients know what a vehicle does.
const AUTO: u32 = 4 << 16;
const AUTO_READY: u32 = AUTO | 1 << 24;
const AUTO_TAKEOFF: u32 = AUTO | 2 << 24;
const AUTO_LOITER: u32 = AUTO | 3 << 24;
const AUTO_LAND: u32 = AUTO | 6 << 24;
const OFFBOARD: u32 = 6 << 16;

/// What the vehicle is and how it does; no mode without a fresh report. The custom mode is PX4's for what comes nearest.
#[must_use]
pub fn heartbeat(mode: Option<Mode>, hil: bool) -> HEARTBEAT_DATA {
    let (custom_mode, system_status) = match mode {
        None => (0, MavState::MAV_STATE_BOOT),
        Some(Mode::Boot) => (AUTO_READY, MavState::MAV_STATE_BOOT),
        Some(Mode::Checks) => (AUTO_READY, MavState::MAV_STATE_CALIBRATING),
        Some(Mode::Ready | Mode::MotorTest) => (AUTO_READY, MavState::MAV_STATE_STANDBY),
        Some(Mode::Idling) => (AUTO_READY, MavState::MAV_STATE_ACTIVE),
        Some(Mode::TakingOff) => (AUTO_TAKEOFF, MavState::MAV_STATE_ACTIVE),
        Some(Mode::Flying) => (OFFBOARD, MavState::MAV_STATE_ACTIVE),
        Some(Mode::Holding) => (AUTO_LOITER, MavState::MAV_STATE_ACTIVE),
        Some(Mode::Landing) => (AUTO_LAND, MavState::MAV_STATE_ACTIVE),
        Some(Mode::Descending) => (AUTO_LAND, MavState::MAV_STATE_EMERGENCY),
        Some(Mode::Stopped | Mode::Locked) => (AUTO_READY, MavState::MAV_STATE_EMERGENCY),
    };
    let mut base_mode = MavModeFlag::MAV_MODE_FLAG_STABILIZE_ENABLED
        | MavModeFlag::MAV_MODE_FLAG_GUIDED_ENABLED
        | MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED;
    base_mode.set(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED, mode.is_some_and(Mode::is_armed));
    base_mode.set(MavModeFlag::MAV_MODE_FLAG_TEST_ENABLED, mode == Some(Mode::MotorTest));
    base_mode.set(MavModeFlag::MAV_MODE_FLAG_HIL_ENABLED, hil);
    HEARTBEAT_DATA {
        custom_mode,
        mavtype: MavType::MAV_TYPE_QUADROTOR,
        autopilot: MavAutopilot::MAV_AUTOPILOT_GENERIC,
        base_mode,
        system_status,
        mavlink_version: PROTOCOL,
    }
}

/// Attitude and body rates at `time`, us.
#[must_use]
pub fn attitude(time: u64, state: &State) -> ATTITUDE_QUATERNION_DATA {
    let q = frames::attitude(&state.attitude);
    let rates = frames::body(&state.angular_velocity);
    ATTITUDE_QUATERNION_DATA {
        time_boot_ms: milliseconds(time),
        q1: q.w,
        q2: q.i,
        q3: q.j,
        q4: q.k,
        rollspeed: rates.x,
        pitchspeed: rates.y,
        yawspeed: rates.z,
    }
}

/// Position and velocity at `time`, us.
#[must_use]
pub fn position(time: u64, state: &State) -> LOCAL_POSITION_NED_DATA {
    let (p, v) = (frames::world(&state.position), frames::world(&state.velocity));
    LOCAL_POSITION_NED_DATA { time_boot_ms: milliseconds(time), x: p.x, y: p.y, z: p.z, vx: v.x, vy: v.y, vz: v.z }
}

/// A time stamp's milliseconds, which start again after 2^32.
fn milliseconds(time: u64) -> u32 {
    (time / 1000) as u32
}

/// Battery (V, if known), how much of its period the longest tick took, and what the line lost. Nothing is said of sensors.
#[must_use]
pub fn status(voltage: Option<f32>, report: Option<&Report>, traffic: Traffic) -> SYS_STATUS_DATA {
    let longest = report.map_or(0, |report| u64::from(report.timing.worst_duration));
    SYS_STATUS_DATA {
        // The crate's default is the first of them.
        onboard_control_sensors_present: MavSysStatusSensor::empty(),
        onboard_control_sensors_enabled: MavSysStatusSensor::empty(),
        onboard_control_sensors_health: MavSysStatusSensor::empty(),
        // Tenths of a percent.
        load: (1000 * longest / PERIOD).min(1000) as u16,
        voltage_battery: voltage.map_or(u16::MAX, |volts| (volts * 1000.0) as u16),
        current_battery: -1,
        battery_remaining: -1,
        errors_comm: traffic.refused.try_into().unwrap_or(u16::MAX),
        ..SYS_STATUS_DATA::DEFAULT
    }
}

/// An event in words.
#[must_use]
pub fn text(event: &Event) -> STATUSTEXT_DATA {
    let severity = match event.severity() {
        Severity::Information => MavSeverity::MAV_SEVERITY_INFO,
        Severity::Warning => MavSeverity::MAV_SEVERITY_WARNING,
        Severity::Critical => MavSeverity::MAV_SEVERITY_CRITICAL,
    };
    STATUSTEXT_DATA { severity, text: Text::new(event).as_str().into() }
}

/// A parameter's present value.
#[must_use]
pub fn parameter(name: Name, value: f32) -> PARAM_VALUE_DATA {
    PARAM_VALUE_DATA {
        param_value: value,
        param_count: PARAMETERS.len() as u16,
        param_index: name as u16,
        param_id: name.row().name.into(),
        param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
    }
}
