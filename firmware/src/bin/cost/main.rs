//! What the law costs on a Cortex-M4F, in instructions: run by `.ci/emulated cost` on QEMU's `mps2-an386`.
//!
//! Measured is what the firmware flies: the embedded scenario's vehicle, gains and rotors, made from a `Certified`
//! configuration. Every figure is that of one call through a pointer, the window's own instructions taken off. The body
//! that the law flies moves between the windows.
//!
//! The times beside the figures assume one instruction a cycle. That is a convention, not a measurement: divisions,
//! square roots, loads and flash take a Cortex-M4 longer, and a Cortex-M7 may do two instructions in one cycle.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod body;
#[cfg(target_os = "none")]
mod count;
#[cfg(target_os = "none")]
mod counter;
#[cfg(target_os = "none")]
mod estimation;
#[cfg(target_os = "none")]
mod stack;
#[cfg(target_os = "none")]
mod target;
#[cfg(target_os = "none")]
mod tick;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this measures the emulated board mps2-an386: `.ci/emulated cost`");
}
