//! How deep a call went: paint what is below the stack pointer, call, and look how far the paint is gone.

use core::ptr;
use cortex_m::register::msp;

/// How far down is painted.
pub const PAINTED_BYTES: u32 = 128 * 1024;
const PAINT_WORD: u32 = 0xC0FF_EE15;

/// Bytes of stack that `work` took, below its caller's frame, and what it returned.
#[inline(never)]
pub fn depth<R>(work: impl FnOnce() -> R) -> (u32, R) {
    let top = msp::read() & !3;
    let bottom = top - PAINTED_BYTES;
    for address in (bottom..top).step_by(4) {
        // SAFETY: the board has megabytes of RAM below the stack pointer and nothing lies there: the image's data is at
        // the other end, no heap exists, and no interrupt is enabled.
        unsafe { ptr::write_volatile(address as *mut u32, PAINT_WORD) };
    }
    let result = work();
    // SAFETY: as above; words that calls have left behind are plain memory.
    let untouched =
        (bottom..top).step_by(4).take_while(|a| unsafe { ptr::read_volatile(*a as *const u32) } == PAINT_WORD);
    (PAINTED_BYTES - 4 * untouched.count() as u32, result)
}
