//! An answer to a command that the dialect does not have: COMMAND_ACK by number, which the crate's type cannot hold.

use mavlink::MessageData;
use mavlink::dialects::common::{COMMAND_ACK_DATA, COMMAND_INT_DATA, COMMAND_LONG_DATA, MavMessage, MavResult};
use mavlink::{MavlinkVersion, error::ParserError};

/// COMMAND_ACK of a command by its number: unsupported.
#[derive(Debug, Clone, PartialEq)]
pub struct UnknownCommand(pub u16);

/// Where COMMAND_LONG and COMMAND_INT have their command: after seven numbers of four bytes.
const COMMAND: core::ops::Range<usize> = 28..30;
/// And after it whom it is for.
const TARGET: core::ops::Range<usize> = 30..32;

/// The number of a command in a message of this kind that could not be read, and whom it is for: system, component.
pub fn command_of(message: u32, payload: &[u8]) -> Option<(u16, [u8; 2])> {
    if ![COMMAND_LONG_DATA::ID, COMMAND_INT_DATA::ID].contains(&message) {
        return None;
    }
    // Zeros at the end are cut off.
    let byte = |place: usize| payload.get(place).copied().unwrap_or(0);
    Some((
        u16::from_le_bytes([byte(COMMAND.start), byte(COMMAND.start + 1)]),
        [byte(TARGET.start), byte(TARGET.start + 1)],
    ))
}

impl MessageData for UnknownCommand {
    type Message = MavMessage;
    const ID: u32 = COMMAND_ACK_DATA::ID;
    const NAME: &'static str = COMMAND_ACK_DATA::NAME;
    const EXTRA_CRC: u8 = COMMAND_ACK_DATA::EXTRA_CRC;
    const ENCODED_LEN: usize = COMMAND_ACK_DATA::ENCODED_LEN;

    fn ser(&self, _: MavlinkVersion, payload: &mut [u8]) -> usize {
        let [low, high] = self.0.to_le_bytes();
        let bytes = [low, high, MavResult::MAV_RESULT_UNSUPPORTED as u8];
        payload.iter_mut().zip(bytes).for_each(|(place, byte)| *place = byte);
        bytes.len()
    }

    fn deser(_: MavlinkVersion, payload: &[u8]) -> Result<Self, ParserError> {
        match payload {
            [low, high, ..] => Ok(Self(u16::from_le_bytes([*low, *high]))),
            _ => Ok(Self(0)),
        }
    }
}
