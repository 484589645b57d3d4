//! The last thing a board does: stop the motors, then restart.
//!
//! Panics and faults end here. `panic-probe` logs a panic with interrupts off and then faults on purpose; the board's
//! HardFault handler, and its handler for interrupts that nobody expects, call [`stop_and_restart`]. Nothing that may be
//! broken is used: no heap, no executor, no DMA, no interrupt, only the motors' timer, whose registers say themselves
//! whether they were ever set up.
//!
//! What the controllers see: the frame that was going out is cut and discarded by its checksum; ten stop frames follow
//! within ten milliseconds, and then silence until the firmware runs again and sends stop frames. The stop frame is 16 zero
//! bits, checksum included, so it needs no waveform: sixteen periods at the width of a zero.
//!
//! What this does not reach: a core that cannot run any code (a stack that overflowed into the fault handler, a clock that
//! failed). There the watchdog restarts the chip within 50 ms, once the control task has fed it for the first time, and the
//! controllers stop for want of frames within their own time-out.

use super::motors::rest;
use crate::dshot::{BITS, zero_width};
use crate::hardware::MOTORS;
use cortex_m::peripheral::SCB;
use embassy_stm32::pac::timer::TimGp16;

/// Stop frames sent before the restart: controllers may miss some, and want a few in a row.
const FRAMES: usize = 10;

/// Polls after which a period counts as not ending: the timer was never set up. One takes a few cycles of the peripheral bus.
const POLLS: usize = 10_000;

/// Silence before each frame, turns of an empty loop: at least 0.1 ms at one cycle a turn and 400 MHz, at most 0.8 ms at
/// three cycles and 168 MHz.
const SILENCE: u32 = 40_000;

/// Sends stop frames on all four channels of `timer`, with interrupts off, and restarts the chip.
pub fn stop_and_restart(timer: TimGp16) -> ! {
    cortex_m::interrupt::disable();
    for _ in 0..FRAMES {
        rest(timer);
        cortex_m::asm::delay(SILENCE);
        if stop_frame(timer).is_none() {
            break;
        }
    }
    rest(timer);
    SCB::sys_reset()
}

/// One stop frame by polling; none if the timer does not run.
fn stop_frame(timer: TimGp16) -> Option<()> {
    let width = zero_width(timer.arr().read().arr() + 1);
    widths(timer, width);
    // Widths take effect at an update: the first update begins bit one, the seventeenth ends bit sixteen.
    timer.sr().write(|w| w.0 = 0);
    timer.cr1().modify(|w| w.set_cen(true));
    for _ in 0..BITS {
        period_ends(timer)?;
    }
    widths(timer, 0);
    period_ends(timer)
}

fn widths(timer: TimGp16, width: u16) {
    for channel in 0..MOTORS {
        timer.ccr(channel).write(|w| w.set_ccr(width));
    }
}

fn period_ends(timer: TimGp16) -> Option<()> {
    (0..POLLS).find(|_| timer.sr().read().uif())?;
    timer.sr().write(|w| w.0 = 0);
    Some(())
}
