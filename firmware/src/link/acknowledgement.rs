//! COMMAND_ACK as it is sent: of commands that the dialect does not have as well, and with whom it is for, which the
//! crate's type cannot hold.
//!
//! More than one station may command. The target of an answer shows whose command it grants or refuses.

use super::frame::{Frame, Header};
use mavlink::MessageData;
use mavlink::dialects::common::{COMMAND_ACK_DATA, COMMAND_INT_DATA, COMMAND_LONG_DATA, MavCmd, MavMessage, MavResult};
use mavlink::{MavlinkVersion, error::ParserError};

/// A command to be answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Order {
    /// Its number, whether the dialect has that one or not.
    pub command: u16,
    /// The sender: system and component.
    pub sender: (u8, u8),
    /// In which frame: its system, its sequence number, and its checksum over all of it.
    pub frame: u32,
}

impl Order {
    /// The one in a frame.
    pub(super) const fn read(command: u16, frame: &Frame<'_>) -> Self {
        let Frame { header: Header { system, component, sequence }, checksum, .. } = *frame;
        let [high, low] = checksum.to_be_bytes();
        Self { command, sender: (system, component), frame: u32::from_be_bytes([system, sequence, high, low]) }
    }

    /// The answer to it.
    pub const fn answered(self, result: MavResult) -> Acknowledgement {
        Acknowledgement { order: self, result }
    }
}

/// COMMAND_ACK, with its extension fields.
#[derive(Debug, Clone, PartialEq)]
pub struct Acknowledgement {
    /// The answered command.
    pub order: Order,
    /// The result.
    pub result: MavResult,
}

/// Where COMMAND_LONG and COMMAND_INT have their command: after seven numbers of four bytes.
const COMMAND_BYTES: core::ops::Range<usize> = 28..30;
/// And after it whom it is for.
const TARGET_BYTES: core::ops::Range<usize> = 30..32;

/// The number of a command in a message of this kind that could not be read, and whom it is for: system, component.
pub fn command_of(message: u32, payload: &[u8]) -> Option<(u16, [u8; 2])> {
    if ![COMMAND_LONG_DATA::ID, COMMAND_INT_DATA::ID].contains(&message) {
        return None;
    }
    // Zeros at the end are cut off.
    let byte = |place: usize| payload.get(place).copied().unwrap_or(0);
    Some((
        u16::from_le_bytes([byte(COMMAND_BYTES.start), byte(COMMAND_BYTES.start + 1)]),
        [byte(TARGET_BYTES.start), byte(TARGET_BYTES.start + 1)],
    ))
}

impl MessageData for Acknowledgement {
    type Message = MavMessage;
    const ID: u32 = COMMAND_ACK_DATA::ID;
    const NAME: &'static str = COMMAND_ACK_DATA::NAME;
    const EXTRA_CRC: u8 = COMMAND_ACK_DATA::EXTRA_CRC;
    /// Behind the result: progress and a second result, which are not set, and the target.
    const ENCODED_LEN: usize = COMMAND_ACK_DATA::ENCODED_LEN + 7;

    fn ser(&self, _: MavlinkVersion, payload: &mut [u8]) -> usize {
        let ([low, high], (system, component)) = (self.order.command.to_le_bytes(), self.order.sender);
        let bytes = [low, high, self.result as u8, 0, 0, 0, 0, 0, system, component];
        payload.iter_mut().zip(bytes).for_each(|(place, byte)| *place = byte);
        // Zeros at the end are cut off.
        bytes.iter().rposition(|byte| *byte != 0).map_or(1, |last| last + 1)
    }

    fn deser(version: MavlinkVersion, payload: &[u8]) -> Result<Self, ParserError> {
        let byte = |place: usize| payload.get(place).copied().unwrap_or(0);
        // The crate's type reads the result, of a command that it has.
        let [low, high] = (MavCmd::MAV_CMD_NAV_WAYPOINT as u16).to_le_bytes();
        let COMMAND_ACK_DATA { result, .. } = COMMAND_ACK_DATA::deser(version, &[low, high, byte(2)])?;
        let command = u16::from_le_bytes([byte(0), byte(1)]);
        // An answer does not name the frame.
        let order = Order { command, sender: (byte(8), byte(9)), frame: 0 };
        Ok(order.answered(result))
    }
}
