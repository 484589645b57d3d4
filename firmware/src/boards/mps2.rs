//! QEMU's `mps2-an386` (Cortex-M4F) and `mps2-an500` (Cortex-M7): a board that only exists emulated.
//!
//! | peripheral | use |
//! |---|---|
//! | UART0 | the simulator: sensors in, motors out ([`crate::hil`]) |
//! | UART1 | the ground station |
//! | SysTick, timer 0 | [`time`]: what embassy-time counts, and when it wakes |
//! | LED | [`bench`], which also stands in for what is not there |
//! | watchdog | [`watchdog`]: ends the emulation |
//! | two unconnected interrupt lines | the executors, flight above link ([`executors`]); all lines: [`lines`] |
//!
//! Thread mode only sleeps ([`idle`]). Panics and faults end the emulation with status 1 ([`exit`]).

pub mod bench;
pub mod executors;
pub mod exit;
pub mod idle;
pub mod lines;
pub mod time;
pub mod uart;
pub mod watchdog;

use super::{guard, handover};
use cortex_m::peripheral::NVIC;
use lines::Interrupt;

/// Lines by urgency, the most urgent first. Devices only move bytes and wake tasks, so they may interrupt the flight
/// tasks.
const LINE_PRIORITIES: [(Interrupt, u8); 7] = [
    (Interrupt::Timer0, 0x20),
    (Interrupt::Uart0Receive, 0x40),
    (Interrupt::Uart0Transmit, 0x40),
    (Interrupt::Uart1Receive, 0x40),
    (Interrupt::Uart1Transmit, 0x40),
    (Interrupt::Flight, 0x80),
    (Interrupt::Background, 0xC0),
];

/// The core as after a reset, its stack guarded, its instruction cache on where it has one: what a board begins with,
/// too. The emulated Cortex-M7 takes the cache's bit and keeps none, so what it says of it counts for nothing.
///
/// # Panics
/// The second time.
pub fn begin() -> cortex_m::Peripherals {
    let mut core = handover::begin_anew(|_| ());
    guard::watch(&mut core.MPU);
    let _ = handover::cache_instructions(&mut core);
    core
}

/// Starts time and the UARTs; the executors' lines are turned on when they start.
pub fn init(mut core: cortex_m::Peripherals) {
    // Unmasking below cannot break a critical section: nothing has started one yet.
    for (line, priority) in LINE_PRIORITIES {
        // SAFETY: no line is unmasked yet, and no critical section relies on priorities.
        unsafe { core.NVIC.set_priority(line, priority) };
    }
    time::init(core.SYST);
    uart::SIMULATOR.init();
    uart::GROUND.init();
    use Interrupt::{Timer0, Uart0Receive, Uart0Transmit, Uart1Receive, Uart1Transmit};
    for line in [Timer0, Uart0Receive, Uart0Transmit, Uart1Receive, Uart1Transmit] {
        // SAFETY: each of these has its handler in the table below, and its device is initialised.
        unsafe { NVIC::unmask(line) };
    }
}

/// A device's interrupt handler.
type Handler = unsafe extern "C" fn();

unsafe extern "C" {
    fn DefaultHandler();
}

/// The device's part of the vector table.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
pub static __INTERRUPTS: [Handler; 32] = {
    let mut table: [Handler; 32] = [DefaultHandler; 32];
    table[Interrupt::Uart0Receive as usize] = uart::simulator_received;
    table[Interrupt::Uart0Transmit as usize] = uart::simulator_transmitted;
    table[Interrupt::Uart1Receive as usize] = uart::ground_received;
    table[Interrupt::Uart1Transmit as usize] = uart::ground_transmitted;
    table[Interrupt::Timer0 as usize] = time::alarm;
    table[Interrupt::Flight as usize] = executors::flight;
    table[Interrupt::Background as usize] = executors::background;
    table
};
