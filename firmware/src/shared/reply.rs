//! What the vehicle answers, and to what.

use crate::link::acknowledgement::{Acknowledgement, Order};
use crate::link::files::FileRequest;
use crate::link::telemetry::kind::Kind;
use crate::parameters::table::Name;
use mavlink::dialects::common::MavMissionResult;

/// PING: superseded by TIMESYNC, but clients still send it and wait for the answer.
#[expect(deprecated, reason = "see above")]
pub type Ping = mavlink::dialects::common::PING_DATA;

/// A calibration to be begun, or the end of the one under way; and the command that requested it, to be answered.
pub type Calibration = (Option<Procedure>, Order);

/// What is to be calibrated of the inertial sensors: see [`crate::imu`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Procedure {
    /// The gyro's bias, at standstill.
    Gyro,
    /// The accelerometer's offsets and scales, each side down for a second.
    SixSides,
    /// How level it sits, in the level vehicle.
    Level,
    /// The accelerometer's offsets, in the level vehicle.
    OneSide,
}

/// A list of mission items that a client requested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MissionList {
    /// The client: system and component.
    pub sender: (u8, u8),
    /// Which: MAV_MISSION_TYPE, whether the dialect has that one or not.
    pub list: u8,
}

/// One message to send.
#[derive(Debug, Clone, PartialEq)]
pub enum Reply {
    /// COMMAND_ACK.
    Command(Acknowledgement),
    /// COMMAND_ACK, as of a command that is the same: of the same frame, or an equal one that another sender sent at
    /// once. What became of that may be still to come.
    Likewise {
        /// What is answered.
        order: Order,
        /// And by whose answer: that to this frame, as [`Order::frame`] has it.
        of: u32,
    },
    /// PING, sent back.
    Ping(Ping),
    /// TIMESYNC: the time of day.
    TimeSync {
        /// The time of the question, ns of the sender's clock.
        asked: i64,
    },
    /// PARAM_VALUE of one parameter.
    Parameter(Name),
    /// PARAM_VALUE of every parameter, one after the other.
    AllParameters,
    /// STATUSTEXT: the [bench report](crate::link::bench_report), line by line.
    BenchReport,
    /// A message, once.
    Message(Kind),
    /// A message, once, and COMMAND_ACK: whether it was sent.
    Requested(Kind, Order),
    /// AVAILABLE_MODES of one mode, counted from 1.
    Mode(u8),
    /// A message every so many us from now on; 0 as usual, below that never.
    Interval {
        /// Which.
        kind: Kind,
        /// us.
        interval: i64,
    },
    /// MESSAGE_INTERVAL of a message.
    IntervalOf(Kind),
    /// LOG_ENTRY of the logs with these numbers.
    Logs {
        /// The first.
        first: u16,
        /// The last; there may be fewer.
        last: u16,
    },
    /// LOG_ENTRY: no logs.
    NoLogs,
    /// LOG_DATA of a log.
    LogData {
        /// Its number.
        id: u16,
        /// Bytes from its beginning.
        offset: u32,
        /// Bytes.
        count: u32,
    },
    /// No more LOG_DATA and LOG_ENTRY.
    LogEnd,
    /// MISSION_COUNT: how much there is in that list.
    MissionCount(MissionList, u16),
    /// MISSION_REQUEST_INT of an item.
    MissionRequest(MissionList, u16),
    /// An item.
    MissionItem {
        /// Of which list.
        list: MissionList,
        /// Its number.
        number: u16,
        /// As MISSION_ITEM_INT, or as MISSION_ITEM.
        is_int: bool,
    },
    /// MISSION_ACK.
    Mission(MissionList, MavMissionResult),
    /// FILE_TRANSFER_PROTOCOL: there are no files.
    NoFiles(FileRequest),
}
