//! The MAVLink link: poses, setpoints, requests and parameters in; telemetry, answers and events out.
//!
//! | module | what it holds |
//! |---|---|
//! | [`frame`] | frames in a stream of bytes, both ways |
//! | [`receive`] | what comes in, message by message |
//! | [`pose`], [`setpoint`], [`command`] | what the messages that matter for flight mean |
//! | [`transmit`] | what goes out, and when |
//! | [`telemetry`] | reports, answers and events as messages |
//!
//! Two tasks, one for each direction, so that a line that takes nothing more does not keep poses from coming in. Frames of
//! both protocol versions are understood, version 2 is sent. Nothing is signed: whoever is on the line commands.

pub mod command;
pub mod frame;
#[expect(deprecated, reason = "clients still send it and wait for the answer")]
mod ping;
pub mod pose;
pub mod receive;
mod reply;
pub mod setpoint;
pub mod telemetry;
pub mod transmit;

pub use reply::{CommandResult, Reply};

/// MAV_COMP_ID_AUTOPILOT1: this component.
pub const COMPONENT: u8 = 1;

/// Whether a message addressed so is for this vehicle; 0 is everyone.
fn is_addressed(system: u8, component: u8, own_system: u8) -> bool {
    (system == 0 || system == own_system) && (component == 0 || component == COMPONENT)
}
