//! Where the flight recorder's memory is: a part of the memory map of its own, which no start clears.

use crate::recorder::ring::Slot;
use core::cell::UnsafeCell;
use core::slice;
use core::sync::atomic::{AtomicBool, Ordering};

unsafe extern "C" {
    /// The first byte of the part, and the first behind it: firmware/memory/ sets both.
    static _recorder_start: UnsafeCell<[u8; 0]>;
    static _recorder_end: UnsafeCell<[u8; 0]>;
}

/// The memory, once, as the last start left it; or cleared, where it has been without power and holds nothing that may
/// be read.
#[must_use]
pub fn take(cleared: bool) -> Option<&'static mut [Slot]> {
    static TAKEN: AtomicBool = AtomicBool::new(false);
    // Boot is one thread: nothing comes in between.
    if TAKEN.load(Ordering::Relaxed) {
        return None;
    }
    TAKEN.store(true, Ordering::Relaxed);
    let (start, end) = (&raw const _recorder_start, &raw const _recorder_end);
    let bytes = end.addr().saturating_sub(start.addr());
    let memory = UnsafeCell::raw_get(start).cast::<u8>();
    if cleared {
        // SAFETY: the linker gives this part of the memory to nothing else, and nothing refers to it yet.
        unsafe { memory.write_bytes(0, bytes) };
    }
    // SAFETY: as above, taken once; any bytes are slots, whose alignment is one.
    Some(unsafe { slice::from_raw_parts_mut(memory.cast::<Slot>(), bytes / size_of::<Slot>()) })
}
