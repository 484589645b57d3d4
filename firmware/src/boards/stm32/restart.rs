//! Why the chip started, the first thing to read after something went wrong; and starting it anew.

use super::bootloader;
use crate::hardware::Restart;

/// What made the chip start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, defmt::Format)]
pub enum Cause {
    /// Power came, or fell below what the chip needs.
    Power,
    /// The reset pin: a button or a debug probe.
    Pin,
    /// The firmware itself, after a panic or a fault.
    Software,
    /// The watchdog: the control task did not come back.
    Watchdog,
    /// None of these.
    Unknown,
}

/// The chip, which can start itself anew.
pub struct Chip;

/// The motors have been told to stop, a hundred times a second, since the vehicle was disarmed.
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

/// Reads the flags and clears them, so that the next start tells its own.
#[must_use]
pub fn cause() -> Cause {
    let cause = flags();
    #[cfg(feature = "micoair-h743")]
    embassy_stm32::pac::RCC.rsr().modify(|w| w.set_rmvf(true));
    #[cfg(feature = "crazyflie-bolt")]
    embassy_stm32::pac::RCC.csr().modify(|w| w.set_rmvf(true));
    cause
}

/// Reads the flags.
#[cfg(feature = "micoair-h743")]
pub(super) fn flags() -> Cause {
    let flags = embassy_stm32::pac::RCC.rsr().read();
    first(flags.iwdg1rstf(), flags.sftrstf(), flags.porrstf() || flags.borrstf(), flags.pinrstf())
}

/// Reads the flags.
#[cfg(feature = "crazyflie-bolt")]
pub(super) fn flags() -> Cause {
    let flags = embassy_stm32::pac::RCC.csr().read();
    first(flags.wdgrstf(), flags.sftrstf(), flags.porrstf() || flags.borrstf(), flags.padrstf())
}

/// Every restart also pulls the reset pin, and power raises more flags still: the most telling one counts.
fn first(watchdog: bool, software: bool, power: bool, pin: bool) -> Cause {
    match (power, watchdog, software, pin) {
        (true, ..) => Cause::Power,
        (_, true, ..) => Cause::Watchdog,
        (_, _, true, _) => Cause::Software,
        (.., true) => Cause::Pin,
        _ => Cause::Unknown,
    }
}
