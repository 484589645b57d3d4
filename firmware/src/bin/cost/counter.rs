//! Counts instructions with SysTick, in an emulator whose clock advances by a fixed time for every instruction.
//!
//! `qemu-system-arm -icount shift=6` lets one instruction take 64 ns; the board's SysTick counts at 25 MHz, so one
//! instruction is 1.6 ticks. The counter finds that out by itself, on a loop whose instructions are known, and so serves
//! any shift. A difference of two readings is off by less than a tick, 0.6 instructions.
//!
//! The register holds 24 bits, 10 million instructions. [`Counter::long`] counts its wraps in an exception, whose handler
//! is counted too: about ten instructions in ten million.

use core::arch::asm;
use core::sync::atomic::{AtomicU32, Ordering, compiler_fence};
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;

const RELOAD: u32 = 0x00FF_FFFF;
const PERIOD: u64 = RELOAD as u64 + 1;
/// Iterations of the calibration loop, of two instructions each.
const CALIBRATION: u32 = 100_000;

static WRAPS: AtomicU32 = AtomicU32::new(0);

#[exception]
fn SysTick() {
    WRAPS.fetch_add(1, Ordering::Relaxed);
}

/// SysTick, free-running, and what it needs to be read as instructions.
pub struct Counter {
    syst: SYST,
    /// Ticks that an empty window takes.
    overhead: u32,
    ticks_per_instruction: f64,
}

impl Counter {
    /// Starts the counter; none if the same loop does not take the same time twice: then nothing counts instructions.
    pub fn start(mut syst: SYST) -> Option<Self> {
        syst.set_clock_source(SystClkSource::Core);
        syst.set_reload(RELOAD);
        syst.clear_current();
        syst.enable_counter();
        let mut counter = Self { syst, overhead: 0, ticks_per_instruction: 0.0 };
        counter.overhead = counter.window(|| ()).0;
        let (first, second) = (counter.window(known_loop).0, counter.window(known_loop).0);
        counter.ticks_per_instruction = f64::from(first - counter.overhead) / f64::from(2 * CALIBRATION);
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

    /// Instructions of `work`, however many, and what it returned.
    pub fn long<R>(&mut self, work: impl FnOnce() -> R) -> (f64, R) {
        self.syst.clear_current();
        WRAPS.store(0, Ordering::Relaxed);
        self.syst.enable_interrupt();
        let (ticks, result) = self.window(work);
        self.syst.disable_interrupt();
        // The window's difference is that of the remainders: a wrap more than the readings show is in `WRAPS`.
        let ticks = u64::from(WRAPS.load(Ordering::Relaxed)) * PERIOD + u64::from(ticks);
        (ticks as f64 / self.ticks_per_instruction, result)
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
        (start.wrapping_sub(end) & RELOAD, result)
    }
}

/// Two instructions, [`CALIBRATION`] times.
#[inline(always)]
fn known_loop() {
    // SAFETY: counts a register of its own down to zero; touches flags and nothing else.
    unsafe {
        asm!("2: subs {n}, {n}, #1", "bne 2b", n = inout(reg) CALIBRATION => _, options(nomem, nostack));
    }
}
