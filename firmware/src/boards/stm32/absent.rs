//! What a board may lack.

use crate::hardware::{Battery, Card, Fault, SECTOR_BYTES};

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

/// Nothing measures the battery.
pub struct NoBattery;

impl Battery for NoBattery {
    async fn voltage(&mut self) -> Option<f32> {
        None
    }
}
