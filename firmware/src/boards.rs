//! Boards: pins, clocks, registers and interrupts, and nothing else.

#[cfg(feature = "crazyflie-bolt")]
pub mod crazyflie_bolt;
#[cfg(any(feature = "stm32", feature = "mps2"))]
pub mod fault;
#[cfg(any(feature = "stm32", feature = "mps2"))]
pub mod guard;
#[cfg(any(feature = "stm32", feature = "mps2"))]
pub mod handover;
#[cfg(any(feature = "stm32", feature = "mps2"))]
pub mod kept;
#[cfg(feature = "matek-h743")]
pub mod matek_h743;
#[cfg(feature = "micoair-h743")]
pub mod micoair_h743;
#[cfg(feature = "mps2")]
pub mod mps2;
pub mod recorder;
#[cfg(feature = "stm32")]
pub mod stm32;

#[cfg(feature = "crazyflie-bolt")]
use crazyflie_bolt as chosen;
#[cfg(feature = "matek-h743")]
use matek_h743 as chosen;
#[cfg(feature = "micoair-h743")]
use micoair_h743 as chosen;
