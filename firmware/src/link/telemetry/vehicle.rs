//! What the vehicle is doing, in MAVLink's words: heartbeat, modes, sensors, battery, events, parameters.

use crate::configuration;
use crate::parameters::table::{Name, PARAMETERS};
use crate::shared::event::{Event, Severity, Text};
use crate::shared::report::{Report, Timing, Traffic};
use estimation::estimator::{COASTING_AFTER_US, Fault, Health};
use estimation::imu::ImuFault;
use flight::{Aboard, Mode};
use mavlink::dialects::common::{
    AVAILABLE_MODES_DATA, BATTERY_STATUS_DATA, CURRENT_MODE_DATA, EXTENDED_SYS_STATE_DATA, HEARTBEAT_DATA,
    MISSION_CURRENT_DATA, MavAutopilot, MavBatteryFunction, MavBatteryType, MavLandedState, MavModeFlag,
    MavModeProperty, MavParamType, MavSeverity, MavStandardMode, MavState, MavSysStatusSensor, MavType, MavVtolState,
    PARAM_VALUE_DATA, STATUSTEXT_DATA, SYS_STATUS_DATA,
};

/// The version of the protocol that HEARTBEAT names.
const PROTOCOL_VERSION: u8 = 3;

/// A mode, and whether a mission is flown in it, or a policy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeReport {
    /// The mode.
    pub mode: Mode,
    /// Whether a mission is flown.
    pub mission: bool,
    /// Whether a policy is let fly.
    pub policy: bool,
}

impl From<&Report> for ModeReport {
    fn from(report: &Report) -> Self {
        Self { mode: report.mode, mission: report.mission.is_flown, policy: report.flies_policy }
    }
}

/// The main and sub-modes of PX4's clients.
const MAIN_AUTO: u32 = 4 << 16;
const AUTO_READY: u32 = MAIN_AUTO | 1 << 24;
const AUTO_TAKEOFF: u32 = MAIN_AUTO | 2 << 24;
const AUTO_LOITER: u32 = MAIN_AUTO | 3 << 24;
const AUTO_MISSION: u32 = MAIN_AUTO | 4 << 24;
const AUTO_LAND: u32 = MAIN_AUTO | 6 << 24;
const AUTO_EXTERNAL1: u32 = MAIN_AUTO | 11 << 24;
const MAIN_OFFBOARD: u32 = 6 << 16;

/// PX4's number for the mode that comes nearest.
fn custom_mode(shown: &ModeReport) -> u32 {
    let ModeReport { mode, mission, policy } = *shown;
    match mode {
        Mode::Boot | Mode::Checks | Mode::Ready | Mode::MotorTest => AUTO_READY,
        Mode::Idling | Mode::Stopped | Mode::Locked => AUTO_READY,
        Mode::TakingOff => AUTO_TAKEOFF,
        Mode::Flying if policy => AUTO_EXTERNAL1,
        Mode::Flying if mission => AUTO_MISSION,
        Mode::Flying => MAIN_OFFBOARD,
        Mode::Holding => AUTO_LOITER,
        Mode::Landing | Mode::Descending => AUTO_LAND,
    }
}

/// The modes that may be requested, with their names and MAVLink's standard ones.
const SELECTABLE_MODES: [(u32, &str, MavStandardMode); 6] = [
    (MAIN_OFFBOARD, "Setpoints", MavStandardMode::MAV_STANDARD_MODE_NON_STANDARD),
    (AUTO_LOITER, "Hold", MavStandardMode::MAV_STANDARD_MODE_POSITION_HOLD),
    (AUTO_MISSION, "Mission", MavStandardMode::MAV_STANDARD_MODE_MISSION),
    (AUTO_TAKEOFF, "Take-off", MavStandardMode::MAV_STANDARD_MODE_TAKEOFF),
    (AUTO_LAND, "Land", MavStandardMode::MAV_STANDARD_MODE_LAND),
    (AUTO_EXTERNAL1, "Policy", MavStandardMode::MAV_STANDARD_MODE_NON_STANDARD),
];

/// How many modes there are to be named: the last one only where a policy is built in.
pub const MODE_COUNT: u8 = SELECTABLE_MODES.len() as u8 - !configuration::Policy::EXISTS as u8;

/// The mode of this number, from 1 on, with its name.
pub fn available_mode(index: u8) -> Option<AVAILABLE_MODES_DATA> {
    let index = Some(index).filter(|index| *index <= MODE_COUNT)?;
    let &(custom_mode, name, standard_mode) = SELECTABLE_MODES.get(usize::from(index).checked_sub(1)?)?;
    Some(AVAILABLE_MODES_DATA {
        custom_mode,
        properties: MavModeProperty::empty(),
        number_modes: MODE_COUNT,
        mode_index: index,
        standard_mode,
        mode_name: name.into(),
    })
}

