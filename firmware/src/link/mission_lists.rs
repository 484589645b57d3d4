//! Lists of mission items: the mission, the fence and the rally points. The last two are empty here.
//!
//! Which list a message is about, MAV_MISSION_TYPE, is an extension field, and the crate's types have none. It is read
//! and written here, behind the other fields: clients drop an answer about another list than the requested one.

use super::frame::Frame;
use mavlink::dialects::common::MavMessage;
use mavlink::error::ParserError;
use mavlink::{MavlinkVersion, MessageData};

/// The list that a message of type `D` is about: zero, the mission, where the field is cut off or was never sent.
pub fn list_of<D: MessageData>(frame: &Frame<'_>) -> u8 {
    frame.payload.get(D::ENCODED_LEN).copied().unwrap_or(0)
}

/// A message, and the list it is about.
#[derive(Debug, Clone, PartialEq)]
pub struct About<D> {
    /// Its other fields.
    pub message: D,
    /// MAV_MISSION_TYPE.
    pub list: u8,
}

impl<D: MessageData<Message = MavMessage>> MessageData for About<D> {
    type Message = MavMessage;
    const ID: u32 = D::ID;
    const NAME: &'static str = D::NAME;
    const EXTRA_CRC: u8 = D::EXTRA_CRC;
    const ENCODED_LEN: usize = D::ENCODED_LEN + 1;

    fn ser(&self, version: MavlinkVersion, payload: &mut [u8]) -> usize {
        let length = self.message.ser(version, payload);
        match payload.get_mut(D::ENCODED_LEN) {
            Some(place) if self.list != 0 => *place = self.list,
            // Zeros at the end are cut off.
            _ => return length,
        }
        Self::ENCODED_LEN
    }

    fn deser(version: MavlinkVersion, payload: &[u8]) -> Result<Self, ParserError> {
        let list = payload.get(D::ENCODED_LEN).copied().unwrap_or(0);
        D::deser(version, payload).map(|message| Self { message, list })
    }
}
