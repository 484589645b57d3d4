//! The commanded restart, into the firmware or into a bootloader.
//!
//! The link refuses one while a motor turns or parameters are written; from its yes on arming is refused. The restart
//! waits for the answer to go out, and for what was set just before to be saved.

use crate::hardware::{Clock, Restart};
use crate::shared::{Event, RestartView, Severity};
use embassy_sync::blocking_mutex::raw::RawMutex;

/// The interval of polls for a requested restart.
const RESTART_POLL_INTERVAL_US: u64 = 100_000;

/// Time for the answer to go out, and for parameters to be saved.
pub const RESTART_DELAY_US: u64 = 500_000;

/// Restarts on request, for ever where it does not end the program.
pub async fn run<M: RawMutex, R: Restart>(shared: RestartView<'_, M>, clock: &impl Clock, machine: &mut R) -> ! {
    shared.can_restart().raise();
    if R::HAS_BOOTLOADER {
        shared.has_bootloader().raise();
    }
    loop {
        clock.until(clock.now().saturating_add(RESTART_POLL_INTERVAL_US)).await;
        if !shared.restarting().is_raised() {
            continue;
        }
        clock.until(clock.now().saturating_add(RESTART_DELAY_US)).await;
        // Neither can be, since arming is refused meanwhile and saving does not give way; but what would follow is too
        // bad to rely on it.
        if shared.is_turning() || shared.saving().is_raised() {
            shared.restarting().lower();
            shared.announce(Event::new(Severity::Warning, "Restart: not now"));
        } else if shared.into_bootloader().is_raised() {
            machine.start_bootloader();
        } else {
            machine.restart();
        }
    }
}
