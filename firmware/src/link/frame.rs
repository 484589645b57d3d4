//! MAVLink frames: found in a stream of bytes, and checked.
//!
//! [`Parser`] takes one byte at a time and hands out frames whose checksum is right, of both protocol versions.
//! Nothing that lies within another frame's payload is taken for a frame:
//!
//! - A frame of a message outside the dialect, or with an incompatibility flag that is not understood, is skipped
//!   whole. It has no mark of its own, but where a frame has just ended, or been skipped, another begins.
//! - Behind noise, and behind a frame whose checksum is wrong, a frame is taken only if it ends behind all that may
//!   have begun there. So a broken frame costs itself and what lies where the rest of it should, [`FRAME_MAX_BYTES`]
//!   bytes at most.
//!
//! Every frame carries a time before which none of its bytes arrived: that of its first byte, or, for a frame found
//! behind a broken one, that of the broken one's first byte. Bytes older than [`FRAME_AGE_MAX_US`] are thrown away. So
//! an old pose never comes out as a fresh one.
//!
//! Checksums need a number for each message that only the dialect defines, so frames of messages outside `common` look
//! like noise. After a pause of [`FRAME_AGE_MAX_US`] within a frame, the sender is taken to begin anew.
//!
//! Work for one byte is bounded: at most one frame is checked for each byte given up, and no byte is given up twice.

use mavlink::dialects::common::MavMessage;
use mavlink::{MavlinkVersion, Message, MessageData, calculate_crc};

/// The longest frame: version 2, 255 bytes of payload, signed.
pub const FRAME_MAX_BYTES: usize = 280;

/// Bytes that have waited longer than this for the rest of their frame are dropped: the age at which a pose is
/// refused.
pub const FRAME_AGE_MAX_US: u64 = 100_000;

/// First byte of a version 1 frame.
const START_V1: u8 = 0xFE;
/// First byte of a version 2 frame.
const START_V2: u8 = 0xFD;
/// Bytes before the payload: start, length, sequence, system, component, message.
const HEADER_V1_BYTES: usize = 6;
/// Bytes before the payload: start, length, two of flags, sequence, system, component, three of message.
const HEADER_V2_BYTES: usize = 10;
/// Bytes of the checksum behind the payload.
const CHECKSUM_BYTES: usize = 2;
const SIGNATURE_BYTES: usize = 13;

/// The only incompatibility flag that is understood: a signature follows. [`super::signing`] verifies it.
pub const SIGNED_FLAG: u8 = 1;

/// The protocol's version of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Version {
    /// All fields, no extensions.
    V1,
    /// Zeros are cut off the end.
    V2,
}

/// Sender and sequence number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Header {
    /// System, 1 to 255.
    pub system: u8,
    /// Component.
    pub component: u8,
    /// Counts the sender's frames, modulo 256.
    pub sequence: u8,
}

/// A frame whose checksum is right.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Protocol version.
    pub version: Version,
    /// The sender.
    pub header: Header,
    /// The message's number.
    pub message: u32,
    /// Its fields; version 2 cuts zeros off the end.
    pub payload: &'a [u8],
    /// All of it, from its first byte to its checksum or signature.
    pub bytes: &'a [u8],
    /// The frame's own checksum, which distinguishes frames with equal headers.
    pub checksum: u16,
    /// No byte of it arrived before this, us.
    pub time: u64,
}

impl Frame<'_> {
    /// The message, if it is of this type and its enumerations have values of the dialect. Version 2 cuts zeros off the
    /// end of a message; version 1 does not: there, a shorter payload is something else.
    pub fn decode<D: MessageData>(&self) -> Option<D> {
        let is_whole = self.version == Version::V2 || self.payload.len() >= D::ENCODED_LEN;
        if self.message == D::ID && is_whole { D::deser(MavlinkVersion::V2, self.payload).ok() } else { None }
    }
}

/// What the start of the buffer is.
enum Candidate {
    /// A frame of so many bytes, checked.
    Frame(usize),
    /// Perhaps a frame of so many bytes that is not understood.
    Foreign(usize),
    /// Perhaps a frame of so many bytes with a wrong checksum.
    Broken(usize),
    /// Perhaps a frame, once more bytes are there.
    Incomplete,
    /// Nothing that starts here.
    Noise,
}

/// Finds frames in a stream of bytes.
pub struct Parser {
    buffer: [u8; FRAME_MAX_BYTES],
    length: usize,
    /// The frame last handed out, still at the start of the buffer.
    taken: usize,
    /// Whether the buffer begins where a frame should.
    is_aligned: bool,
    /// What ends within so many bytes from the start of the buffer may be part of something else.
    barred: usize,
    /// No byte of the buffer arrived before this, us.
    since: u64,
    discarded: u32,
}

impl Parser {
    /// Nothing received yet.
    pub const fn new() -> Self {
        Self { buffer: [0; FRAME_MAX_BYTES], length: 0, taken: 0, is_aligned: true, barred: 0, since: 0, discarded: 0 }
    }

