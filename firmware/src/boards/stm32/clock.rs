//! Time since boot, from Embassy's time driver (TIM5, 1 MHz).
//!
//! The driver counts half turns of a 16-bit counter by an interrupt at each, 33 ms apart. A core that stands still for
//! longer misses some, and after an odd number of them the clock steps back by 65.5 ms at the end of every turn, until
//! the chip restarts. So the counter stands still whenever the core does: for a probe, and for work on the F405's
//! flash.

use crate::hardware::Clock;
#[cfg(feature = "stm32f405")]
use embassy_stm32::pac::TIM5;
use embassy_time::{Instant, Timer};

/// The board's only clock.
#[derive(Debug, Clone, Copy)]
pub struct SystemClock;

impl Clock for SystemClock {
    fn now(&self) -> u64 {
        Instant::now().as_micros()
    }

    async fn until(&self, time: u64) {
        Timer::at(Instant::from_micros(time)).await;
    }
}

/// The clock stands still for as long as this lives.
#[cfg(feature = "stm32f405")]
#[must_use]
pub struct Halted;

/// Halts the clock, for work that stalls the core.
#[cfg(feature = "stm32f405")]
pub fn halt() -> Halted {
    TIM5.cr1().modify(|w| w.set_cen(false));
    Halted
}

#[cfg(feature = "stm32f405")]
impl Drop for Halted {
    fn drop(&mut self) {
        TIM5.cr1().modify(|w| w.set_cen(true));
    }
}
