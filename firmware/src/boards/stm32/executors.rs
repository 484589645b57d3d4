//! Three executors in interrupts that the board has no other use for, control above the sensor and that above the
//! services, all below the drivers' own. The thread is left to the memory card, which may keep it for minutes.

use embassy_executor::InterruptExecutor;

/// Control interrupts everything but the drivers' own interrupts.
pub static CONTROL: InterruptExecutor = InterruptExecutor::new();

/// The sensor interrupts all but control.
pub static SENSOR: InterruptExecutor = InterruptExecutor::new();

/// Everything else but the card.
pub static SERVICES: InterruptExecutor = InterruptExecutor::new();

/// The handlers of a chip's interrupts, each with its executor.
macro_rules! handlers {
    ($($interrupt:ident => $executor:ident),* $(,)?) => {
        $(
            #[interrupt]
            unsafe fn $interrupt() {
                // SAFETY: called from one handler, which runs no sooner than `start` has unmasked it.
                unsafe { executors::$executor.on_interrupt() }
            }
        )*
    };
}
pub(crate) use handlers;
