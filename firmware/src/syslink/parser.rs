//! Frames out of a stream of bytes.
//!
//! Bytes that begin no frame are skipped. Where a frame proves none, by its length or its sums, only its first byte is
//! skipped, and what came behind that is looked at again: a frame that follows one cut short, or stands in what was
//! taken for its data, is found. It waits there until as many bytes have come as the false one claims, 70 at most.

use super::frame::{DATA_MAX_BYTES, FRAME_MAX_BYTES, Frame, OVERHEAD_BYTES, START, sums};
use heapless::Vec;

/// What came and was no whole frame, since boot.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Dropped {
    /// Beginnings of frames that were too long, or whose sums were wrong.
    pub frames: u32,
    /// Bytes that were skipped, theirs included.
    pub bytes: u32,
}

/// What the bytes so far are.
enum Found {
    /// The beginning of a frame, or nothing.
    Part,
    /// A frame.
    Whole(Frame),
    /// Not the beginning of one.
    Noise,
    /// A beginning that no frame can have, or wrong sums.
    Broken,
}

/// The stream.
#[derive(Default)]
pub struct Parser {
    /// What has come since the last frame.
    bytes: Vec<u8, FRAME_MAX_BYTES>,
    dropped: Dropped,
}

impl Parser {
    /// Nothing received yet.
    pub const fn new() -> Self {
        Self { bytes: Vec::new(), dropped: Dropped { frames: 0, bytes: 0 } }
    }

    /// Takes bytes, and calls `each` with each frame that they complete, in order.
    pub fn feed(&mut self, bytes: &[u8], mut each: impl FnMut(Frame)) {
        for byte in bytes {
            // There is room: as soon as a longest frame is there it is taken away, whole or not.
            let _ = self.bytes.push(*byte);
            loop {
                match find(&self.bytes) {
                    Found::Part => break,
                    Found::Whole(frame) => {
                        self.skip(OVERHEAD_BYTES + frame.data().len());
                        each(frame);
                    }
                    Found::Noise => self.drop_first(),
                    Found::Broken => {
                        self.dropped.frames = self.dropped.frames.saturating_add(1);
                        self.drop_first();
                    }
                }
            }
        }
    }

    /// What was dropped.
    pub const fn dropped(&self) -> Dropped {
        self.dropped
    }

    /// Drops the first byte, and those behind it that cannot begin a frame.
    fn drop_first(&mut self) {
        let count = 1 + self.bytes.iter().skip(1).take_while(|byte| **byte != START[0]).count();
        self.dropped.bytes = self.dropped.bytes.saturating_add(count as u32);
        self.skip(count);
    }

    /// Takes so many of the first bytes away.
    fn skip(&mut self, count: usize) {
        // There is room for what is left.
        self.bytes = Vec::from_slice(self.bytes.get(count..).unwrap_or(&[])).unwrap_or_default();
    }
}

/// What bytes begin with.
fn find(bytes: &[u8]) -> Found {
    let start_matches = bytes.iter().zip(&START).all(|(byte, start)| byte == start);
    let [_, _, body @ ..] = bytes else { return if start_matches { Found::Part } else { Found::Noise } };
    if !start_matches {
        return Found::Noise;
    }
    let &[kind, length, ref rest @ ..] = body else { return Found::Part };
    let length = usize::from(length);
    if length > DATA_MAX_BYTES {
        return Found::Broken;
    }
    let (Some(data), Some(received)) = (rest.get(..length), rest.get(length..length + 2)) else { return Found::Part };
    match Frame::new(kind, data) {
        Some(frame) if sums(body.iter().take(2 + length)) == received => Found::Whole(frame),
        _ => Found::Broken,
    }
}
