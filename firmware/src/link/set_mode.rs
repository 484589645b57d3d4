//! SET_MODE: older clients' DO_SET_MODE.

use super::frame::Frame;

/// SET_MODE. The crate's type knows base modes without a custom mode only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SetMode {
    /// The flags of MAV_MODE_FLAG.
    pub base: u8,
    /// PX4's main mode, the third byte of the custom mode.
    pub main: u8,
    /// And what it is divided into, the fourth.
    pub sub: u8,
    /// The system that it is for.
    pub system: u8,
}

impl SetMode {
    /// The message's number.
    pub const ID: u32 = 11;

    /// The fields of a message of that number.
    pub fn read(frame: &Frame<'_>) -> Self {
        // Zeros at the end are cut off.
        let byte = |place: usize| frame.payload.get(place).copied().unwrap_or(0);
        Self { main: byte(2), sub: byte(3), system: byte(4), base: byte(5) }
    }
}
