//! Where last words lie: memory that no start clears, behind the flight recorder's.

use crate::last_words::{LastWords, SIZE};
use core::cell::UnsafeCell;
use core::sync::atomic::{Ordering, fence};

/// Whole words of an error-correcting code. The last is nothing: a write may wait in the chip for the next one, and be
/// lost if a reset comes first.
type Memory = [u64; SIZE / 8 + 1];

unsafe extern "C" {
    /// firmware/memory/ sets it.
    static _last_words: UnsafeCell<Memory>;
}

/// Keeps words for the next start.
pub fn keep(words: &LastWords) {
    set(&words.to_bytes());
}

/// What the last start kept, taken away; none where the memory `is_blank`, as it has been without power and holds
/// nothing that may be read.
#[must_use]
pub fn take(is_blank: bool) -> Option<LastWords> {
    let kept = if is_blank {
        None
    } else {
        // SAFETY: this part of the memory is nobody else's, has been written to since power came, and any bits are
        // numbers.
        let memory = unsafe { UnsafeCell::raw_get(&raw const _last_words).read_volatile() };
        let mut bytes = [0; SIZE];
        bytes.iter_mut().zip(memory.iter().flat_map(|word| word.to_le_bytes())).for_each(|(to, from)| *to = from);
        LastWords::from_bytes(&bytes)
    };
    set(&[0; SIZE]);
    kept
}

fn set(bytes: &[u8; SIZE]) {
    let mut memory: Memory = [0; _];
    let (words, _) = bytes.as_chunks();
    memory.iter_mut().zip(words).for_each(|(to, from)| *to = u64::from_le_bytes(*from));
    // SAFETY: this part of the memory is nobody else's, and one thing at a time sets it.
    unsafe { UnsafeCell::raw_get(&raw const _last_words).write_volatile(memory) };
    fence(Ordering::SeqCst);
    cortex_m::asm::dsb();
}
