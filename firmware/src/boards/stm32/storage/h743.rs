//! The H743's flash: two banks, programmed by words of 32 bytes that each have an error-correcting code.
//!
//! A word that power failed on while it was programmed or erased has the wrong code. Reading it raises a bus fault,
//! which would restart the chip at every boot: so records are read with faults masked, and the flash's own flag shows
//! whether to believe them.

use crate::hardware::Fault;
use core::arch::asm;
use cortex_m::peripheral::SCB;
use embassy_stm32::pac::FLASH;
use embassy_stm32::pac::flash::Bank;
use embassy_stm32::pac::flash::regs::Ccr;

/// Where the two sectors start: the sixth and seventh of the second bank, counted from 0.
pub const FIRST_ADDRESS: usize = 0x081C_0000;
const FIRST_SECTOR: u8 = 6;

/// Looks at a flash at work, at most: each takes 16 cycles or more of a core at 400 MHz, for its barrier and two reads
/// over a bus at half of that, so eight seconds together at the least. An erase takes up to four.
pub const POLLS_MAX: u32 = 200_000_000;

/// The error flags of the status register, and the same bits of the register that clears them.
const FAILURE_FLAGS: u32 = 0x17EE_0000;

/// A core that runs at the priority of a fault takes no notice of bus faults of data (bit BFHFNMIGN).
const IGNORE_BUS_FAULTS: u32 = 1 << 8;

/// The registers of the second bank.
fn bank() -> Bank {
    FLASH.bank(1)
}

/// Forgets what failed before, and opens the bank's control register with its two keys.
pub fn open(keys: [u32; 2]) {
    bank().ccr().write_value(Ccr(FAILURE_FLAGS));
    // A second key would close it until the next reset.
    if bank().cr().read().lock() {
        keys.iter().for_each(|key| bank().keyr().write_value(*key));
    }
}

/// From now on, what is written to a blank word stays there, once the word is full.
pub fn program() {
    bank().cr().write(|w| {
        w.set_pg(true);
        w.set_psize(2); // 32 bits at once
    });
    cortex_m::asm::dsb();
}

/// Begins to erase a sector of the two.
pub fn erase(sector: u8) {
    bank().cr().write(|w| {
        w.set_ser(true);
        w.set_snb(FIRST_SECTOR + sector);
        w.set_psize(2);
    });
    bank().cr().modify(|w| w.set_start(true));
}

/// Whether it is at work.
pub fn is_busy() -> bool {
    cortex_m::asm::dsb();
    let status = bank().sr().read();
    status.bsy() || status.qw()
}

/// Whether it reports an error.
pub fn has_failed() -> bool {
    bank().sr().read().0 & FAILURE_FLAGS != 0
}

/// Closes the control register, which keeps what it holds when it closes: emptied first, with it whatever a word
/// lacked.
pub fn close() {
    bank().cr().write(|_| ());
    bank().cr().modify(|w| w.set_lock(true));
}

/// Reads, and whether the value is valid. Nothing but a non-maskable interrupt comes between.
pub fn read(words: impl FnOnce()) -> Result<(), Fault> {
    bank().ccr().write_value(Ccr(FAILURE_FLAGS));
    // SAFETY: the only access to this register while nothing else runs, undone below.
    let control = unsafe { &(*SCB::PTR).ccr };
    // SAFETY: masks all faults and interrupts for a few microseconds; the barrier ends the reads before they can count.
    unsafe {
        asm!("cpsid f");
        control.modify(|bits| bits | IGNORE_BUS_FAULTS);
        cortex_m::asm::dsb();
        words();
        cortex_m::asm::dsb();
        control.modify(|bits| bits & !IGNORE_BUS_FAULTS);
        cortex_m::asm::dsb();
        asm!("cpsie f");
    }
    let torn = bank().sr().read().dbeccerr();
    bank().ccr().write_value(Ccr(FAILURE_FLAGS));
    if torn { Err(Fault) } else { Ok(()) }
}
