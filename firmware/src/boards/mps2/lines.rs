//! The board's clock, and the lines of its interrupt controller.

use cortex_m::interrupt::InterruptNumber;

/// What the processor and all devices on the bus run at.
pub const CLOCK_HZ: u32 = 25_000_000;

/// The lines of the interrupt controller that are in use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u16)]
pub enum Interrupt {
    /// UART 0 has a byte.
    Uart0Receive = 0,
    /// UART 0 takes another byte.
    Uart0Transmit = 1,
    /// UART 1 has a byte.
    Uart1Receive = 2,
    /// UART 1 takes another byte.
    Uart1Transmit = 3,
    /// Timer 0 has run down.
    Timer0 = 8,
    /// The executor of the flight tasks; connected to no device.
    Flight = 30,
    /// The executor of everything that may wait; connected to no device.
    Background = 31,
}

// SAFETY: the numbers are those of the machine's lines, each below the 32 that it has.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}
