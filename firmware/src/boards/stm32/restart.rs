//! Starting the chip anew.
//!
//! A bootloader may look at a line that somebody else drives, and start something else where it finds it low. So the
//! chip restarts once that line has rested high for [`RESTING_POLLS`], or after [`POLLS_MAX`] all the same.

use super::bootloader;
use crate::boards::chosen::BOOT_LINE;
use crate::hardware::Restart;

/// Looks at the line in a row that find it high: more than 70 us, seven bytes of the Bolt's.
const RESTING_POLLS: usize = 4_000;

/// Looks at the line: some milliseconds.
const POLLS_MAX: usize = 10 * RESTING_POLLS;

/// The chip, which can start itself anew.
pub struct Chip;

/// The motors have got the stop command, every millisecond, since the vehicle was disarmed.
impl Restart for Chip {
    const HAS_BOOTLOADER: bool = true;

    fn restart(&mut self) {
        restart();
    }

    fn start_bootloader(&mut self) {
        bootloader::wish();
        restart();
    }
}

/// Restarts the chip, at a moment when its bootloader starts the firmware.
pub fn restart() -> ! {
    if let Some((port, number)) = BOOT_LINE {
        let mut resting = 0;
        let _ = (0..POLLS_MAX).find(|_| {
            let is_high = port.idr().read().0 >> number & 1 == 1;
            resting = if is_high { resting + 1 } else { 0 };
            resting == RESTING_POLLS
        });
    }
    cortex_m::peripheral::SCB::sys_reset()
}
