//! How often something happened since boot.

use core::sync::atomic::{AtomicU32, Ordering};

/// A count; it starts again after 2^32.
#[derive(Debug, Default)]
pub struct Count(AtomicU32);

impl Count {
    /// Never yet.
    pub const fn new() -> Self {
        Self(AtomicU32::new(0))
    }

    /// Once more.
    pub(super) fn add(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    /// How often.
    pub fn get(&self) -> u32 {
        self.0.load(Ordering::Relaxed)
    }
}
