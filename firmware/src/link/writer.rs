//! Frames to send: messages of the `mavlink` crate's types as frames of version 2, numbered in the order they are sent.

use super::COMPONENT_ID;
use super::signing::Signing;
use crate::shared::access::Read;
use embassy_sync::blocking_mutex::raw::RawMutex;
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MessageData};

/// Where frames are written, one after the other.
pub struct Writer {
    frame: MAVLinkV2MessageRaw,
    sequence: u8,
}

impl Writer {
    /// Nothing written yet.
    pub const fn new() -> Self {
        Self { frame: MAVLinkV2MessageRaw::new(), sequence: 0 }
    }

    /// Writes a message from this component of `system` over the one before.
    pub fn write(&mut self, system: u8, message: &impl MessageData) {
        let header = MavHeader { system_id: system.into(), component_id: COMPONENT_ID, sequence: self.sequence };
        self.sequence = self.sequence.wrapping_add(1);
        // Not the last one's: signed, perhaps.
        *self.frame.incompatibility_flags_mut() = 0;
        self.frame.serialize_message_data(header, message);
    }

    /// Writes a message, if there is one; whether there was.
    pub fn write_some(&mut self, system: u8, message: Option<impl MessageData>) -> bool {
        message.is_some_and(|message| {
            self.write(system, &message);
            true
        })
    }

    /// Signs the frame last written, if there is a key: once.
    pub fn sign<M: RawMutex>(&mut self, signing: Read<'_, Signing<M>>, now: u64) {
        signing.sign(&mut self.frame, now);
    }

    /// The frame last written.
    pub fn bytes(&self) -> &[u8] {
        self.frame.raw_bytes()
    }
}
