//! Telemetry: what the vehicle knows, as MAVLink messages in MAVLink's frames.
//!
//! - [`vehicle`]: what it is doing: heartbeat, modes, sensors, battery, events, parameters;
//! - [`motion`]: how it moves: attitude, position, odometry, target, home;
//! - [`identity`]: what it is.

pub mod identity;
pub mod motion;
pub mod vehicle;

use super::origin::Origin;
use super::time_sync;
use super::writer::Writer;
use crate::shared::{Report, Traffic};
use controller_core::flight::Stamped;
use mavlink::MessageData;
use mavlink::dialects::common::{
    ATTITUDE_DATA, ATTITUDE_QUATERNION_DATA, AUTOPILOT_VERSION_DATA, BATTERY_STATUS_DATA, CURRENT_MODE_DATA,
    ESTIMATOR_STATUS_DATA, EXTENDED_SYS_STATE_DATA, GLOBAL_POSITION_INT_DATA, GPS_GLOBAL_ORIGIN_DATA, HEARTBEAT_DATA,
    HOME_POSITION_DATA, LOCAL_POSITION_NED_DATA, ODOMETRY_DATA, POSITION_TARGET_LOCAL_NED_DATA, SYS_STATUS_DATA,
    SYSTEM_TIME_DATA, TIMESYNC_DATA,
};

/// A message that is sent by the clock or on request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// HEARTBEAT.
    Heartbeat,
    /// SYS_STATUS.
    SystemStatus,
    /// EXTENDED_SYS_STATE.
    ExtendedState,
    /// BATTERY_STATUS.
    BatteryStatus,
    /// CURRENT_MODE.
    CurrentMode,
    /// ATTITUDE.
    Attitude,
    /// ATTITUDE_QUATERNION.
    AttitudeQuaternion,
    /// LOCAL_POSITION_NED.
    Position,
    /// GLOBAL_POSITION_INT.
    GlobalPosition,
    /// ODOMETRY.
    Odometry,
    /// POSITION_TARGET_LOCAL_NED.
    PositionTarget,
    /// ESTIMATOR_STATUS.
    EstimatorStatus,
    /// HOME_POSITION.
    HomePosition,
    /// GPS_GLOBAL_ORIGIN.
    GlobalOrigin,
    /// SYSTEM_TIME.
    SystemTime,
    /// TIMESYNC, a question.
    TimeSync,
    /// AUTOPILOT_VERSION.
    AutopilotVersion,
    /// PROTOCOL_VERSION.
    ProtocolVersion,
}

/// What is known when a message is written.
#[derive(Debug, Clone)]
pub struct View {
    /// The vehicle's clock, us.
    pub now: u64,
    /// What control did last, if that is not long ago.
    pub report: Option<Stamped<Report>>,
    /// V, if it is known.
    pub voltage: Option<f32>,
    /// What the line carried.
    pub traffic: Traffic,
    /// Whether a simulator has sensors and motors.
    pub simulated: bool,
    /// Where the local frame is on the globe.
    pub origin: Origin,
}

/// What every frame has around its message, bytes.
const FRAME: usize = 12;

impl Kind {
    /// The message's number, and how long it can be.
    const fn facts(self) -> (u32, usize) {
        const fn of<D: MessageData>() -> (u32, usize) {
            (D::ID, D::ENCODED_LEN)
        }
        match self {
            Self::Heartbeat => of::<HEARTBEAT_DATA>(),
            Self::SystemStatus => of::<SYS_STATUS_DATA>(),
            Self::ExtendedState => of::<EXTENDED_SYS_STATE_DATA>(),
            Self::BatteryStatus => of::<BATTERY_STATUS_DATA>(),
            Self::CurrentMode => of::<CURRENT_MODE_DATA>(),
            Self::Attitude => of::<ATTITUDE_DATA>(),
            Self::AttitudeQuaternion => of::<ATTITUDE_QUATERNION_DATA>(),
            Self::Position => of::<LOCAL_POSITION_NED_DATA>(),
            Self::GlobalPosition => of::<GLOBAL_POSITION_INT_DATA>(),
            Self::Odometry => of::<ODOMETRY_DATA>(),
            Self::PositionTarget => of::<POSITION_TARGET_LOCAL_NED_DATA>(),
            Self::EstimatorStatus => of::<ESTIMATOR_STATUS_DATA>(),
            Self::HomePosition => of::<HOME_POSITION_DATA>(),
            Self::GlobalOrigin => of::<GPS_GLOBAL_ORIGIN_DATA>(),
            Self::SystemTime => of::<SYSTEM_TIME_DATA>(),
            Self::TimeSync => of::<TIMESYNC_DATA>(),
            Self::AutopilotVersion => of::<AUTOPILOT_VERSION_DATA>(),
            Self::ProtocolVersion => of::<identity::ProtocolVersion>(),
        }
    }

    /// The message's number.
    #[must_use]
    pub fn number(self) -> u32 {
        self.facts().0
    }

    /// The longest frame it makes, bytes.
    #[must_use]
    pub fn bytes_at_most(self) -> usize {
        self.facts().1 + FRAME
    }

    /// Writes the message as `system`'s; whether there was anything to say.
    pub fn write(self, view: &View, system: u8, writer: &mut Writer) -> bool {
        let Some(report) = &view.report else { return self.write_without_report(view, system, writer) };
        let (time, report) = (report.time, &report.value);
        match self {
            Self::Attitude => writer.write_some(system, motion::attitude(time, report)),
            Self::AttitudeQuaternion => writer.write_some(system, motion::attitude_quaternion(time, report)),
            Self::Position => writer.write_some(system, motion::position(time, report)),
            Self::GlobalPosition => writer.write_some(system, motion::global_position(time, report, &view.origin)),
            Self::Odometry => writer.write_some(system, motion::odometry(time, report)),
            Self::PositionTarget => writer.write_some(system, motion::position_target(time, report)),
            Self::HomePosition => writer.write_some(system, motion::home(report, &view.origin)),
            Self::EstimatorStatus => writer.write_some(system, Some(motion::estimator_status(time, report))),
            Self::ExtendedState => writer.write_some(system, Some(vehicle::extended_state(report))),
            Self::CurrentMode => writer.write_some(system, Some(vehicle::current_mode(report.mode))),
            _ => self.write_without_report(view, system, writer),
        }
    }

    /// What can be said whatever control does.
    fn write_without_report(self, view: &View, system: u8, writer: &mut Writer) -> bool {
        let report = view.report.as_ref().map(|report| &report.value);
        match self {
            Self::Heartbeat => {
                writer.write(system, &vehicle::heartbeat(report.map(|report| report.mode), view.simulated));
            }
            Self::SystemStatus => writer.write(system, &vehicle::status(view.voltage, report, view.traffic)),
            Self::BatteryStatus => writer.write(system, &vehicle::battery(view.voltage)),
            Self::SystemTime => writer.write(system, &motion::system_time(view.now)),
            Self::TimeSync => writer.write(system, &time_sync::question(view.now)),
            Self::GlobalOrigin => writer.write(system, &motion::origin(&view.origin)),
            Self::AutopilotVersion => writer.write(system, &identity::autopilot_version()),
            Self::ProtocolVersion => writer.write(system, &identity::protocol_version()),
            _ => return false,
        }
        true
    }
}
