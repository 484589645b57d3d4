//! The chip's own bootloader, which takes an image over USB (DFU): requested before a restart, entered right after it.
//!
//! It has to begin as after a reset: clocks as they come up, no peripheral at work, the watchdog, which nothing but a
//! reset stops, not started. So the wish is kept in memory that no start clears, behind the flight recorder's, and
//! looked at first of all.

use super::chip::{self, BOOTLOADER_ADDRESS};
use core::cell::UnsafeCell;
use core::sync::atomic::{Ordering, fence};

unsafe extern "C" {
    /// Where the wish is: firmware/memory/ sets it.
    static _bootloader_wish: UnsafeCell<[u64; 4]>;
}

/// The request, written four times: a write to memory that has error-correcting codes may wait in the chip for the next
/// one, and be lost if a reset comes first.
const WISH_WORDS: [u64; 4] = [0x4446_5520_706C_6561; 4];

/// Has the next start enter the bootloader.
pub fn wish() {
    set(WISH_WORDS);
}

/// Enters the bootloader if that was wished for before the restart, which was the firmware's own or not. Before
/// anything is turned on.
pub fn enter_if_wished(is_own_restart: bool) {
    // After another start the memory may have been without power, and hold nothing that may be read.
    let is_wished = is_own_restart && {
        // SAFETY: nothing else uses this part of the memory, it has been written to since power came, and any bits are
        // numbers.
        let wish = unsafe { UnsafeCell::raw_get(&raw const _bootloader_wish).read_volatile() };
        wish.iter().zip(&WISH_WORDS).filter(|(wish, expected)| wish == expected).count() >= WISH_WORDS.len() - 1
    };
    set([0; 4]);
    if is_wished {
        enter();
    }
}

fn set(value: [u64; 4]) {
    // SAFETY: nothing else uses this part of the memory, and one thing at a time sets it.
    unsafe { UnsafeCell::raw_get(&raw const _bootloader_wish).write_volatile(value) };
    fence(Ordering::SeqCst);
    cortex_m::asm::dsb();
}

fn enter() -> ! {
    chip::map_bootloader();
    // SAFETY: one register, nothing else runs; the address is that of ST's bootloader in this chip's system memory,
    // where a valid vector table is (application note AN2606), and nothing of this firmware is in use any more.
    unsafe {
        (*cortex_m::peripheral::SCB::PTR).vtor.write(BOOTLOADER_ADDRESS);
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
        cortex_m::asm::bootload(BOOTLOADER_ADDRESS as *const u32)
    }
}
