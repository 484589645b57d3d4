//! What a fault was, as a restart keeps it.

use core::fmt;

/// The core's account of a fault.
pub struct Fault {
    /// Where it was, and where that was called from; none where the stack pointer is invalid.
    pub place: Option<(u32, u32)>,
    /// The configurable fault status register: what it was.
    pub status: u32,
    /// The hard fault status register.
    pub hard_status: u32,
    /// The bus fault address register.
    pub bus_address: u32,
    /// Whether the stack ran into the guard.
    pub is_overflow: bool,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.is_overflow { "stack overflow" } else { "fault" })?;
        if let Some((place, caller)) = self.place {
            write!(f, " at {place:#010x} from {caller:#010x}")?;
        }
        let Self { status, hard_status, bus_address, .. } = self;
        write!(f, ", CFSR {status:#010x}, HFSR {hard_status:#010x}, BFAR {bus_address:#010x}")
    }
}
