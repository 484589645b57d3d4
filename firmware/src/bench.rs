//! What the drivers' tests share: a clock that jumps, and a data-ready pin.

use crate::hardware::{Clock, DataReady, Fault};
use core::cell::Cell;
use core::future::pending;
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

/// A data-ready pin that rises when waited for, a little before the waiting task wakes up, or never.
pub struct Pin {
    /// Whether it rises.
    pub rises: Rc<Cell<bool>>,
    /// How much later the waiting task wakes up, us.
    pub late: u64,
    /// The time.
    pub clock: Jumping,
}

impl DataReady for Pin {
    async fn rise(&mut self) -> Result<u64, Fault> {
        if !self.rises.get() {
            return pending().await;
        }
        let time = self.clock.now();
        self.clock.jump(time + self.late);
        Ok(time)
    }
}
