//! Kinds of numbers that are logged, and how each is written.

use crate::crtp::packet::Packet;
use half::f16;

/// Kinds of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    U8 = 1,
    U16,
    U32,
    I8,
    I16,
    I32,
    Float,
    Half,
}

impl Kind {
    const ALL: [Self; 8] = [Self::U8, Self::U16, Self::U32, Self::I8, Self::I16, Self::I32, Self::Float, Self::Half];

    /// The kind of this number, in the low bits of a byte.
    pub fn read(byte: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| *kind as u8 == byte & 0xF)
    }

    /// Bytes.
    pub const fn size(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 | Self::Half => 2,
            Self::U32 | Self::I32 | Self::Float => 4,
        }
    }

    /// The packet with a value behind it.
    pub fn write(self, packet: Packet, value: f64) -> Packet {
        match self {
            Self::U8 => packet.with(&(value as u8).to_le_bytes()),
            Self::U16 => packet.with(&(value as u16).to_le_bytes()),
            Self::U32 => packet.with(&(value as u32).to_le_bytes()),
            Self::I8 => packet.with(&(value as i8).to_le_bytes()),
            Self::I16 => packet.with(&(value as i16).to_le_bytes()),
            Self::I32 => packet.with(&(value as i32).to_le_bytes()),
            Self::Float => packet.with(&(value as f32).to_le_bytes()),
            Self::Half => packet.with(&f16::from_f64(value).to_le_bytes()),
        }
    }
}
