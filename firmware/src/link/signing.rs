//! Signed frames, as MAVLink 2 has them: <https://mavlink.io/en/guide/message_signing.html>.
//!
//! A signed frame ends with the number of the link that it was sent on, a time stamp, and the first 48 bits of SHA-256
//! over a key that both ends share and the frame up to there. Once there is a key, every frame out is signed, and a
//! frame in counts only if its signature is right and its stamp is above that of the frame before it. Stamps rise for
//! each stream (link, system, component) by itself. The vehicle's own clock of stamps has no calendar: it begins where
//! it was left off, goes on with the time, and jumps to every accepted stamp that is ahead of it. One that is further
//! ahead than [`LEAP_MAX`] is accepted only as the first since the start, and none from [`STAMP_MAX`] on: a sender
//! whose clock is broken would deafen the vehicle to everybody else, or use up the 48 bits.
//!
//! A frame that was accepted once is refused for ever after, also from a stream that was forgotten for want of room and
//! after a restart: stamps at or below a floor are refused from streams that are not known. The floor is the newest
//! stamp of any forgotten stream, and at boot the one in flash. That is kept ahead of the clock, by [`KEPT_AHEAD`] when
//! it is written and [`KEPT_AHEAD_MIN`] at least, because nothing can be written in flight.

use super::frame::{FRAME_MAX_BYTES, Frame, SIGNED_FLAG, Version};
use crate::words::worded;
use core::cell::RefCell;
use core::fmt;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use mavlink::dialects::common::MavMessage;
use mavlink::{MAVLinkV2MessageRaw, Message, calculate_crc};
use sha2::{Digest, Sha256};

/// Bytes of a key.
pub const KEY_BYTES: usize = 32;

/// Words that are kept in flash: the key, and the floor.
pub const KEPT_WORDS: usize = KEY_BYTES / size_of::<u32>() + 2;

/// 10 us since 2015 began, by the sender's clock; 48 bits.
pub type Stamp = u64;

/// A minute. A stream that is not known is refused if it is further behind the vehicle's clock.
const STAMPS_PER_MINUTE: Stamp = 6_000_000;

/// A year: no vehicle is put away for so long, so that no sound clock is further ahead of one that came before.
pub const LEAP_MAX: Stamp = 525_600 * STAMPS_PER_MINUTE;

/// The year 2100. 48 bits last four years longer.
pub const STAMP_MAX: Stamp = 31_046 * 1_440 * STAMPS_PER_MINUTE;

/// How far ahead of the clock the kept floor is put: no flight is longer.
pub const KEPT_AHEAD: Stamp = 60 * STAMPS_PER_MINUTE;

/// How far ahead of it the kept floor is at least while it can be kept.
pub const KEPT_AHEAD_MIN: Stamp = 30 * STAMPS_PER_MINUTE;

/// Streams that are known at a time.
pub const STREAMS_KNOWN: usize = 8;

/// Bytes of a signature behind the stamp.
const SIGNATURE_BYTES: usize = 6;

/// Bytes of the checksum, and of link and stamp behind it.
const CHECKSUM_BYTES: usize = 2;
const LINK_AND_STAMP_BYTES: usize = 7;

/// The number of the vehicle's own link.
const OWN_LINK: u8 = 0;

/// The secret of both ends. It is never shown; zeros are no key.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Key([u32; KEY_BYTES / size_of::<u32>()]);

impl Key {
    /// The key of these bytes, if they are one.
    pub fn new(bytes: [u8; KEY_BYTES]) -> Option<Self> {
        let mut words = [0; _];
        words.iter_mut().zip(bytes.as_chunks().0).for_each(|(word, bytes)| *word = u32::from_le_bytes(*bytes));
        Self::of_words(words)
    }

    fn of_words(words: [u32; KEY_BYTES / size_of::<u32>()]) -> Option<Self> {
        (words != [0; _]).then_some(Self(words))
    }

    /// The signature of a frame that ends with link and stamp.
    fn sign(&self, frame: &[u8]) -> [u8; SIGNATURE_BYTES] {
        let mut bytes = [0; KEY_BYTES + FRAME_MAX_BYTES];
        let (key, rest) = bytes.split_at_mut(KEY_BYTES);
        key.as_chunks_mut().0.iter_mut().zip(self.0).for_each(|(bytes, word)| *bytes = word.to_le_bytes());
        rest.iter_mut().zip(frame).for_each(|(place, byte)| *place = *byte);
        let digest = Sha256::digest(bytes.get(..KEY_BYTES + frame.len()).unwrap_or(&bytes));
        let mut value = [0; SIGNATURE_BYTES];
        value.iter_mut().zip(digest).for_each(|(value, byte)| *value = byte);
        value
    }
}

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Key")
    }
}

