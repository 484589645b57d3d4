//! Devices on an SPI bus that several may share.
//!
//! An exchange has the bus to itself from the fall of its device's chip select until that is high again, however the
//! exchange ends: also if it is dropped half-way, as where it took too long. Nothing waits for a bus: the sensors' task
//! asks one device after the other, and one that finds its bus in use has a [`Fault`].

use crate::hardware::Fault;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::mutex::Mutex;
use embedded_hal::digital::OutputPin;
use embedded_hal_async::spi::SpiBus;

/// A device on a bus.
pub trait Device {
    /// Sends `bytes` and puts what comes back in their places.
    /// Errors: [`Fault`] if bus or chip select fail, or another exchange has the bus.
    fn exchange(&mut self, bytes: &mut [u8]) -> impl Future<Output = Result<(), Fault>>;
}

/// A device that is chosen by a low level on its chip select.
pub struct Selected<'a, M: RawMutex, B, S> {
    bus: &'a Mutex<M, B>,
    select: S,
}

impl<'a, M: RawMutex, B, S> Selected<'a, M, B, S> {
    /// A device on `bus`. `select` is high.
    pub fn new(bus: &'a Mutex<M, B>, select: S) -> Self {
        Self { bus, select }
    }
}

impl<M: RawMutex, B: SpiBus, S: OutputPin> Device for Selected<'_, M, B, S> {
    async fn exchange(&mut self, bytes: &mut [u8]) -> Result<(), Fault> {
        // Locked before the chip select falls, and until it is high again.
        let mut bus = self.bus.try_lock().map_err(|_| Fault)?;
        let _low = Low::new(&mut self.select)?;
        bus.transfer_in_place(bytes).await.map_err(|_| Fault)?;
        bus.flush().await.map_err(|_| Fault)
    }
}

/// A chip select, low until this goes.
struct Low<'a, S: OutputPin>(&'a mut S);

impl<'a, S: OutputPin> Low<'a, S> {
    fn new(select: &'a mut S) -> Result<Self, Fault> {
        match select.set_low() {
            Ok(()) => Ok(Self(select)),
            Err(_) => Err(Fault),
        }
    }
}

impl<S: OutputPin> Drop for Low<'_, S> {
    fn drop(&mut self) {
        // A pin that cannot rise shows at the next access: its device does not identify itself.
        let _ = self.0.set_high();
    }
}

#[cfg(test)]
mod tests;