/// The mode that is flown.
pub fn current_mode(shown: &ModeReport) -> CURRENT_MODE_DATA {
    let custom_mode = custom_mode(shown);
    let standard = SELECTABLE_MODES.iter().find(|(custom, ..)| *custom == custom_mode);
    let standard_mode = standard.map_or(MavStandardMode::MAV_STANDARD_MODE_NON_STANDARD, |(.., standard)| *standard);
    CURRENT_MODE_DATA { custom_mode, intended_custom_mode: 0, standard_mode }
}

/// The mission's item that is flown, or will be.
pub fn mission_current(report: &Report) -> MISSION_CURRENT_DATA {
    MISSION_CURRENT_DATA { seq: report.mission.next.into() }
}

/// Whether it is on the ground; unknown of a vehicle that was stopped in the air or may still fall, and before there is
/// an estimate.
pub fn extended_state(report: &Report) -> EXTENDED_SYS_STATE_DATA {
    let landed_state = match report.mode {
        Mode::Boot | Mode::Stopped => MavLandedState::MAV_LANDED_STATE_UNDEFINED,
        _ if report.may_fall => MavLandedState::MAV_LANDED_STATE_UNDEFINED,
        _ if !report.is_airborne => MavLandedState::MAV_LANDED_STATE_ON_GROUND,
        Mode::TakingOff => MavLandedState::MAV_LANDED_STATE_TAKEOFF,
        Mode::Landing | Mode::Descending => MavLandedState::MAV_LANDED_STATE_LANDING,
        _ => MavLandedState::MAV_LANDED_STATE_IN_AIR,
    };
    EXTENDED_SYS_STATE_DATA { vtol_state: MavVtolState::MAV_VTOL_STATE_UNDEFINED, landed_state }
}

/// The vehicle's type and state; no mode without a fresh report.
pub fn heartbeat(shown: Option<ModeReport>, hil: bool) -> HEARTBEAT_DATA {
    let mode = shown.map(|shown| shown.mode);
    let system_status = match mode {
        None | Some(Mode::Boot) => MavState::MAV_STATE_BOOT,
        Some(Mode::Checks) => MavState::MAV_STATE_CALIBRATING,
        Some(Mode::Ready | Mode::MotorTest) => MavState::MAV_STATE_STANDBY,
        Some(Mode::Idling | Mode::TakingOff | Mode::Flying | Mode::Holding | Mode::Landing) => {
            MavState::MAV_STATE_ACTIVE
        }
        Some(Mode::Descending | Mode::Stopped | Mode::Locked) => MavState::MAV_STATE_EMERGENCY,
    };
    let mut base_mode = MavModeFlag::MAV_MODE_FLAG_STABILIZE_ENABLED
        | MavModeFlag::MAV_MODE_FLAG_GUIDED_ENABLED
        | MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED;
    base_mode.set(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED, mode.is_some_and(Mode::is_armed));
    base_mode.set(MavModeFlag::MAV_MODE_FLAG_TEST_ENABLED, mode == Some(Mode::MotorTest));
    base_mode.set(MavModeFlag::MAV_MODE_FLAG_HIL_ENABLED, hil);
    HEARTBEAT_DATA {
        custom_mode: shown.as_ref().map_or(0, custom_mode),
        mavtype: MavType::MAV_TYPE_QUADROTOR,
        autopilot: MavAutopilot::MAV_AUTOPILOT_GENERIC,
        base_mode,
        system_status,
        mavlink_version: PROTOCOL_VERSION,
    }
}

