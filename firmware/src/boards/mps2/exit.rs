//! Every way to end: in failure with a line on the emulator's standard error and status 1, otherwise with status 0.
//!
//! The lines are plain text, not defmt: a fault may come while defmt's encoder is in use.

use crate::boards::fault::Fault;
use core::fmt::Display;
use core::panic::PanicInfo;
use cortex_m as _; // the critical section that printing takes
use cortex_m_rt::exception;
use cortex_m_semihosting::{debug, heprintln};

/// Ends the emulation.
pub fn end(success: bool) -> ! {
    loop {
        debug::exit(if success { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    }
}

/// Ends the emulation with status 1.
pub fn fail(why: impl Display) -> ! {
    heprintln!("error: {}", why);
    end(false)
}

#[panic_handler]
fn panicked(info: &PanicInfo<'_>) -> ! {
    fail(info)
}

/// The processor could not go on.
pub fn faulted(fault: &Fault) -> ! {
    fail(fault)
}

/// An unhandled interrupt.
#[exception]
unsafe fn DefaultHandler(interrupt: i16) -> ! {
    heprintln!("error: unexpected interrupt {}", interrupt);
    end(false)
}
