//! Why the chip started.

use super::cause::Cause;
use super::chip;

/// Reads the flags and clears them, so that the next start reports its own.
pub fn cause() -> Cause {
    let cause = chip::flags();
    chip::clear_flags();
    cause
}
