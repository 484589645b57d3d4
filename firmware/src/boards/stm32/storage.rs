//! Where parameters live: the last two sectors of the flash, 128 KB each, as an `embedded-storage-async` flash of its own.
//!
//! Addresses start at zero here, and nothing outside the two sectors can be reached. Work on the flash blocks its task. On
//! the F405 it also stalls the core, up to two seconds for an erase, because code runs from the same flash: the watchdog is
//! given patience meanwhile, no control tick happens, and the clock, which counts overflows, falls behind. So nothing may be
//! saved unless disarmed. The H743 erases its second bank while code runs from the first.

use super::watchdog::Patience;
use embassy_stm32::Peri;
use embassy_stm32::flash::{Blocking, Error, FLASH_SIZE, Flash, MAX_ERASE_SIZE, WRITE_SIZE};
use embassy_stm32::pac::iwdg::Iwdg;
use embassy_stm32::peripherals::FLASH;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

/// Bytes of the two sectors.
pub const SIZE: u32 = 2 * MAX_ERASE_SIZE as u32;

/// Where they start, from the start of the flash.
const START: u32 = FLASH_SIZE as u32 - SIZE;

/// The two sectors.
pub struct ParameterFlash {
    flash: Flash<'static, Blocking>,
    watchdog: Iwdg,
}

impl ParameterFlash {
    /// `watchdog` is the one that must be patient while the flash is at work.
    pub fn new(flash: Peri<'static, FLASH>, watchdog: Iwdg) -> Self {
        Self { flash: Flash::new_blocking(flash), watchdog }
    }
}

/// Where `length` bytes from `offset` on lie in the whole flash.
fn place(offset: u32, length: usize) -> Result<u32, Error> {
    let inside = usize::try_from(SIZE.saturating_sub(offset)).is_ok_and(|left| length <= left);
    if inside { Ok(START + offset) } else { Err(Error::Size) }
}

/// Empties the flash's data cache, which an erase leaves as it was. It may only be emptied while it is off.
#[cfg(feature = "crazyflie-bolt")]
fn forget_cached() {
    let control = embassy_stm32::pac::FLASH.acr();
    control.modify(|w| w.set_dcen(false));
    control.modify(|w| w.set_dcrst(true));
    control.modify(|w| w.set_dcrst(false));
    control.modify(|w| w.set_dcen(true));
}

/// The core's data cache is off: nothing is held.
#[cfg(feature = "micoair-h743")]
fn forget_cached() {}

impl ErrorType for ParameterFlash {
    type Error = Error;
}

impl ReadNorFlash for ParameterFlash {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Error> {
        self.flash.blocking_read(place(offset, bytes.len())?, bytes)
    }

    fn capacity(&self) -> usize {
        SIZE as usize
    }
}

impl NorFlash for ParameterFlash {
    const WRITE_SIZE: usize = WRITE_SIZE;
    const ERASE_SIZE: usize = MAX_ERASE_SIZE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Error> {
        let length = to.checked_sub(from).ok_or(Error::Size)?;
        let start = place(from, length as usize)?;
        let _patience = Patience::new(self.watchdog);
        let erased = self.flash.blocking_erase(start, start + length);
        forget_cached();
        erased
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Error> {
        self.flash.blocking_write(place(offset, bytes.len())?, bytes)
    }
}
