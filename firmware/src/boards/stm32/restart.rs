//! Why the chip started, the first thing to read after something went wrong; and starting it anew.

use super::bootloader;
use crate::hardware::Restart;

/// What made the chip start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, defmt::Format)]
pub enum Cause {
    /// Power came.
    Power,
    /// Power fell below the brown-out level, and came back.
    BrownOut,
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

/// The motors have got the stop command, a hundred times a second, since the vehicle was disarmed.
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

impl Cause {
    /// Whether the memory has been without power, or may have been.
    #[must_use]
    pub fn is_power(self) -> bool {
        matches!(self, Self::Power | Self::BrownOut)
    }

    /// The report where no words were kept.
    #[must_use]
    pub fn words(self) -> Option<&'static str> {
        match self {
            Self::BrownOut => Some("brown-out, supply too low"),
            Self::Watchdog => Some("watchdog, control did not come back"),
            Self::Power | Self::Pin | Self::Software | Self::Unknown => None,
        }
    }
}

/// Whether the chip is not held in reset while its supply is too low for it: an option, which comes off.
#[must_use]
pub fn has_no_brown_out() -> bool {
    #[cfg(feature = "micoair-h743")]
    let is_off = embassy_stm32::pac::FLASH.optsr_cur().read().bor_lev() == 0;
    #[cfg(feature = "crazyflie-bolt")]
    let is_off = embassy_stm32::pac::FLASH.optcr().read().bor_lev() == 0b11;
    is_off
}

/// Reads the flags and clears them, so that the next start reports its own.
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
    first(flags.iwdg1rstf(), flags.sftrstf(), [flags.porrstf(), flags.borrstf()], flags.pinrstf())
}

/// Reads the flags.
#[cfg(feature = "crazyflie-bolt")]
pub(super) fn flags() -> Cause {
    let flags = embassy_stm32::pac::RCC.csr().read();
    first(flags.wdgrstf(), flags.sftrstf(), [flags.porrstf(), flags.borrstf()], flags.padrstf())
}

/// Every restart also pulls the reset pin, and power raises more flags still: the most telling one counts.
fn first(watchdog: bool, software: bool, [power, brown_out]: [bool; 2], pin: bool) -> Cause {
    match (power || brown_out, watchdog, software, pin) {
        (true, ..) if power => Cause::Power,
        (true, ..) => Cause::BrownOut,
        (_, true, ..) => Cause::Watchdog,
        (_, _, true, _) => Cause::Software,
        (.., true) => Cause::Pin,
        _ => Cause::Unknown,
    }
}
