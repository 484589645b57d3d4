//! The serial lines, 8N1, at 921,600 baud until the parameter `SER_BAUD` has set the link's: the link to the ground
//! station and the pose source, by DMA both ways, and the line to a simulator, by an interrupt for each byte, for want
//! of free DMA channels; it is not used in flight.
//!
//! Reception runs on by itself into a ring that holds 22 ms of a full line; a line that falls idle wakes the reader at
//! once, a busy one every half ring. A read that fails (noise, a ring overrun) loses what the ring held, and the next
//! one starts reception again.

use embassy_stm32::gpio::Pull;
use embassy_stm32::mode::Async;
use embassy_stm32::usart::{BufferedUart, BufferedUartRx, BufferedUartTx, Config, RingBufferedUartRx, Uart, UartTx};
use static_cell::StaticCell;

/// Bytes that arrive, `embedded-io-async`'s `Read`.
pub type Receiver = RingBufferedUartRx<'static>;

/// Bytes that leave, `embedded-io-async`'s `Write`.
pub type Transmitter = UartTx<'static, Async>;

/// Bytes that arrive from a simulator.
pub type SimulatorReceiver = BufferedUartRx<'static>;

/// Bytes that arrive from a radio.
pub type RadioReceiver = BufferedUartRx<'static>;

/// Bytes that leave for a simulator.
pub type SimulatorTransmitter = BufferedUartTx<'static>;

const RING_BYTES: usize = 2048;

/// Bytes on their way to a simulator and from it: more than a tick's messages.
const SIMULATOR_RING_BYTES: usize = 512;

/// Room for those bytes, in the order (to, from). Once.
pub fn simulator_rings() -> (&'static mut [u8], &'static mut [u8]) {
    static TO: StaticCell<[u8; SIMULATOR_RING_BYTES]> = StaticCell::new();
    static FROM: StaticCell<[u8; SIMULATOR_RING_BYTES]> = StaticCell::new();
    (TO.init([0; SIMULATOR_RING_BYTES]), FROM.init([0; SIMULATOR_RING_BYTES]))
}

/// Bytes from a radio: 12 ms of a full line. The other half is never used.
const RADIO_RING_BYTES: usize = 512;

/// Room for those bytes, in the order (to, from). Once.
pub fn radio_rings() -> (&'static mut [u8], &'static mut [u8]) {
    static TO: StaticCell<[u8; 16]> = StaticCell::new();
    static FROM: StaticCell<[u8; RADIO_RING_BYTES]> = StaticCell::new();
    (TO.init([0; 16]), FROM.init([0; RADIO_RING_BYTES]))
}

/// 420,000 baud, as receivers of CRSF speak.
pub fn radio_config() -> Config {
    let mut config = config();
    config.baudrate = 420_000;
    config
}

/// The simulator's two halves, for two tasks.
pub fn simulator_halves(uart: BufferedUart<'static>) -> (SimulatorReceiver, SimulatorTransmitter) {
    let (transmitter, receiver) = uart.split();
    (receiver, transmitter)
}

/// 921,600 baud, eight bits, no parity, one stop bit. Pulled up: an undriven line must not look like bytes.
pub fn config() -> Config {
    let mut config = Config::default();
    config.baudrate = 921_600;
    config.rx_pull = Pull::Up;
    config
}

/// The link's two halves, for two tasks. Once.
pub fn halves(uart: Uart<'static, Async>) -> (Receiver, Transmitter) {
    static BYTES: StaticCell<[u8; RING_BYTES]> = StaticCell::new();
    let (transmitter, receiver) = uart.split();
    (receiver.into_ring_buffered(BYTES.init([0; RING_BYTES])), transmitter)
}