/// Which sensors there are, whether they work, the battery (V, if known), how much of its period the longest tick took,
/// what the line lost, and whether flights are logged, if there is a card.
///
/// Clients know sensors that this vehicle has not, and wait for them. What a magnetometer is there for, a heading, and
/// what GPS is there for, a place, comes from the poses here; so both bits show, like that of a vision system, whether
/// poses are believed.
pub fn status(
    voltage: Option<f32>,
    report: Option<&Report>,
    traffic: Traffic,
    is_logged: Option<bool>,
) -> SYS_STATUS_DATA {
    use MavSysStatusSensor as Sensor;
    let Timing { worst_duration, period, .. } = report.map(|report| report.timing).unwrap_or_default();
    let inertial = Sensor::MAV_SYS_STATUS_SENSOR_3D_GYRO | Sensor::MAV_SYS_STATUS_SENSOR_3D_ACCEL;
    let poses = Sensor::MAV_SYS_STATUS_SENSOR_VISION_POSITION
        | Sensor::MAV_SYS_STATUS_SENSOR_3D_MAG
        | Sensor::MAV_SYS_STATUS_SENSOR_GPS;
    let control = Sensor::MAV_SYS_STATUS_SENSOR_ANGULAR_RATE_CONTROL
        | Sensor::MAV_SYS_STATUS_SENSOR_ATTITUDE_STABILIZATION
        | Sensor::MAV_SYS_STATUS_SENSOR_YAW_POSITION
        | Sensor::MAV_SYS_STATUS_SENSOR_Z_ALTITUDE_CONTROL
        | Sensor::MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL
        | Sensor::MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS;
    // By the IMU alone the vehicle is held level and sinks; its drift and heading are unknown.
    let without_pose = Sensor::MAV_SYS_STATUS_SENSOR_YAW_POSITION
        | Sensor::MAV_SYS_STATUS_SENSOR_Z_ALTITUDE_CONTROL
        | Sensor::MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL;
    let mut present = inertial | poses | control | Sensor::MAV_SYS_STATUS_AHRS | Sensor::MAV_SYS_STATUS_PREARM_CHECK;
    present.set(Sensor::MAV_SYS_STATUS_SENSOR_BATTERY, voltage.is_some());
    present.set(Sensor::MAV_SYS_STATUS_LOGGING, is_logged.is_some());
    let mut health = Sensor::empty();
    health.set(Sensor::MAV_SYS_STATUS_LOGGING, is_logged == Some(true));
    health.set(Sensor::MAV_SYS_STATUS_SENSOR_BATTERY, voltage.is_some());
    if let Some(report) = report {
        let Health { faults, pose_age, .. } = report.health;
        let has = |fault: Fault| faults.contain(fault);
        let [gyro, accelerometer] = [ImuFault::is_of_the_gyro, ImuFault::is_of_the_accelerometer]
            .map(|is_of| !has(Fault::ImuStale) && !report.imu_fault.is_some_and(is_of));
        health.set(Sensor::MAV_SYS_STATUS_SENSOR_3D_GYRO, gyro && !has(Fault::GyroBias));
        health.set(Sensor::MAV_SYS_STATUS_SENSOR_3D_ACCEL, accelerometer && !has(Fault::AccelerometerBias));
        health.set(poses, pose_age.is_some_and(|age| age <= COASTING_AFTER_US) && !has(Fault::Inconsistent));
        health.set(Sensor::MAV_SYS_STATUS_AHRS, report.state.is_some() && !has(Fault::Uncertain));
        health.set(control, report.mode != Mode::Locked);
        health.set(Sensor::MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS, report.mode != Mode::Locked && !report.motors_fail);
        if report.mode == Mode::Descending {
            health.remove(without_pose);
        }
        health.set(Sensor::MAV_SYS_STATUS_PREARM_CHECK, report.ready || report.mode.is_armed());
    }
    SYS_STATUS_DATA {
        onboard_control_sensors_present: present,
        onboard_control_sensors_enabled: present,
        onboard_control_sensors_health: health,
        // Tenths of a percent.
        load: (1000 * u64::from(worst_duration)).checked_div(period).unwrap_or(0).min(1000) as u16,
        voltage_battery: voltage.map_or(u16::MAX, |volts| (volts * 1000.0) as u16),
        current_battery: -1,
        battery_remaining: -1,
        errors_comm: traffic.refused.try_into().unwrap_or(u16::MAX),
        ..SYS_STATUS_DATA::DEFAULT
    }
}

/// The battery's voltage; nothing else of it is measured.
pub fn battery(voltage: Option<f32>) -> BATTERY_STATUS_DATA {
    let mut voltages = [u16::MAX; 10];
    if let (Some(first), Some(volts)) = (voltages.first_mut(), voltage) {
        *first = (volts * 1000.0) as u16;
    }
    BATTERY_STATUS_DATA {
        current_consumed: -1,
        energy_consumed: -1,
        temperature: i16::MAX,
        voltages,
        current_battery: -1,
        id: 0,
        battery_function: MavBatteryFunction::MAV_BATTERY_FUNCTION_ALL,
        mavtype: MavBatteryType::MAV_BATTERY_TYPE_UNKNOWN,
        battery_remaining: -1,
    }
}

/// An event in words.
pub fn text(event: &Event) -> STATUSTEXT_DATA {
    let severity = match event.severity() {
        Severity::Information => MavSeverity::MAV_SEVERITY_INFO,
        Severity::Warning => MavSeverity::MAV_SEVERITY_WARNING,
        Severity::Critical => MavSeverity::MAV_SEVERITY_CRITICAL,
    };
    STATUSTEXT_DATA { severity, text: Text::new(event).as_str().into() }
}

/// A parameter's present value.
pub fn parameter(name: Name, value: f32) -> PARAM_VALUE_DATA {
    PARAM_VALUE_DATA {
        param_value: value,
        param_count: PARAMETERS.len() as u16,
        param_index: name as u16,
        param_id: name.row().name.into(),
        param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
    }
}
