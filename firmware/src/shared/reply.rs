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
    /// PARAM_VALUE of one parameter.
    Parameter(Name),
    /// PARAM_VALUE of every parameter, one after the other.
    AllParameters,
}