worded! {
    /// Why a frame does not count.
    pub enum Refusal {
        /// It has no signature.
        Unsigned = "Refused: not signed",
        /// It was signed with another key, or changed on its way.
        Forged = "Refused: signed with another key",
        /// Its stamp is not above the last of its stream, or of the vehicle.
        Replayed = "Refused: its time stamp was used before",
        /// Its stamp is too far ahead: its sender's clock is wrong.
        Ahead = "Refused: its time stamp is too far ahead",
        /// There was a key, and it cannot be read any more.
        KeyLost = "Refused: signing key lost; set it over USB",
    }
}

/// A stream that was received.
#[derive(Clone, Copy)]
struct Stream {
    /// Link, system, component.
    id: [u8; 3],
    /// Its newest stamp; 0 for a free place.
    newest: Stamp,
}

struct State {
    key: Option<Key>,
    /// The clock: this stamp, at this time, us.
    newest: Stamp,
    since: u64,
    /// Whether a sender's clock was received since the start.
    is_set: bool,
    streams: [Stream; STREAMS_KNOWN],
    floor: Stamp,
    /// The floor after a boot, as flash has it.
    kept: Stamp,
    /// Whether flash has another key.
    changed: bool,
    /// Whether there was a key in flash that cannot be read any more.
    is_lost: bool,
}

impl State {
    const fn new() -> Self {
        let streams = [Stream { id: [0; 3], newest: 0 }; STREAMS_KNOWN];
        let (key, is_set, changed, is_lost) = (None, false, false, false);
        Self { key, newest: 0, since: 0, is_set, streams, floor: 0, kept: 0, changed, is_lost }
    }

    #[inline(never)]
    fn clock(&self, now: u64) -> Stamp {
        self.newest.saturating_add(now.saturating_sub(self.since) / 10)
    }

    /// Moves the clock on to `stamp`, if that is ahead of it.
    fn follow(&mut self, stamp: Stamp, now: u64) {
        if stamp > self.clock(now) {
            (self.newest, self.since) = (stamp, now);
        }
    }

    /// Takes a stamp that is new; it is not any more afterwards.
    fn admit(&mut self, id: [u8; 3], stamp: Stamp, now: u64) -> Result<(), Refusal> {
        let clock = self.clock(now);
        if stamp >= STAMP_MAX || self.is_set && stamp > clock.saturating_add(LEAP_MAX) {
            return Err(Refusal::Ahead);
        }
        let is_known = |stream: &&mut Stream| stream.id == id && stream.newest > 0;
        if let Some(stream) = self.streams.iter_mut().find(is_known) {
            if stamp <= stream.newest {
                return Err(Refusal::Replayed);
            }
            stream.newest = stamp;
        } else {
            if stamp <= self.floor || stamp.saturating_add(STAMPS_PER_MINUTE) < clock {
                return Err(Refusal::Replayed);
            }
            // A free place, or that of the stream that is furthest behind.
            if let Some(stream) = self.streams.iter_mut().min_by_key(|stream| stream.newest) {
                self.floor = self.floor.max(stream.newest);
                *stream = Stream { id, newest: stamp };
            }
        }
        self.is_set = true;
        self.follow(stamp, now);
        Ok(())
    }
}

/// The key, and the stamps received under it.
pub struct Signing<M: RawMutex>(Mutex<M, RefCell<State>>);

impl<M: RawMutex> Signing<M> {
    /// No key.
    pub const fn new() -> Self {
        Self(Mutex::new(RefCell::new(State::new())))
    }

    /// The mutex lets one in at a time, so the state is never borrowed.
    fn with<T>(&self, act: impl FnOnce(&mut State) -> T) -> Option<T> {
        self.0.lock(|state| state.try_borrow_mut().ok().map(|mut state| act(&mut state)))
    }

    /// The key, if there is one.
    pub fn key(&self) -> Option<Key> {
        self.with(|state| state.key).flatten()
    }

    /// Takes a key, or none any more, and a stamp below which nothing was signed with it yet; one that is too late is
    /// none. Stamps received under the same key before stay used.
    pub fn set(&self, key: Option<Key>, stamp: Stamp, now: u64) {
        let stamp = if stamp < STAMP_MAX { stamp } else { 0 };
        self.with(|state| {
            if state.key != key || state.is_lost {
                *state = State { key, floor: stamp, changed: true, ..State::new() };
            }
            state.follow(stamp, now);
        });
    }

