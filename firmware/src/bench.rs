//! What the drivers' tests share: a clock that jumps, and a data-ready pin.

use crate::hardware::Clock;
use core::cell::Cell;
use core::convert::Infallible;
use core::future::{pending, ready};
use embedded_hal_async::digital::Wait;
use std::rc::Rc;

/// A clock on which waiting costs nothing and moves time.
#[derive(Clone, Default)]
pub struct Jumping(Rc<Cell<u64>>);

impl Jumping {
    /// Lets time pass up to `time`.
    pub fn jump(&self, time: u64) {
        self.0.set(self.0.get().max(time));
    }
}

impl Clock for Jumping {
    fn now(&self) -> u64 {
        self.0.get()
    }

    async fn until(&self, time: u64) {
        self.jump(time);
    }
}

/// A data-ready pin that rises when asked, or never.
pub struct Pin(pub Rc<Cell<bool>>);

impl embedded_hal::digital::ErrorType for Pin {
    type Error = Infallible;
}

impl Wait for Pin {
    async fn wait_for_high(&mut self) -> Result<(), Infallible> {
        pending().await
    }

    async fn wait_for_low(&mut self) -> Result<(), Infallible> {
        pending().await
    }

    async fn wait_for_rising_edge(&mut self) -> Result<(), Infallible> {
        if self.0.get() { ready(Ok(())).await } else { pending().await }
    }

    async fn wait_for_falling_edge(&mut self) -> Result<(), Infallible> {
        pending().await
    }

    async fn wait_for_any_edge(&mut self) -> Result<(), Infallible> {
        pending().await
    }
}
