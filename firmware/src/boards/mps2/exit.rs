//! Every way to end in failure: a line on the emulator's standard error, and status 1.
//!
//! The lines are plain text, not defmt: a fault may come while defmt's encoder is in use.

use cortex_m_rt::{ExceptionFrame, exception};
use cortex_m_semihosting::{debug, heprintln};

/// Ends the emulation with status 1.
pub fn fail(why: &str) -> ! {
    heprintln!("error: {}", why);
    loop {
        debug::exit(debug::EXIT_FAILURE);
    }
}

/// The processor could not go on; panics end here too, after printing themselves.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    heprintln!("error: hard fault at {:#010x}, called from {:#010x}", frame.pc(), frame.lr());
    loop {
        debug::exit(debug::EXIT_FAILURE);
    }
}

/// An interrupt that nobody handles.
#[exception]
unsafe fn DefaultHandler(interrupt: i16) -> ! {
    heprintln!("error: unexpected interrupt {}", interrupt);
    loop {
        debug::exit(debug::EXIT_FAILURE);
    }
}
