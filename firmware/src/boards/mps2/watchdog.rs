//! The CMSDK watchdog: its first timeout is an interrupt that cannot be masked, which ends the emulation.
//!
//! On a board the watchdog resets the processor and the vehicle falls with its motors stopped; nothing that runs in an
//! emulator is worth going on with after that, and a test must see it.

use super::exit;
use super::lines::CLOCK_HZ;

const LOAD: *mut u32 = 0x4000_8000 as *mut u32;
const CONTROL: *mut u32 = 0x4000_8008 as *mut u32;
const INTERRUPT_CLEAR: *mut u32 = 0x4000_800C as *mut u32;
const INTERRUPT_ENABLE: u32 = 1 << 0;

/// The running watchdog.
pub struct BoardWatchdog(());

impl BoardWatchdog {
    /// Starts it: from now on it wants to be fed every `microseconds` (up to 171 s).
    pub fn start(microseconds: u32) -> Self {
        // SAFETY: these are the watchdog's registers, and only this module touches them.
        unsafe {
            LOAD.write_volatile(microseconds.saturating_mul(CLOCK_HZ / 1_000_000));
            CONTROL.write_volatile(INTERRUPT_ENABLE);
        }
        Self(())
    }
}

impl crate::hardware::Watchdog for BoardWatchdog {
    fn feed(&mut self) {
        // SAFETY: as above; any write starts the count again.
        unsafe { INTERRUPT_CLEAR.write_volatile(1) };
    }
}

#[cortex_m_rt::exception]
unsafe fn NonMaskableInt() -> ! {
    exit::fail("the watchdog was not fed")
}
