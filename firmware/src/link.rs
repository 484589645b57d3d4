//! The MAVLink link: poses, setpoints, requests and parameters in; telemetry, answers and events out.
//!
//! | module | what it holds |
//! |---|---|
//! | [`frame`] | frames in a stream of bytes |
//! | [`draft`] | frames to send |
//! | [`checksum`], [`message`] | what the protocol's definitions say about its messages, as far as it is needed |
//! | [`receive`] | what comes in, message by message |
//! | [`pose`], [`setpoint`], [`command`] | what the messages that matter for flight mean |
//! | [`transmit`] | what goes out, and when |
//! | [`telemetry`] | reports, answers and events as messages |
//!
//! Two tasks, one for each direction, so that a line that takes nothing more does not keep poses from coming in. Frames of
//! both protocol versions are understood, version 2 is sent. Nothing is signed: whoever is on the line commands. Messages are
//! read and written field by field: the code generated for a whole dialect would take 6 KB more.

pub mod checksum;
pub mod command;
pub mod draft;
pub mod frame;
pub mod message;
pub mod pose;
pub mod receive;
mod reply;
pub mod setpoint;
pub mod telemetry;
pub mod transmit;

pub use reply::{CommandResult, Reply};

/// MAV_COMP_ID_AUTOPILOT1: this component.
pub const COMPONENT: u8 = 1;
