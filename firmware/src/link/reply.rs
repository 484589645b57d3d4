//! What the receiving half of the link gives the sending half to say.

use crate::parameters::table::Name;
use crate::shared::Origin;

/// MAV_RESULT, as far as it is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum CommandResult {
    /// Done.
    Accepted = 0,
    /// Not now; it may be worth trying again.
    TemporarilyRejected = 1,
    /// Not with these parameters, or not in this state.
    Denied = 2,
    /// Unknown to this vehicle.
    Unsupported = 3,
}

/// One message to send.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reply {
    /// COMMAND_ACK.
    Command {
        /// Whom it answers.
        origin: Origin,
        /// With what.
        result: CommandResult,
    },
    /// PING, sent back.
    Ping {
        /// The time it came with, us of the sender's clock.
        time: u64,
        /// The sender's count.
        sequence: u32,
        /// The sender.
        system: u8,
        /// The sender.
        component: u8,
    },
    /// PARAM_VALUE of one parameter.
    Parameter(Name),
    /// PARAM_VALUE of every parameter, one after the other.
    AllParameters,
}