    /// Whether a frame counts; where it need not be signed, one that is not does.
    pub fn judge(&self, frame: &Frame<'_>, must_be_signed: bool) -> Result<(), Refusal> {
        let Some(key) = self.key() else {
            return if must_be_signed && self.is_lost() { Err(Refusal::KeyLost) } else { Ok(()) };
        };
        let Some((signed, [link, stamp @ ..], value)) = parts(frame) else {
            return if must_be_signed { Err(Refusal::Unsigned) } else { Ok(()) };
        };
        // In the same time wherever they differ.
        if key.sign(signed).iter().zip(value).fold(0, |all, (a, b)| all | (a ^ b)) != 0 {
            return Err(Refusal::Forged);
        }
        let id = [link, frame.header.system, frame.header.component];
        self.with(|state| state.admit(id, number(stamp), frame.time)).unwrap_or(Err(Refusal::Replayed))
    }

    /// Whether what cannot be signed is kept out, where everything must be: there is a key, or it is lost.
    pub fn keeps_out_unsigned(&self, must_be_signed: bool) -> bool {
        must_be_signed && (self.key().is_some() || self.is_lost())
    }

    /// Signs a frame that goes out now, us, if there is a key.
    pub fn sign(&self, frame: &mut MAVLinkV2MessageRaw, now: u64) {
        let next = |state: &mut State| {
            let stamp = state.clock(now).max(state.newest.saturating_add(1));
            (state.newest, state.since) = (stamp, now);
            state.key.map(|key| (key, stamp))
        };
        let Some((key, stamp)) = self.with(next).flatten() else { return };
        let (end, extra) = (frame.raw_bytes().len(), MavMessage::extra_crc(frame.message_id()));
        *frame.incompatibility_flags_mut() |= SIGNED_FLAG;
        if let Some((checked, tail)) = frame.as_mut_slice().split_at_mut_checked(end - CHECKSUM_BYTES)
            && let Some((tail, _)) = tail.split_first_chunk_mut()
        {
            let [low, high] = calculate_crc(&checked[1..], extra).to_le_bytes();
            let [a, b, c, d, e, f, ..] = stamp.to_le_bytes();
            *tail = [low, high, OWN_LINK, a, b, c, d, e, f];
        }
        let (signed, value) = frame.as_mut_slice().split_at_mut(end + LINK_AND_STAMP_BYTES);
        if let Some((value, _)) = value.split_first_chunk_mut() {
            *value = key.sign(signed);
        }
    }

    /// Moves the clock on to the stamp of a trusted frame.
    pub fn follow(&self, frame: &Frame<'_>, now: u64) {
        if let Some((_, [_, stamp @ ..], _)) = parts(frame) {
            self.with(|state| state.follow(number(stamp), now));
        }
    }

    /// What is to be written to flash at `now`, us, if it is not up to date there, or `is_endangered`.
    pub fn unkept(&self, now: u64, is_endangered: bool) -> Option<[u32; KEPT_WORDS]> {
        self.with(|state| {
            let clock = state.clock(now);
            let does = clock.saturating_add(KEPT_AHEAD_MIN) <= state.kept || state.key.is_none();
            if does && !state.changed && !is_endangered {
                return None;
            }
            (state.kept, state.changed) = (clock.saturating_add(KEPT_AHEAD), false);
            let [a, b, c, d, e, f, g, h] = state.key.map_or([0; _], |key| key.0);
            Some([a, b, c, d, e, f, g, h, state.kept as u32, (state.kept >> u32::BITS) as u32])
        })
        .flatten()
    }

    /// Takes what was in flash at boot: nothing that was accepted before is accepted again.
    pub fn restore(&self, words: &[u32; KEPT_WORDS]) {
        let [key @ .., low, high] = *words;
        let (key, kept) = (Key::of_words(key), Stamp::from(high) << u32::BITS | Stamp::from(low));
        self.with(|state| *state = State { key, newest: kept, floor: kept, kept, ..State::new() });
    }

    /// There was a key in flash at boot, and it cannot be read: until another is set, or none any more, no frame counts
    /// that would have to be signed.
    pub fn lose(&self) {
        self.with(|state| state.is_lost = true);
    }

    /// Whether that is so.
    pub fn is_lost(&self) -> bool {
        self.with(|state| state.is_lost).unwrap_or(true)
    }
}

impl<M: RawMutex> Default for Signing<M> {
    fn default() -> Self {
        Self::new()
    }
}

/// A stamp as frames have it.
fn number([a, b, c, d, e, f]: [u8; 6]) -> Stamp {
    Stamp::from_le_bytes([a, b, c, d, e, f, 0, 0])
}

/// A signed frame's parts: what is signed, link and stamp at its end, the signature.
fn parts<'a>(frame: &Frame<'a>) -> Option<(&'a [u8], [u8; LINK_AND_STAMP_BYTES], [u8; SIGNATURE_BYTES])> {
    if frame.version == Version::V1 || frame.bytes.get(2)? & SIGNED_FLAG == 0 {
        return None;
    }
    let (signed, value) = frame.bytes.split_last_chunk()?;
    Some((signed, *signed.last_chunk()?, *value))
}
