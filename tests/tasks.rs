//! The firmware's tasks on this desktop; the bits that emulated boards must find again.

mod emulated_bits;
mod lockstep;
