//! The two executors: flight interrupts background, and both interrupt thread mode, which only sleeps.

use super::lines::Interrupt;
use embassy_executor::{InterruptExecutor, SendSpawner};

static FLIGHT: InterruptExecutor = InterruptExecutor::new();
static BACKGROUND: InterruptExecutor = InterruptExecutor::new();

/// Starts the executor of control, IMU and the simulator's link. To be called once.
pub fn start_flight() -> SendSpawner {
    FLIGHT.start(Interrupt::Flight)
}

/// Starts the executor of everything that may wait. To be called once.
pub fn start_background() -> SendSpawner {
    BACKGROUND.start(Interrupt::Background)
}

pub(super) unsafe extern "C" fn flight() {
    // SAFETY: this is its interrupt's handler; the line is unmasked by `start`, after the executor is initialised.
    unsafe { FLIGHT.on_interrupt() }
}

pub(super) unsafe extern "C" fn background() {
    // SAFETY: as above.
    unsafe { BACKGROUND.on_interrupt() }
}
