//! Where parameters live: the last two sectors of the flash, 128 KB each.
//!
//! Nothing outside the two sectors can be reached. Work on the flash blocks its task. On the F405 it also stalls the
//! core, up to two seconds for an erase, because code runs from the same flash: the watchdog is given patience
//! meanwhile, no control tick happens, and the [clock](super::clock) stands still. So nothing may be saved unless
//! disarmed. The H743 erases its second bank while code runs from the first.
//!
//! The registers are driven here and not by Embassy: its driver waits for the flash without end, and on the H743 leaves
//! the flags standing that a record torn by a power cut raises, after which nothing could be written. Each chip's part
//! adds its own: addresses, registers, and how a record that may be torn is read.

use super::chip::WATCHDOG;
use super::watchdog::Patience;
use crate::hardware::{Fault, Flash, Record};
use core::ptr;
use embassy_stm32::Peri;
use embassy_stm32::peripherals::FLASH;

#[cfg(feature = "stm32f405")]
#[path = "storage/f405.rs"]
mod chip;
#[cfg(feature = "stm32h743")]
#[path = "storage/h743.rs"]
mod chip;

const SECTOR_BYTES: usize = 128 * 1024;

/// What opens the control register.
const UNLOCK_KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];

/// The two sectors.
pub struct ParameterFlash {
    /// No other code erases or programs.
    _flash: Peri<'static, FLASH>,
}

impl ParameterFlash {
    /// The last two sectors of this flash.
    pub fn new(flash: Peri<'static, FLASH>) -> Self {
        Self { _flash: flash }
    }
}

/// The first word of a place.
fn words(place: usize) -> Result<*mut u32, Fault> {
    let inside = place < 2 * ParameterFlash::RECORDS_PER_SECTOR;
    if inside { Ok((chip::FIRST_ADDRESS + place * size_of::<Record>()) as *mut u32) } else { Err(Fault) }
}

/// Waits for the flash, and checks its error flags. Counts instead of reading the clock, which may stand still.
fn done() -> Result<(), Fault> {
    let is_done = (0..chip::POLLS_MAX).any(|_| !chip::is_busy());
    if is_done && !chip::has_failed() { Ok(()) } else { Err(Fault) }
}

/// Does `work` on the opened flash, and closes it again.
fn opened(work: impl FnOnce() -> Result<(), Fault>) -> Result<(), Fault> {
    chip::open(UNLOCK_KEYS);
    let worked = work();
    chip::close();
    worked
}

impl Flash for ParameterFlash {
    const RECORDS_PER_SECTOR: usize = SECTOR_BYTES / size_of::<Record>();

    fn read(&mut self, place: usize) -> Result<Record, Fault> {
        let mut word = words(place)?;
        let mut record = [0; _];
        chip::read(|| {
            for copy in &mut record {
                // SAFETY: an aligned word of the two sectors, which hold plain numbers.
                (*copy, word) = unsafe { (ptr::read_volatile(word), word.add(1)) };
            }
        })?;
        Ok(record)
    }

    fn write(&mut self, place: usize, record: &Record) -> Result<(), Fault> {
        let mut word = words(place)?;
        opened(|| {
            chip::program();
            for value in record {
                // SAFETY: an aligned word of the two sectors, in which no code and no other data are.
                word = unsafe {
                    ptr::write_volatile(word, *value);
                    word.add(1)
                };
                done()?;
            }
            Ok(())
        })
    }

    fn erase(&mut self, sector: usize) -> Result<(), Fault> {
        words(sector * Self::RECORDS_PER_SECTOR)?;
        let _patience = Patience::new(WATCHDOG);
        #[cfg(feature = "stm32f405")]
        let _halted = super::clock::halt();
        opened(|| {
            chip::erase(sector as u8);
            done()
        })
    }
}