    /// Takes the next byte, which arrived at `now` (us), and returns a frame if there is one. There may be more: call
    /// [`Self::next_frame`] until it returns none.
    pub fn push(&mut self, byte: u8, now: u64) -> Option<Frame<'_>> {
        self.remove(self.taken);
        self.taken = 0;
        if now.saturating_sub(self.since) > FRAME_AGE_MAX_US || self.length == FRAME_MAX_BYTES {
            self.forget();
        }
        if self.length == 0 {
            self.since = now;
        }
        if let Some(place) = self.buffer.get_mut(self.length) {
            *place = byte;
            self.length += 1;
        }
        self.next_frame()
    }

    /// Takes all of `bytes`, which arrived at `now` (us), and hands every frame to `act`.
    pub fn feed(&mut self, bytes: &[u8], now: u64, act: &mut dyn FnMut(&Frame<'_>)) {
        for &byte in bytes {
            let mut next = self.push(byte, now);
            while let Some(frame) = next {
                act(&frame);
                next = self.next_frame();
            }
        }
    }

    /// A frame that is complete already, if there is another.
    pub fn next_frame(&mut self) -> Option<Frame<'_>> {
        self.remove(self.taken);
        self.taken = 0;
        let mut passed = 0;
        let found = loop {
            let rest = self.buffer.get(passed..self.length).unwrap_or(&[]);
            match candidate(rest) {
                Candidate::Frame(length) if passed + length > self.barred => break Some(length),
                Candidate::Frame(length) => passed += length,
                Candidate::Foreign(length) if self.is_aligned && rest.len() < length => break None,
                Candidate::Foreign(length) if self.is_aligned => passed += length,
                Candidate::Foreign(length) | Candidate::Broken(length) => {
                    (self.is_aligned, self.barred) = (false, self.barred.max(passed + length));
                    passed += 1;
                }
                Candidate::Incomplete => break None,
                Candidate::Noise => (self.is_aligned, passed) = (false, passed + 1),
            }
        };
        self.discarded = self.discarded.wrapping_add(passed as u32);
        self.remove(passed);
        self.taken = found?;
        (self.is_aligned, self.barred) = (true, 0);
        frame(self.buffer.get(..self.taken)?, self.since)
    }

    /// Bytes so far that were part of no frame, modulo 2^32.
    pub fn discarded(&self) -> u32 {
        self.discarded
    }

    /// Drops what it has: the next byte comes from somewhere else.
    pub fn forget(&mut self) {
        self.remove(self.taken);
        self.taken = 0;
        self.discarded = self.discarded.wrapping_add(self.length as u32);
        (self.length, self.is_aligned, self.barred) = (0, false, 0);
    }

    /// Drops bytes from the start of the buffer.
    fn remove(&mut self, count: usize) {
        if count > 0 {
            self.buffer.copy_within(count.min(self.length)..self.length, 0);
            self.length = self.length.saturating_sub(count);
            self.barred = self.barred.saturating_sub(count);
        }
    }
}

/// Judges the bytes as far as they are there; an empty buffer waits for more.
fn candidate(bytes: &[u8]) -> Candidate {
    let (header, signature) = match *bytes {
        [] => return Candidate::Incomplete,
        [START_V1, ..] => (HEADER_V1_BYTES, 0),
        [START_V2] | [START_V2, _] => return Candidate::Incomplete,
        [START_V2, _, flags, ..] => (HEADER_V2_BYTES, if flags & SIGNED_FLAG == 0 { 0 } else { SIGNATURE_BYTES }),
        _ => return Candidate::Noise,
    };
    let (Some(&payload), Some(message)) = (bytes.get(1), message(bytes)) else { return Candidate::Incomplete };
    let end = header + usize::from(payload);
    let length = end + CHECKSUM_BYTES + signature;
    // Messages without such a number, in the dialect or not, look like noise.
    let Some(extra) = extra(message).filter(|_| is_understood(bytes)) else { return Candidate::Foreign(length) };
    let (Some(checked), Some(&[low, high])) = (bytes.get(1..end), bytes.get(end..end + CHECKSUM_BYTES)) else {
        return Candidate::Incomplete;
    };
    if calculate_crc(checked, extra) != u16::from_le_bytes([low, high]) {
        return Candidate::Broken(length);
    }
    if bytes.len() < length { Candidate::Incomplete } else { Candidate::Frame(length) }
}

/// Whether all incompatibility flags are known.
fn is_understood(bytes: &[u8]) -> bool {
    !matches!(*bytes, [START_V2, _, flags, ..] if flags & !SIGNED_FLAG != 0)
}

/// A message definition's part of the checksum; none for a message outside the dialect.
fn extra(message: u32) -> Option<u8> {
    Some(MavMessage::extra_crc(message)).filter(|&extra| extra != 0)
}

/// The message's number, if the header is there.
fn message(bytes: &[u8]) -> Option<u32> {
    match *bytes {
        [START_V1, _, _, _, _, message, ..] => Some(message.into()),
        [START_V2, _, _, _, _, _, _, low, middle, high, ..] => Some(u32::from_le_bytes([low, middle, high, 0])),
        _ => None,
    }
}

/// The parts of a complete frame.
fn frame(bytes: &[u8], time: u64) -> Option<Frame<'_>> {
    let (version, header, [sequence, system, component]) = match *bytes {
        [START_V1, _, sequence, system, component, ..] => (Version::V1, HEADER_V1_BYTES, [sequence, system, component]),
        [_, _, _, _, sequence, system, component, ..] => (Version::V2, HEADER_V2_BYTES, [sequence, system, component]),
        _ => return None,
    };
    let end = header + usize::from(*bytes.get(1)?);
    let &[low, high] = bytes.get(end..end + CHECKSUM_BYTES)? else { return None };
    Some(Frame {
        version,
        header: Header { system, component, sequence },
        message: message(bytes)?,
        payload: bytes.get(header..end)?,
        bytes,
        checksum: u16::from_le_bytes([low, high]),
        time,
    })
}
