//! A recording as a file of ULog, the format of PX4's logs (version 1), made up as it is read.
//!
//! ```text
//! file    = "ULog" 01 12 35 01, time of the first record | flags | information... | format | subscription | data...
//! message = length of what follows, 2 bytes | kind, 1 byte | ...
//! data    = message of kind D: number of the subscription, 2 bytes | record
//! ```
//!
//! Everything before the data is of constant length and every record is as long as the next, so any part of the file
//! can be read without the rest.

use super::ring::Ring;
use super::tick;

/// The first bytes of every file, with the format's version.
const FILE_MAGIC: [u8; 8] = [b'U', b'L', b'o', b'g', 0x01, 0x12, 0x35, 0x01];

/// Kind B: nothing that a reader must know about, nothing appended.
const FLAGS_MESSAGE: [u8; 43] = {
    let mut message = [0; 43];
    message[0] = 40;
    message[2] = b'B';
    message
};

/// The file's metadata, by ULog's keys.
const INFORMATION: [Information; 4] = [
    Information::new("char[25] sys_name", "saturated hybrid feedback"),
    Information::new("char[5] ver_sw", env!("CARGO_PKG_VERSION")),
    Information::new("char[34] frames", "world z up, body x forward, y left"),
    Information::new(
        "char[132] modes",
        "0 boot, 1 checks, 2 ready, 3 motor test, 4 idling, 5 taking off, 6 flying, 7 holding, 8 landing, 9 descending, \
         10 stopped, 11 locked",
    ),
];

/// What the vehicle is called takes so many bytes, spaces at its end: files are as long whatever it is called.
const VEHICLE_NAME_BYTES: usize = 32;
const VEHICLE_KEY: &str = "char[32] vehicle";
const VEHICLE_HEAD: [u8; 4] = Information::head(VEHICLE_KEY, VEHICLE_NAME_BYTES);
const SPACES: [u8; VEHICLE_NAME_BYTES] = [b' '; VEHICLE_NAME_BYTES];

/// Kind I: a key, with its type, and a text.
struct Information {
    head: [u8; 4],
    key: &'static str,
    text: &'static str,
}

impl Information {
    const fn new(key: &'static str, text: &'static str) -> Self {
        Self { head: Self::head(key, text.len()), key, text }
    }

    const fn head(key: &str, length: usize) -> [u8; 4] {
        let [low, high, kind] = head(b'I', 1 + key.len() + length);
        [low, high, kind, key.len() as u8]
    }
}

/// The head of a message of this kind and length.
pub const fn head(kind: u8, length: usize) -> [u8; 3] {
    let [low, high] = (length as u16).to_le_bytes();
    [low, high, kind]
}

/// The head of the message that defines a record.
const FORMAT_HEAD: [u8; 3] = head(b'F', tick::FORMAT.len());

/// Kind A: records are subscription 0, the first of their name.
const SUBSCRIPTION_HEAD: [u8; 6] = {
    let [low, high, kind] = head(b'A', 7);
    [low, high, kind, 0, 0, 0]
};
const NAME: &str = "tick";

/// What stands before each record.
pub const DATA_HEAD: [u8; 5] = {
    let [low, high, kind] = head(b'D', 2 + tick::TICK_BYTES);
    [low, high, kind, 0, 0]
};

/// Bytes of a record in the file.
const RECORD_BYTES: usize = DATA_HEAD.len() + tick::TICK_BYTES;

/// Bytes of the time of a record, which is what it begins with.
pub const TIME_BYTES: usize = 8;

/// The parts of the file up to the format, where the first record was of `time`, and the `vehicle` is called so.
pub fn definitions<'a>(time: &'a [u8], vehicle: &'a str) -> impl Iterator<Item = &'a [u8]> {
    let name = vehicle.as_bytes().get(..VEHICLE_NAME_BYTES).unwrap_or(vehicle.as_bytes());
    let spaces = SPACES.get(name.len()..).unwrap_or_default();
    let called = [&VEHICLE_HEAD[..], VEHICLE_KEY.as_bytes(), name, spaces];
    let information = INFORMATION
        .iter()
        .flat_map(|information| [&information.head[..], information.key.as_bytes(), information.text.as_bytes()]);
    let format = [&FORMAT_HEAD[..], tick::FORMAT.as_bytes()];
    [&FILE_MAGIC[..], time, &FLAGS_MESSAGE].into_iter().chain(information).chain(called).chain(format)
}

/// The message after which data may come.
pub const SUBSCRIPTION_PARTS: [&[u8]; 2] = [&SUBSCRIPTION_HEAD, NAME.as_bytes()];

/// Bytes of [`definitions`].
pub fn definitions_size() -> usize {
    definitions(&[0; TIME_BYTES], "").map(<[u8]>::len).sum()
}

/// Bytes before the data.
fn beginning_size() -> usize {
    definitions_size() + SUBSCRIPTION_HEAD.len() + NAME.len()
}

/// Bytes of a file of so many records.
pub fn size(records: usize) -> u32 {
    u32::try_from(beginning_size() + records * RECORD_BYTES).unwrap_or(u32::MAX)
}

/// Reads the file of a `vehicle` from `offset` on into `out`; how many bytes there were.
pub fn read(ring: &Ring<'_>, vehicle: &str, offset: usize, out: &mut [u8]) -> usize {
    let time = ring.get(0).and_then(|record| record.first_chunk::<TIME_BYTES>()).copied().unwrap_or_default();
    let from_data =
        |index| (index..ring.len()).filter_map(|index| ring.get(index)).flat_map(|record| [&DATA_HEAD[..], record]);
    match offset.checked_sub(beginning_size()) {
        Some(offset) => copy(from_data(offset / RECORD_BYTES), offset % RECORD_BYTES, out),
        None => copy(definitions(&time, vehicle).chain(SUBSCRIPTION_PARTS).chain(from_data(0)), offset, out),
    }
}

/// Copies what `parts` hold beyond their first `skipped` bytes; how many bytes there were.
pub fn copy<'a>(parts: impl Iterator<Item = &'a [u8]>, mut skipped: usize, out: &mut [u8]) -> usize {
    let mut count = 0;
    for part in parts {
        let wanted = part.get(skipped..).unwrap_or_default();
        skipped = skipped.saturating_sub(part.len());
        let Some(free) = out.get_mut(count..).filter(|free| !free.is_empty()) else { break };
        free.iter_mut().zip(wanted).for_each(|(to, from)| *to = *from);
        count += free.len().min(wanted.len());
    }
    count
}

#[cfg(test)]
mod tests;
