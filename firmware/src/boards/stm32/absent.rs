//! What a board may lack.

use super::packet_radio::PacketRadio;
use crate::hardware::{Card, Fault, SECTOR_BYTES};

/// The slot that there is not.
pub enum NoCard {}

impl Card for NoCard {
    fn start(&mut self) -> Result<(), Fault> {
        match *self {}
    }

    fn sectors(&self) -> u32 {
        match *self {}
    }

    fn read(&mut self, _: u32, _: &mut [u8; SECTOR_BYTES]) -> Result<(), Fault> {
        match *self {}
    }

    fn write(&mut self, _: u32, _: &[u8; SECTOR_BYTES]) -> Result<(), Fault> {
        match *self {}
    }
}

/// The radio chip that there is not. The image has no code for it.
pub enum NoPacketRadio {}

impl From<NoPacketRadio> for PacketRadio {
    fn from(none: NoPacketRadio) -> Self {
        match none {}
    }
}
