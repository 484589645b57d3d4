//! The serial link to the ground station and the pose source: 921,600 baud, 8N1, DMA both ways.
//!
//! Reception runs on by itself into a ring that holds 22 ms of a full line; a line that falls idle wakes the reader at once,
//! a busy one every half ring. A read that fails (noise, a ring overrun) loses what the ring held, and the next one starts
//! reception again.

use embassy_stm32::mode::Async;
use embassy_stm32::usart::{Config, RingBufferedUartRx, Uart, UartTx};
use static_cell::StaticCell;

/// Bytes that arrive, `embedded-io-async`'s `Read`.
pub type Receiver = RingBufferedUartRx<'static>;

/// Bytes that leave, `embedded-io-async`'s `Write`.
pub type Transmitter = UartTx<'static, Async>;

/// Bytes of the ring.
const RING: usize = 2048;

/// 921,600 baud, eight bits, no parity, one stop bit.
#[must_use]
pub fn config() -> Config {
    let mut config = Config::default();
    config.baudrate = 921_600;
    config
}

/// The link's two halves, for two tasks. Once.
pub fn halves(uart: Uart<'static, Async>) -> (Receiver, Transmitter) {
    static BYTES: StaticCell<[u8; RING]> = StaticCell::new();
    let (transmitter, receiver) = uart.split();
    (receiver.into_ring_buffered(BYTES.init([0; RING])), transmitter)
}
