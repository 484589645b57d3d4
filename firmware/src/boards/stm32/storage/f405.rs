//! The F405's flash: one bank, programmed by words of four bytes.

use crate::hardware::Fault;
use embassy_stm32::pac::FLASH;
use embassy_stm32::pac::flash::vals::Psize;

/// Where the two sectors start: the tenth and eleventh, counted from 0.
pub const FIRST_ADDRESS: usize = 0x080C_0000;
const FIRST_SECTOR: u8 = 10;

/// Looks at a flash at work, at most: each takes 6 cycles or more of a core at 168 MHz, so seven seconds together at
/// the least. An erase takes up to two, and stalls most of them.
pub const POLLS_MAX: u32 = 200_000_000;

/// The error flags of the status register; writing them clears them.
const FAILURE_FLAGS: u32 = 0b1111_0010;

/// Forgets what failed before, and opens the control register with its two keys.
pub fn open(keys: [u32; 2]) {
    FLASH.sr().write(|w| w.0 = FAILURE_FLAGS);
    // A second key would close it until the next reset.
    if FLASH.cr().read().lock() {
        keys.iter().for_each(|key| FLASH.keyr().write_value(*key));
    }
}

/// From now on, what is written to a blank word stays there.
pub fn program() {
    FLASH.cr().write(|w| {
        w.set_pg(true);
        w.set_psize(Psize::PSIZE32);
    });
}

/// Begins to erase a sector of the two, by words like programming: that needs the 2.7 V that the boards exceed.
pub fn erase(sector: u8) {
    FLASH.cr().write(|w| {
        w.set_ser(true);
        w.set_snb(FIRST_SECTOR + sector);
        w.set_psize(Psize::PSIZE32);
    });
    FLASH.cr().modify(|w| w.set_strt(true));
}

/// Whether it is at work.
pub fn is_busy() -> bool {
    FLASH.sr().read().bsy()
}

/// Whether it reports an error.
pub fn has_failed() -> bool {
    FLASH.sr().read().0 & FAILURE_FLAGS != 0
}

/// Closes the control register, and empties the data cache, which an erase leaves as it was. It may only be emptied
/// while it is off.
pub fn close() {
    FLASH.cr().write(|w| w.set_lock(true));
    let control = FLASH.acr();
    control.modify(|w| w.set_dcen(false));
    control.modify(|w| w.set_dcrst(true));
    control.modify(|w| w.set_dcrst(false));
    control.modify(|w| w.set_dcen(true));
}

/// Reading takes no care: what is torn has the wrong checksum and no other effect.
pub fn read(words: impl FnOnce()) -> Result<(), Fault> {
    words();
    Ok(())
}
