//! When the sensors' pins rose: the interrupt stamps the edge, whatever keeps the task that waits for it.

use crate::hardware::{DataReady, Fault};
use core::sync::atomic::{AtomicU32, Ordering};
use embassy_stm32::exti::ExtiInput;
use embassy_stm32::interrupt::typelevel::{Handler, Interrupt};
use embassy_stm32::mode::Async;
use embassy_stm32::pac::EXTI;
use embassy_time::Instant;

/// Lines that pins have.
const LINE_COUNT: usize = 16;

/// The newest edge of each line, us, its lowest 32 bits.
static EDGES: [AtomicU32; LINE_COUNT] = [const { AtomicU32::new(0) }; LINE_COUNT];

/// Bound to the lines' interrupts before Embassy's handler, which ends what is pending.
pub struct Stamps;

impl<I: Interrupt> Handler<I> for Stamps {
    unsafe fn on_interrupt() {
        let now = Instant::now().as_micros() as u32;
        let rose = risen();
        for (line, edge) in EDGES.iter().enumerate() {
            if rose >> line & 1 == 1 {
                edge.store(now, Ordering::Relaxed);
            }
        }
    }
}

/// The lines that a task waits for and whose edges are pending, a bit each.
fn risen() -> u32 {
    EXTI.pr(0).read().0 & EXTI.imr(0).read().0
}

/// A pin whose edges are stamped.
pub struct StampedPin {
    /// The pin.
    pub pin: ExtiInput<'static, Async>,
    /// Its line, which is its number in its port.
    pub line: u8,
}

impl DataReady for StampedPin {
    async fn rise(&mut self) -> Result<u64, Fault> {
        self.pin.wait_for_rising_edge().await;
        let edge = EDGES.get(usize::from(self.line)).ok_or(Fault)?.load(Ordering::Relaxed);
        let now = Instant::now().as_micros();
        Ok(now.saturating_sub((now as u32).wrapping_sub(edge).into()))
    }
}
