//! Boards: pins, clocks, registers and interrupts, and nothing else.

#[cfg(feature = "crazyflie-bolt")]
pub mod crazyflie_bolt;
#[cfg(any(feature = "stm32", feature = "mps2"))]
mod memory;
#[cfg(feature = "micoair-h743")]
pub mod micoair_h743;
#[cfg(feature = "mps2")]
pub mod mps2;
#[cfg(feature = "stm32")]
pub mod stm32;
