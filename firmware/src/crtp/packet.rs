//! Packets: a header byte and at most 30 bytes of data.
//!
//! ```text
//! header   port (4 bits) | reserved (2 bits) | channel (2 bits)
//! ```
//!
//! A line carries them whole: a radio or a socket keeps them apart and leaves out those that arrive damaged.

use core::future::Future;
use heapless::Vec;

/// The most data that a packet has, bytes.
pub const DATA_MAX_BYTES: usize = 30;

/// The bits of a header that mean nothing: a radio uses them on its way.
const RESERVED: u8 = 0b0000_1100;

/// One packet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Packet {
    /// What it is about, 0 to 15.
    pub port: u8,
    /// What of it, 0 to 3.
    pub channel: u8,
    data: Vec<u8, DATA_MAX_BYTES>,
}

impl Packet {
    /// One without data.
    pub const fn new(port: u8, channel: u8) -> Self {
        Self { port: port & 0xF, channel: channel & 3, data: Vec::new() }
    }

    /// The packet in these bytes; none without a header, or with more data than a packet has.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (&header, data) = bytes.split_first()?;
        Some(Self { port: header >> 4, channel: header & 3, data: Vec::from_slice(data).ok()? })
    }

    /// Its bytes, header first.
    pub fn to_bytes(&self) -> Vec<u8, { DATA_MAX_BYTES + 1 }> {
        let mut bytes = Vec::new();
        // There is room for the header, and for as much data as a packet has.
        let _ = bytes.push(self.port << 4 | RESERVED | self.channel);
        let _ = bytes.extend_from_slice(&self.data);
        bytes
    }

    /// Its data.
    pub fn data(&self) -> &[u8] {
        &self.data
    }

    /// The same with these bytes behind its data; what does not fit is cut off.
    #[must_use]
    pub fn with(mut self, bytes: &[u8]) -> Self {
        let room = bytes.len().min(self.room());
        // There is room for that.
        let _ = self.data.extend_from_slice(bytes.get(..room).unwrap_or(&[]));
        self
    }

    /// How many bytes it has room for.
    pub fn room(&self) -> usize {
        DATA_MAX_BYTES - self.data.len()
    }
}

/// A line's receiving half.
pub trait ReceivePackets {
    /// Waits for the next packet. What cannot be one is left out. Dropped while it waits, it loses nothing.
    fn receive(&mut self) -> impl Future<Output = Packet>;
}

/// A line's sending half.
pub trait SendPackets {
    /// Sends a packet once the line takes it. The caller bounds the time that may take; one that is given up is lost.
    fn send(&mut self, packet: &Packet) -> impl Future<Output = ()>;
}
