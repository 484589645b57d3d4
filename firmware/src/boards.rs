//! Boards: pins, clocks, registers and interrupts, and nothing else.

#[cfg(feature = "mps2")]
pub mod mps2;
