//! The MAVLink link: poses, setpoints, requests and parameters in; telemetry, answers and events out.
//!
//! | module | what it holds |
//! |---|---|
//! | [`frame`] | frames in a stream of bytes |
//! | [`receive`] | what comes in, message by message |
//! | [`pose`], [`setpoint`], [`command`], [`set_mode`] | what the messages that matter for flight mean |
//! | [`sender_clock`], [`time_sync`] | when a pose was true, on the vehicle's clock |
//! | [`transmit`] | what goes out, and when |
//! | [`streams`] | which messages go out by the clock, and how often |
//! | [`telemetry`] | what the vehicle knows as messages |
//! | [`bench_report`] | what a probe's log says of the boot, for whoever has only the link |
//! | [`origin`] | a local frame on the globe |
//! | [`download`] | the list of logs, and a log, part by part |
//! | [`port`] | which of two lines it is on |
//! | [`mission`] | the items of a mission |
//! | [`mission_lists`], [`files`] | which list of items is meant; answers to clients that request files |
//! | [`acknowledgement`], [`repetitions`] | answers to commands; commands delivered twice |
//! | [`signing`] | who may speak: signed frames |
//! | [`writer`] | messages as frames |
//!
//! Two tasks, one for each direction, so that a line that takes nothing more does not keep poses from coming in. Frames
//! of both protocol versions are understood, version 2 is sent, without extension fields but those of [`mission_lists`]
//! and [`acknowledgement`]. Without a key nothing is signed, and any sender on the line commands. What a message's
//! fields are is defined by the `mavlink` crate: only the types that matter here are decoded, each by itself, because
//! matching on all messages of the dialect at once would take 56 KB of flash. A message with a value that the dialect
//! does not know (a frame, a command, a type) is not decoded.

pub mod acknowledgement;
pub mod bench_report;
pub mod command;
pub mod commander;
pub mod download;
pub mod files;
pub mod frame;
pub mod mission;
pub mod mission_lists;
pub mod origin;
pub mod port;
pub mod pose;
pub mod receive;
pub mod repetitions;
pub mod sender_clock;
pub mod set_mode;
pub mod setpoint;
pub mod signing;
pub mod streams;
pub mod telemetry;
pub mod time_sync;
pub mod transmit;
pub mod writer;

/// MAV_COMP_ID_AUTOPILOT1: this component.
pub const COMPONENT_ID: u8 = 1;
