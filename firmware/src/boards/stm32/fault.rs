//! The last thing a board does: stop the motors, then restart.
//!
//! Panics and faults end here. `panic-probe` turns interrupts off and then faults on purpose; the board's HardFault handler,
//! and its handler for interrupts that nobody expects, call [`stop_and_restart`]. Nothing that may be broken is used: no
//! heap, no executor, no DMA, no interrupt, only the motors' timer, whose registers say themselves whether they were ever
//! set up.
//!
//! [`log_callers`] says where it happened, as addresses: `llvm-addr2line -ie <image> <address>` turns them into functions,
//! files and lines. The texts that panics carry, their files' names and the code that formats them are not in the image:
//! 13 KB of flash that would be read once.
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
use core::ptr;
use cortex_m::peripheral::SCB;
use cortex_m_rt::ExceptionFrame;
use embassy_stm32::pac::timer::TimGp16;

/// How much of the stack is searched for callers, words.
const SEARCHED: usize = 256;

/// How many of them are logged.
const CALLERS: usize = 16;

/// Stop frames sent before the restart: controllers may miss some, and want a few in a row.
const FRAMES: usize = 10;

/// Polls after which a period counts as not ending: the timer was never set up. One takes a few cycles of the peripheral bus.
const POLLS: usize = 10_000;

/// Silence before each frame, turns of an empty loop: at least 0.1 ms at one cycle a turn and 400 MHz, at most 0.8 ms at
/// three cycles and 168 MHz.
const SILENCE: u32 = 40_000;

unsafe extern "C" {
    // Of the runtime's linker script: where RAM begins, where the stack does, and the ends of the code.
    static _ram_start: u32;
    static _stack_start: u32;
    static __stext: u32;
    static __etext: u32;
}

/// Logs where a fault happened, and what on the stack could be a return address, innermost first. Some are left over from
/// calls that have returned.
pub fn log_callers(frame: &ExceptionFrame) {
    defmt::error!("fault at {=u32:#010x}, called from {=u32:#010x}", frame.pc(), frame.lr());
    let [ram, stack, code, code_end] =
        [&raw const _ram_start, &raw const _stack_start, &raw const __stext, &raw const __etext]
            .map(|end| end as usize);
    let first = ptr::from_ref(frame) as usize;
    // A stack that ran out of RAM has nothing to read.
    if !(ram..stack).contains(&first) {
        return;
    }
    let words = (first..stack).step_by(size_of::<u32>()).take(SEARCHED);
    // SAFETY: aligned words of RAM, below the end of the stack; nothing else runs.
    let words = words.map(|address| unsafe { ptr::read_volatile(address as *const u32) });
    // Return addresses are odd: they say Thumb.
    let callers = words.filter(|word| word & 1 == 1 && (code..code_end).contains(&(*word as usize)));
    for caller in callers.take(CALLERS) {
        defmt::error!("called from {=u32:#010x}", caller);
    }
}

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
