//! Three executors in interrupts that the board has no other use for, control above the sensor and that above the
//! services, all below the drivers' own. The thread is left to the memory card, which may keep it for minutes.

use embassy_executor::InterruptExecutor;

/// Control interrupts everything but the drivers' own interrupts.
pub static CONTROL: InterruptExecutor = InterruptExecutor::new();

/// The sensor interrupts all but control.
pub static SENSOR: InterruptExecutor = InterruptExecutor::new();

/// Everything else but the card.
pub static SERVICES: InterruptExecutor = InterruptExecutor::new();

/// What the handler of control's interrupt does.
///
/// # Safety
/// For that handler only.
pub unsafe fn on_control_interrupt() {
    // SAFETY: called from one handler, which runs no sooner than `start` has unmasked it.
    unsafe { CONTROL.on_interrupt() }
}

/// What the handler of the sensor's interrupt does.
///
/// # Safety
/// For that handler only.
pub unsafe fn on_sensor_interrupt() {
    // SAFETY: as above.
    unsafe { SENSOR.on_interrupt() }
}

/// What the handler of the services' interrupt does.
///
/// # Safety
/// For that handler only.
pub unsafe fn on_services_interrupt() {
    // SAFETY: as above.
    unsafe { SERVICES.on_interrupt() }
}
