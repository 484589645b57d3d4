//! Where last words lie: memory that no start clears, behind the flight recorder's.

use crate::last_words::{LastWords, MEMORY_BYTES};
use core::cell::UnsafeCell;
use core::sync::atomic::{Ordering, fence};

/// Words of the memory's error-correcting code. The last is nothing: a write may wait in the chip for the next one, and
/// be lost if a reset comes first.
const KEPT_WORDS: usize = MEMORY_BYTES / 8 + 1;

unsafe extern "C" {
    /// firmware/memory/ sets it.
    static _last_words: UnsafeCell<[u64; KEPT_WORDS]>;
}

/// Keeps words for the next start.
pub fn keep(words: &LastWords) {
    set(&words.to_bytes());
}

/// What the last start kept, taken away; none where the memory `is_blank`, as it has been without power and holds
/// nothing that may be read.
#[must_use]
pub fn take(is_blank: bool) -> Option<LastWords> {
    let mut bytes = [0; MEMORY_BYTES];
    if !is_blank {
        for (word, part) in memory().zip(bytes.as_chunks_mut().0) {
            // SAFETY: this part of the memory belongs to this function, has been written to since power came, and any
            // bits are numbers.
            *part = unsafe { word.read_volatile() }.to_le_bytes();
        }
    }
    set(&[0; MEMORY_BYTES]);
    LastWords::from_bytes(&bytes)
}

fn set(bytes: &[u8; MEMORY_BYTES]) {
    for (word, part) in memory().zip(bytes.as_chunks().0.iter().chain([&[0; 8]])) {
        // SAFETY: this part of the memory belongs to this module, and one thing at a time sets it.
        unsafe { word.write_volatile(u64::from_le_bytes(*part)) };
    }
    fence(Ordering::SeqCst);
    cortex_m::asm::dsb();
}

fn memory() -> impl Iterator<Item = *mut u64> {
    let first = UnsafeCell::raw_get(&raw const _last_words).cast::<u64>();
    (0..KEPT_WORDS).map(move |index| first.wrapping_add(index))
}
