//! Starting the chip anew, and why it started.

use super::cause::Cause;
use super::{bootloader, chip};
use crate::hardware::Restart;

/// The chip, which can start itself anew.
pub struct Chip;

/// The motors have got the stop command, every millisecond, since the vehicle was disarmed.
impl Restart for Chip {
    const HAS_BOOTLOADER: bool = true;

    fn restart(&mut self) {
        cortex_m::peripheral::SCB::sys_reset();
    }

    fn start_bootloader(&mut self) {
        bootloader::wish();
        cortex_m::peripheral::SCB::sys_reset();
    }
}

/// Reads the flags and clears them, so that the next start reports its own.
pub fn cause() -> Cause {
    let cause = chip::flags();
    chip::clear_flags();
    cause
}
