//! PING: deprecated in favour of TIMESYNC, but clients still send it and wait for the answer.

use super::frame::Frame;
use super::reply::Reply;
use mavlink::MessageData;
use mavlink::dialects::common::PING_DATA;

/// PING's number.
pub const ID: u32 = PING_DATA::ID;

/// The answer to a ping. None for one that is itself an answer: it is addressed to somebody.
///
/// # Errors
/// For a frame that holds no ping.
pub fn question(frame: &Frame<'_>) -> Result<Option<Reply>, ()> {
    let ping: PING_DATA = frame.decode().ok_or(())?;
    let (system, component) = (frame.header.system, frame.header.component);
    let asked = (ping.target_system, ping.target_component) == (0, 0);
    Ok(asked.then_some(Reply::Ping { time: ping.time_usec, sequence: ping.seq, system, component }))
}

/// The message that answers a ping.
#[must_use]
pub fn answer(time: u64, sequence: u32, system: u8, component: u8) -> impl MessageData {
    PING_DATA { time_usec: time, seq: sequence, target_system: system, target_component: component }
}
