//! QEMU's `mps2-an386` (Cortex-M4F) and `mps2-an500` (Cortex-M7).

/// A device's interrupt handler.
type Handler = unsafe extern "C" fn();

unsafe extern "C" {
    fn DefaultHandler();
}

/// The device's part of the vector table.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
pub static __INTERRUPTS: [Handler; 32] = [DefaultHandler; 32];
