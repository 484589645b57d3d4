//! A flag that one task raises and another takes down.

use core::sync::atomic::{AtomicBool, Ordering};

/// Raised or not; raising it twice is raising it once.
#[derive(Debug, Default)]
pub struct Flag(AtomicBool);

impl Flag {
    /// Not raised.
    pub const fn new() -> Self {
        Self(AtomicBool::new(false))
    }

    /// Raises it.
    pub fn raise(&self) {
        self.0.store(true, Ordering::Release);
    }

    /// Takes it down.
    pub fn lower(&self) {
        self.0.store(false, Ordering::Release);
    }

    /// Whether it is raised.
    pub fn is_raised(&self) -> bool {
        self.0.load(Ordering::Acquire)
    }

    /// Takes it down; whether it was raised.
    #[must_use]
    pub fn take(&self) -> bool {
        self.0.swap(false, Ordering::AcqRel)
    }
}
