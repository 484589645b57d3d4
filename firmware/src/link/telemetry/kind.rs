//! The messages that are sent by the clock or on request: which there are, their numbers, and how long they are.

use super::identity;
use mavlink::MessageData;
use mavlink::dialects::common::{
    ATTITUDE_DATA, ATTITUDE_QUATERNION_DATA, AUTOPILOT_VERSION_DATA, BATTERY_STATUS_DATA, CURRENT_MODE_DATA,
    ESTIMATOR_STATUS_DATA, EXTENDED_SYS_STATE_DATA, GLOBAL_POSITION_INT_DATA, GPS_GLOBAL_ORIGIN_DATA, HEARTBEAT_DATA,
    HOME_POSITION_DATA, LOCAL_POSITION_NED_DATA, MISSION_CURRENT_DATA, ODOMETRY_DATA, POSITION_TARGET_LOCAL_NED_DATA,
    SYS_STATUS_DATA, SYSTEM_TIME_DATA, TIMESYNC_DATA,
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
    /// MISSION_CURRENT.
    MissionCurrent,
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

/// What every frame has around its message.
const FRAME_OVERHEAD_BYTES: usize = 12;

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
            Self::MissionCurrent => of::<MISSION_CURRENT_DATA>(),
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
        self.facts().1 + FRAME_OVERHEAD_BYTES
    }
}
