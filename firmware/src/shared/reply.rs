//! What the vehicle answers, and to what.

use crate::parameters::table::Name;
use controller_core::flight::Request;
use mavlink::dialects::common::{MavCmd, MavResult};

/// PING: superseded by TIMESYNC, but clients still send it and wait for the answer.
#[expect(deprecated, reason = "see above")]
pub type Ping = mavlink::dialects::common::PING_DATA;

/// A request to control, to be answered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asked {
    /// What for.
    pub request: Request,
    /// The command it came by.
    pub command: MavCmd,
}

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

/// One message to send.
#[derive(Debug, Clone, PartialEq)]
pub enum Reply {
    /// COMMAND_ACK.
    Command {
        /// What it answers.
        command: MavCmd,
        /// With what.
        result: MavResult,
    },
    /// PING, sent back.
    Ping(Ping),
    /// TIMESYNC: the time of day.
    TimeSync {
        /// When it was asked, ns of the asker's clock.
        asked: i64,
    },
    /// PARAM_VALUE of one parameter.
    Parameter(Name),
    /// PARAM_VALUE of every parameter, one after the other.
    AllParameters,
}
