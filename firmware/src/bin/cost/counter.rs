//! Counts instructions with SysTick, in an emulator whose clock advances by a fixed time for every instruction.
//!
//! `qemu-system-arm -icount shift=6` lets one instruction take 64 ns; the board's SysTick counts at 25 MHz, so one
//! instruction is 1.6 ticks. The counter finds that out by itself, on a loop whose instructions are known, and so
//! serves any shift. A difference of two readings is off by less than a tick, 0.6 instructions.
//!
//! The register holds 24 bits, 10 million instructions. [`Counter::long`] reads the board's timer 1 instead, which
//! counts at the same rate, holds 32 bits, 2.7 thousand million, and stands still when it has run down.

use core::arch::asm;
use core::sync::atomic::{Ordering, compiler_fence};
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

const SYSTICK_RELOAD: u32 = 0x00FF_FFFF;
/// Iterations of the calibration loop, of two instructions each.
const CALIBRATION_LOOPS: u32 = 100_000;

/// Timer 1 (CMSDK APB timer), counting down from the top of its range, once: with nothing to reload it stops at zero.
mod timer {
    const CONTROL: *mut u32 = 0x4000_1000 as *mut u32;
    const VALUE: *mut u32 = 0x4000_1004 as *mut u32;
    const RELOAD: *mut u32 = 0x4000_1008 as *mut u32;
    const ENABLE: u32 = 1 << 0;

    /// Starts it from the top.
    pub fn start() {
        // SAFETY: these are the timer's registers, and only this module touches them.
        unsafe {
            CONTROL.write_volatile(0);
            RELOAD.write_volatile(0);
            VALUE.write_volatile(u32::MAX);
            CONTROL.write_volatile(ENABLE);
        }
    }

    /// Ticks since it was started; none if it has run down.
    pub fn elapsed() -> Option<u32> {
        // SAFETY: as above; reading changes nothing.
        let left = unsafe { VALUE.read_volatile() };
        (left > 0).then_some(u32::MAX - left)
    }
}

/// SysTick, free-running, and what it needs to be read as instructions.
pub struct Counter {
    /// Ticks that an empty window takes.
    overhead: u32,
    ticks_per_instruction: f64,
}

impl Counter {
    /// Starts the counter; none if the same loop does not take the same time twice: then nothing counts instructions.
    pub fn start(mut syst: SYST) -> Option<Self> {
        syst.set_clock_source(SystClkSource::Core);
        syst.set_reload(SYSTICK_RELOAD);
        syst.clear_current();
        syst.enable_counter();
        let mut counter = Self { overhead: 0, ticks_per_instruction: 0.0 };
        counter.overhead = counter.window(|| ()).0;
        let (first, second) = (counter.window(known_loop).0, counter.window(known_loop).0);
        counter.ticks_per_instruction = f64::from(first - counter.overhead) / f64::from(2 * CALIBRATION_LOOPS);
        (first.abs_diff(second) <= 1).then_some(counter)
    }

    /// Ticks of the counter that one instruction takes.
    pub fn ticks_per_instruction(&self) -> f64 {
        self.ticks_per_instruction
    }

    /// Instructions of `work`, fewer than ten million, and what it returned.
    #[inline(always)]
    pub fn short<R>(&self, work: impl FnOnce() -> R) -> (f64, R) {
        let (ticks, result) = self.window(work);
        (f64::from(ticks.saturating_sub(self.overhead)) / self.ticks_per_instruction, result)
    }

    /// Instructions of `work`, none if they are more than 2.7 thousand million, and what it returned.
    pub fn long<R>(&self, work: impl FnOnce() -> R) -> (Option<f64>, R) {
        timer::start();
        let result = work();
        (timer::elapsed().map(|ticks| f64::from(ticks) / self.ticks_per_instruction), result)
    }

    #[inline(always)]
    fn window<R>(&self, work: impl FnOnce() -> R) -> (u32, R) {
        compiler_fence(Ordering::SeqCst);
        let start = SYST::get_current();
        compiler_fence(Ordering::SeqCst);
        let result = work();
        compiler_fence(Ordering::SeqCst);
        let end = SYST::get_current();
        compiler_fence(Ordering::SeqCst);
        (start.wrapping_sub(end) & SYSTICK_RELOAD, result)
    }
}

/// Two instructions, [`CALIBRATION_LOOPS`] times.
#[inline(always)]
fn known_loop() {
    // SAFETY: counts a register of its own down to zero; touches flags and nothing else.
    unsafe {
        asm!("2: subs {n}, {n}, #1", "bne 2b", n = inout(reg) CALIBRATION_LOOPS => _, options(nomem, nostack));
    }
}
