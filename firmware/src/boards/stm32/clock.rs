//! Time since boot, from Embassy's time driver (TIM5, 1 MHz).
//!
//! The driver counts half turns of a 16-bit counter by an interrupt at each, 33 ms apart. A core that stands still for
//! longer misses some, and after an odd number of them the clock steps back by 65.5 ms at the end of every turn, until
//! the chip restarts. So the counter stands still whenever the core does: for a probe, and for work on the F405's
//! flash.

use crate::hardware::Clock;
use embassy_stm32::pac::DBGMCU;
#[cfg(feature = "crazyflie-bolt")]
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

/// Lets the clock stand still while a probe halts the core. Once the clocks are set.
pub fn halt_with_the_core() {
    #[cfg(feature = "micoair-h743")]
    DBGMCU.apb1lfzr1().modify(|w| w.set_tim5(true));
    #[cfg(feature = "crazyflie-bolt")]
    DBGMCU.apb1fzr().modify(|w| w.set_tim5(true));
}

/// The clock stands still for as long as this lives.
#[cfg(feature = "crazyflie-bolt")]
#[must_use]
pub struct Halted;

/// Halts the clock, for work that stalls the core.
#[cfg(feature = "crazyflie-bolt")]
pub fn halt() -> Halted {
    TIM5.cr1().modify(|w| w.set_cen(false));
    Halted
}

#[cfg(feature = "crazyflie-bolt")]
impl Drop for Halted {
    fn drop(&mut self) {
        TIM5.cr1().modify(|w| w.set_cen(true));
    }
}
