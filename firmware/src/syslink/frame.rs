//! Frames, and their bytes.

use heapless::Vec;

/// What a frame begins with.
pub const START: [u8; 2] = [0xBC, 0xCF];

/// The most data that a frame has, bytes.
pub const DATA_MAX_BYTES: usize = 64;

/// Start, kind and length before the data, sums behind them, bytes.
pub const OVERHEAD_BYTES: usize = START.len() + 2 + 2;

/// The longest frame, bytes.
pub const FRAME_MAX_BYTES: usize = OVERHEAD_BYTES + DATA_MAX_BYTES;

/// One frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// What it is about: see [`super::message`].
    pub kind: u8,
    data: Vec<u8, DATA_MAX_BYTES>,
}

impl Frame {
    /// None with more data than a frame has.
    pub fn new(kind: u8, data: &[u8]) -> Option<Self> {
        Some(Self { kind, data: Vec::from_slice(data).ok()? })
    }

    /// Its data.
    pub fn data(&self) -> &[u8] {
        &self.data
    }

    /// Its bytes.
    pub fn to_bytes(&self) -> Vec<u8, FRAME_MAX_BYTES> {
        let head = [self.kind, self.data.len() as u8];
        let sums = sums(head.iter().chain(&self.data));
        let mut bytes = Vec::new();
        // There is room for as much data as a frame has.
        let _ = bytes.extend_from_slice(&START);
        let _ = bytes.extend_from_slice(&head);
        let _ = bytes.extend_from_slice(&self.data);
        let _ = bytes.extend_from_slice(&sums);
        bytes
    }
}

/// The sum of these bytes, and the sum of the sums up to each of them, modulo 256.
pub fn sums<'a>(bytes: impl IntoIterator<Item = &'a u8>) -> [u8; 2] {
    bytes.into_iter().fold([0, 0], |[sum, of_sums]: [u8; 2], byte| {
        let sum = sum.wrapping_add(*byte);
        [sum, of_sums.wrapping_add(sum)]
    })
}
