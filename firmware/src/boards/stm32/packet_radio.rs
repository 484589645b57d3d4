//! The line to a chip that carries packets over the radio, and what it reports of the battery.

use super::clock::SystemClock;
use super::link::{self, Receiver, Transmitter};
use crate::syslink::Wire;
use crate::syslink::battery::ReportedBattery;
use embassy_stm32::exti::ExtiInput;
use embassy_stm32::mode::Async;
use embassy_stm32::usart::{Config, Uart};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use static_cell::StaticCell;

/// Bytes from the chip: 5 ms of a full line.
const RING_BYTES: usize = 512;

/// The battery that the chip measures.
pub type RadioBattery = ReportedBattery<'static, CriticalSectionRawMutex, SystemClock>;

/// Everything that its task needs.
pub struct PacketRadio {
    /// Bytes from the chip.
    pub receiver: Receiver,
    /// Bytes to the chip.
    pub transmitter: Transmitter,
    /// High while the chip takes none.
    pub stop: ExtiInput<'static, Async>,
    /// Packets, and what the chip reports.
    pub wire: &'static Wire<CriticalSectionRawMutex>,
}

impl PacketRadio {
    /// On this line, and this pin by which the chip stops it. Once.
    pub fn new(uart: Uart<'static, Async>, stop: ExtiInput<'static, Async>) -> Self {
        static BYTES: StaticCell<[u8; RING_BYTES]> = StaticCell::new();
        static WIRE: Wire<CriticalSectionRawMutex> = Wire::new();
        let (transmitter, receiver) = uart.split();
        let receiver = receiver.into_ring_buffered(BYTES.init([0; RING_BYTES]));
        Self { receiver, transmitter, stop, wire: &WIRE }
    }

    /// The battery that it reports.
    pub const fn battery(&self) -> RadioBattery {
        ReportedBattery { wire: self.wire, clock: SystemClock }
    }
}

/// The chip, where the board has one.
pub fn present(radio: Option<impl Into<PacketRadio>>) -> Option<PacketRadio> {
    radio.map(Into::into)
}

/// 1,000,000 baud, else as the link's.
pub fn config() -> Config {
    let mut config = link::config();
    config.baudrate = 1_000_000;
    config
}
