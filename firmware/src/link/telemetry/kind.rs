//! The messages that are sent by the clock or on request: one entry each.

#![expect(deprecated, reason = "PROTOCOL_VERSION: clients still ask for it")]

use super::{View, bench, controllers, identity, motion, vehicle};
use crate::link::time_sync;
use crate::link::writer::Writer;
use mavlink::MessageData;
use mavlink::dialects::common::{
    ATTITUDE_DATA, ATTITUDE_QUATERNION_DATA, AUTOPILOT_VERSION_DATA, BATTERY_STATUS_DATA, CURRENT_MODE_DATA,
    ESC_INFO_DATA, ESC_STATUS_DATA, ESTIMATOR_STATUS_DATA, EXTENDED_SYS_STATE_DATA, GLOBAL_POSITION_INT_DATA,
    GPS_GLOBAL_ORIGIN_DATA, HEARTBEAT_DATA, HIGHRES_IMU_DATA, HOME_POSITION_DATA, LOCAL_POSITION_NED_DATA,
    MISSION_CURRENT_DATA, NAMED_VALUE_FLOAT_DATA, ODOMETRY_DATA, POSITION_TARGET_LOCAL_NED_DATA, PROTOCOL_VERSION_DATA,
    SYS_STATUS_DATA, SYSTEM_TIME_DATA, TIMESYNC_DATA, VIBRATION_DATA,
};

/// A message's default rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rate {
    /// Only on request.
    OnRequest,
    /// Every so many us.
    Every(u64),
    /// Every so many us as long as there is no estimate, and with it nothing of where the vehicle is; later on request.
    Bench(u64),
    /// At [`crate::parameters::table::Name::TelemetryRate`].
    Telemetry,
}

/// The bytes that every frame has around its message.
const FRAME_OVERHEAD_BYTES: usize = 12;

/// An entry: the message's name here and MAVLink's type of it, its default rate, and its content for a [`View`]; none
/// where there is no value to send.
macro_rules! messages {
    ($view:ident: $($kind:ident: $data:ty, $rate:expr => $content:expr;)*) => {
        /// A message that is sent by the clock or on request.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Kind {
            $(#[doc = stringify!($data)] $kind,)*
        }

        /// The messages and their default rates, those first that matter most.
        pub const STREAMS: [(Kind, Rate); [$(Kind::$kind),*].len()] = [$((Kind::$kind, $rate)),*];

        impl Kind {
            /// The message's number, and its maximum length.
            const fn facts(self) -> (u32, usize) {
                match self {
                    $(Self::$kind => (<$data>::ID, <$data>::ENCODED_LEN),)*
                }
            }
        }

        impl View {
            /// Writes the message as `system`'s; whether there was a value to send.
            pub fn write(&self, kind: Kind, system: u8, writer: &mut Writer) -> bool {
                let $view = self;
                match kind {
                    $(Kind::$kind => {
                        let content = || -> Option<$data> { $content };
                        writer.write_some(system, content())
                    })*
                }
            }
        }
    };
}

// At the default rates they take 4 KB/s of a line's 5.7 KB/s at 57,600 baud.
messages! { view:
    Heartbeat: HEARTBEAT_DATA, Rate::Every(1_000_000) =>
        Some(vehicle::heartbeat(view.report().map(Into::into), view.simulated));
    AttitudeQuaternion: ATTITUDE_QUATERNION_DATA, Rate::Telemetry =>
        motion::attitude_quaternion(view.time()?, view.report()?);
    Position: LOCAL_POSITION_NED_DATA, Rate::Telemetry => motion::position(view.time()?, view.report()?);
    Attitude: ATTITUDE_DATA, Rate::Every(100_000) => motion::attitude(view.time()?, view.report()?);
    TimeSync: TIMESYNC_DATA, Rate::Every(1_000_000) => Some(time_sync::question(view.now));
    SystemStatus: SYS_STATUS_DATA, Rate::Every(1_000_000) =>
        Some(vehicle::status(view.voltage, view.report(), view.traffic, view.is_logged));
    ExtendedState: EXTENDED_SYS_STATE_DATA, Rate::Every(500_000) => Some(vehicle::extended_state(view.report()?));
    GlobalPosition: GLOBAL_POSITION_INT_DATA, Rate::Every(200_000) =>
        motion::global_position(view.time()?, view.report()?, &view.origin);
    PositionTarget: POSITION_TARGET_LOCAL_NED_DATA, Rate::Every(200_000) =>
        motion::position_target(view.time()?, view.report()?);
    Odometry: ODOMETRY_DATA, Rate::Every(500_000) => motion::odometry(view.time()?, view.report()?);
    EstimatorStatus: ESTIMATOR_STATUS_DATA, Rate::Every(1_000_000) =>
        Some(motion::estimator_status(view.time()?, view.report()?));
    BatteryStatus: BATTERY_STATUS_DATA, Rate::Every(2_000_000) => Some(vehicle::battery(view.voltage));
    CurrentMode: CURRENT_MODE_DATA, Rate::Every(1_000_000) => Some(vehicle::current_mode(&view.report()?.into()));
    MissionCurrent: MISSION_CURRENT_DATA, Rate::Every(1_000_000) => Some(vehicle::mission_current(view.report()?));
    HomePosition: HOME_POSITION_DATA, Rate::Every(2_000_000) => motion::home(view.report()?, &view.origin);
    EscStatus: ESC_STATUS_DATA, Rate::Every(200_000) =>
        Some(controllers::status(view.rotor_speeds?, view.controllers.as_ref()));
    EscInfo: ESC_INFO_DATA, Rate::Every(1_000_000) =>
        Some(controllers::info(view.rotor_speeds?, view.controllers.as_ref()?));
    Imu: HIGHRES_IMU_DATA, Rate::Bench(200_000) => bench::imu(view);
    Vibration: VIBRATION_DATA, Rate::Bench(1_000_000) => bench::vibration(view);
    NamedValue: NAMED_VALUE_FLOAT_DATA, Rate::Bench(250_000) => bench::named(view);
    SystemTime: SYSTEM_TIME_DATA, Rate::Every(2_000_000) => Some(motion::system_time(view.now));
    GlobalOrigin: GPS_GLOBAL_ORIGIN_DATA, Rate::OnRequest => Some(motion::origin(&view.origin));
    AutopilotVersion: AUTOPILOT_VERSION_DATA, Rate::OnRequest => Some(identity::autopilot_version());
    ProtocolVersion: PROTOCOL_VERSION_DATA, Rate::OnRequest => Some(identity::protocol_version());
}

impl Kind {
    /// The message of this number, if it can be sent.
    pub fn from_number(number: u32) -> Option<Self> {
        STREAMS.iter().map(|(kind, _)| *kind).find(|kind| kind.number() == number)
    }

    /// The message's number.
    pub fn number(self) -> u32 {
        self.facts().0
    }

    /// The length of its longest frame, bytes.
    pub fn bytes_max(self) -> usize {
        self.facts().1 + FRAME_OVERHEAD_BYTES
    }
}
