//! Time since boot, from Embassy's time driver (TIM5, 1 MHz).

use crate::hardware::Clock;
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
