//! The battery, as the chip reports it.

use super::wire::{REPORT_TIMEOUT_US, Wire};
use crate::hardware::{Battery, Clock};
use embassy_sync::blocking_mutex::raw::RawMutex;

/// A battery that the chip measures.
pub struct ReportedBattery<'a, M: RawMutex, C> {
    /// Where its reports are.
    pub wire: &'a Wire<M>,
    /// By which they age.
    pub clock: C,
}

impl<M: RawMutex, C: Clock> Battery for ReportedBattery<'_, M, C> {
    /// None where the last report is older than [`REPORT_TIMEOUT_US`].
    async fn voltage(&mut self) -> Option<f32> {
        let now = self.clock.now();
        self.wire.voltage().filter(|voltage| voltage.age(now) <= REPORT_TIMEOUT_US).map(|voltage| voltage.value)
    }
}
