//! Frames to send: a message's fields, one after the other, in a frame of version 2.

use super::checksum::{checksum, extra};
use super::frame::{CHECKSUM, FRAME_MAX, HEADER_V2, Header, START_V2};

/// A frame being written.
pub struct Draft {
    buffer: [u8; FRAME_MAX],
    length: usize,
    message: u32,
}

impl Draft {
    /// Nothing yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { buffer: [0; FRAME_MAX], length: 0, message: 0 }
    }

    /// Starts a message; its fields follow in the order in which the protocol sends them.
    pub fn begin(&mut self, message: u32) -> &mut Self {
        self.message = message;
        self.length = HEADER_V2;
        self
    }

    /// Adds bytes, as many as still fit.
    pub fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        for (place, byte) in self.buffer.iter_mut().take(HEADER_V2 + usize::from(u8::MAX)).skip(self.length).zip(bytes)
        {
            *place = *byte;
            self.length += 1;
        }
        self
    }

    /// Adds numbers in single precision.
    pub fn floats(&mut self, numbers: &[f32]) -> &mut Self {
        for number in numbers {
            self.bytes(&number.to_le_bytes());
        }
        self
    }

    /// Adds numbers of two bytes.
    pub fn shorts(&mut self, numbers: &[u16]) -> &mut Self {
        for number in numbers {
            self.bytes(&number.to_le_bytes());
        }
        self
    }

    /// Adds a text in a field of `size` bytes, with zeros behind it.
    pub fn text(&mut self, text: &str, size: usize) -> &mut Self {
        for index in 0..size {
            self.bytes(&[text.as_bytes().get(index).copied().unwrap_or(0)]);
        }
        self
    }

    /// The frame: header and checksum around the fields, without the zeros at their end.
    pub fn finish(&mut self, header: Header) -> &[u8] {
        let whole = self.buffer.get(..self.length).unwrap_or(&[]);
        // The first byte of the fields is always sent.
        let end = whole.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1).max(HEADER_V2 + 1);
        let [low, middle, high, _] = self.message.to_le_bytes();
        let Header { system, component, sequence } = header;
        let start = [START_V2, (end - HEADER_V2) as u8, 0, 0, sequence, system, component, low, middle, high];
        for (place, byte) in self.buffer.iter_mut().zip(start) {
            *place = byte;
        }
        let sum = checksum(self.buffer.get(1..end).unwrap_or(&[]), extra(self.message).unwrap_or(0));
        for (place, byte) in self.buffer.iter_mut().skip(end).zip(sum.to_le_bytes()) {
            *place = byte;
        }
        self.buffer.get(..end + CHECKSUM).unwrap_or(&[])
    }
}

impl Default for Draft {
    fn default() -> Self {
        Self::new()
    }
}
