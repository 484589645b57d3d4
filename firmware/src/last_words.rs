//! Why the vehicle restarted by itself, in words that outlive the reset.
//!
//! ```text
//! panic, fault -> memory that no start clears -> reset -> shared last_words -> STATUSTEXT, card, log
//! ```
//!
//! A board's last acts put them there ([`crate::stop_sequence`]), and its next start takes them away.
//! [`RestartReport`](crate::status::RestartReport) sends them.

use core::fmt::{self, Write};
use core::panic::PanicInfo;
use mavlink::calculate_crc;

const WORDS_MAX_BYTES: usize = 148;

/// Bytes in memory: the words, their length, a checksum. Whole words of any error-correcting code that there is.
pub const MEMORY_BYTES: usize = 160;

/// What the checksum begins with, so that zeros are no words.
const CHECKSUM_SEED: u8 = b'W';

/// The part of a source file's path that is kept: its end.
const PATH_MAX_BYTES: usize = 40;

/// The words; what does not fit is cut off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LastWords {
    bytes: [u8; WORDS_MAX_BYTES],
    length: u8,
}

impl LastWords {
    /// The words of something.
    pub fn new(words: impl fmt::Display) -> Self {
        let mut kept = Self { bytes: [0; WORDS_MAX_BYTES], length: 0 };
        // An error means that it is full.
        let _ = write!(kept, "{words}");
        kept
    }

    /// The words of a panic: its place and message.
    pub fn panic(info: &PanicInfo<'_>) -> Self {
        let (file, line) = info.location().map_or(("", 0), |location| (location.file(), location.line()));
        let file = file.get(file.len().saturating_sub(PATH_MAX_BYTES)..).unwrap_or(file);
        Self::new(format_args!("panic at {file}:{line}: {}", info.message()))
    }

    /// Them.
    pub fn as_str(&self) -> &str {
        self.bytes.get(..self.length.into()).and_then(|bytes| str::from_utf8(bytes).ok()).unwrap_or("")
    }

    /// As they lie in memory.
    pub fn to_bytes(&self) -> [u8; MEMORY_BYTES] {
        let mut memory = [0; MEMORY_BYTES];
        let (bytes, rest) = memory.split_at_mut(WORDS_MAX_BYTES);
        bytes.copy_from_slice(&self.bytes);
        rest.iter_mut().take(1).for_each(|length| *length = self.length);
        if let Some((covered, checksum)) = memory.split_last_chunk_mut::<2>() {
            *checksum = calculate_crc(covered, CHECKSUM_SEED).to_le_bytes();
        }
        memory
    }

    /// Out of memory, where there are any.
    pub fn from_bytes(memory: &[u8; MEMORY_BYTES]) -> Option<Self> {
        let (covered, checksum) = memory.split_last_chunk::<2>()?;
        let (bytes, rest) = covered.split_first_chunk::<WORDS_MAX_BYTES>()?;
        let is_whole = calculate_crc(covered, CHECKSUM_SEED) == u16::from_le_bytes(*checksum);
        is_whole.then_some(Self { bytes: *bytes, length: *rest.first()? })
    }
}

impl Write for LastWords {
    fn write_str(&mut self, words: &str) -> fmt::Result {
        let free = self.bytes.get_mut(self.length.into()..).unwrap_or_default();
        let end = words.floor_char_boundary(free.len());
        if let (Some(to), Some(from)) = (free.get_mut(..end), words.as_bytes().get(..end)) {
            to.copy_from_slice(from);
            self.length += end as u8;
        }
        if end < words.len() { Err(fmt::Error) } else { Ok(()) }
    }
}
