//! What depends on the chip: registers, clocks and the interrupts that executors borrow. A board's feature chooses its
//! chip's, and nothing but this module, [`super::storage`] and what only one of the chips has asks which it is.
//!
//! Each chip's file has the same names, but for the USB port's supply, which the H743 alone has. Another chip is
//! another file here and another in `storage/`.

#[cfg(feature = "stm32f405")]
#[path = "chip/f405.rs"]
mod chosen;
#[cfg(feature = "stm32h743")]
#[path = "chip/h743.rs"]
mod chosen;

pub use chosen::*;
