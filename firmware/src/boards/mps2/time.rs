//! Time for embassy-time: SysTick counts, timer 0 wakes.
//!
//! SysTick runs freely, once round in half a second, and is never written again: what it has counted is the time. An
//! alarm runs timer 0 down from exactly the cycles that are left, so the processor sleeps from alarm to alarm, and an
//! alarm is a cycle late at most, 40 ns.

use super::lines::CLOCK_HZ;
use core::cell::{Cell, RefCell};
use core::task::Waker;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};
use critical_section::{CriticalSection, Mutex};
use embassy_time_driver::Driver;
use embassy_time_queue_utils::Queue;

/// Cycles in a microsecond.
const CYCLES_PER_US: u64 = CLOCK_HZ as u64 / 1_000_000;

/// Microseconds in one round of SysTick: whole, and as many cycles as its 24 bits hold.
const ROUND_US: u64 = 500_000;

const ROUND_CYCLES: u64 = ROUND_US * CYCLES_PER_US;

const _: () = assert!(ROUND_CYCLES <= 1 << 24);

/// Timer 0 (CMSDK APB timer): counts down each cycle, interrupts at zero.
mod timer {
    const CONTROL: *mut u32 = 0x4000_0000 as *mut u32;
    const VALUE: *mut u32 = 0x4000_0004 as *mut u32;
    const RELOAD: *mut u32 = 0x4000_0008 as *mut u32;
    const INTERRUPT_CLEAR: *mut u32 = 0x4000_000C as *mut u32;
    const ENABLE: u32 = 1 << 0;
    const INTERRUPT_ENABLE: u32 = 1 << 3;

    /// Interrupts once after `cycles`, at least one. Nothing is to be reloaded then: QEMU 7.2 sets a timer that reloads
    /// before it raises the interrupt, and a processor that is still asleep at that moment sleeps through to the next
    /// one.
    pub fn start(cycles: u32) {
        // SAFETY: these are the timer's registers, and only this module touches them.
        unsafe {
            CONTROL.write_volatile(0);
            RELOAD.write_volatile(0);
            VALUE.write_volatile(cycles);
            CONTROL.write_volatile(ENABLE | INTERRUPT_ENABLE);
        }
    }

    /// No interrupt from now on.
    pub fn stop() {
        // SAFETY: as above.
        unsafe {
            CONTROL.write_volatile(0);
            INTERRUPT_CLEAR.write_volatile(1);
        }
    }
}

struct Time {
    /// Rounds of SysTick since boot.
    rounds: Mutex<Cell<u64>>,
    queue: Mutex<RefCell<Queue>>,
}

embassy_time_driver::time_driver_impl!(static TIME: Time = Time {
    rounds: Mutex::new(Cell::new(0)),
    queue: Mutex::new(RefCell::new(Queue::new())),
});

impl Time {
    /// Cycles since boot.
    fn cycles(&self, cs: CriticalSection) -> u64 {
        let rounds = self.rounds.borrow(cs);
        let mut left = SYST::get_current();
        // The round may end before its interrupt can be served; then the count is read again, on the new round's side.
        let ended = u64::from(SCB::is_pendst_pending());
        if ended > 0 {
            left = SYST::get_current();
        }
        // A round ends when the count reaches zero, and begins with one cycle there.
        (rounds.get() + ended) * ROUND_CYCLES + (ROUND_CYCLES - u64::from(left)) % ROUND_CYCLES
    }

    /// Wakes the tasks that are due, and sets the timer to the next.
    fn arm(&self, cs: CriticalSection) {
        let mut queue = self.queue.borrow_ref_mut(cs);
        loop {
            let next = queue.next_expiration(self.cycles(cs) / CYCLES_PER_US);
            if next == u64::MAX {
                return timer::stop();
            }
            let left = next.saturating_mul(CYCLES_PER_US).saturating_sub(self.cycles(cs));
            if left > 0 {
                // An alarm further away than the timer counts is looked at again when it has run down.
                return timer::start(u32::try_from(left).unwrap_or(u32::MAX));
            }
        }
    }
}

impl Driver for Time {
    fn now(&self) -> u64 {
        critical_section::with(|cs| self.cycles(cs) / CYCLES_PER_US)
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        critical_section::with(|cs| {
            let changed = self.queue.borrow_ref_mut(cs).schedule_wake(at, waker);
            if changed {
                self.arm(cs);
            }
        });
    }
}

/// Starts the count.
pub(super) fn init(mut systick: SYST) {
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload((ROUND_CYCLES - 1) as u32);
    systick.clear_current();
    systick.enable_counter();
    systick.enable_interrupt();
}

/// A round of SysTick has ended.
#[cortex_m_rt::exception]
fn SysTick() {
    critical_section::with(|cs| {
        let rounds = TIME.rounds.borrow(cs);
        rounds.set(rounds.get() + 1);
    });
}

/// Timer 0 has run down.
pub(super) unsafe extern "C" fn alarm() {
    critical_section::with(|cs| {
        timer::stop();
        TIME.arm(cs);
    });
}

/// The board's clock, for the tasks.
#[derive(Debug, Clone, Copy)]
pub struct BoardClock;

impl crate::hardware::Clock for BoardClock {
    fn now(&self) -> u64 {
        embassy_time::Instant::now().as_micros()
    }

    async fn until(&self, time: u64) {
        embassy_time::Timer::at(embassy_time::Instant::from_micros(time)).await;
    }
}
