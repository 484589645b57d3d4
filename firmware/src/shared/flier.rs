//! Whose setpoints are flown.

use core::sync::atomic::{AtomicU32, Ordering};

/// Nobody's in particular. A system and a component are less.
const NOBODY: u32 = u32::MAX;

/// A system and a component, or nobody.
#[derive(Debug)]
pub struct Flier(AtomicU32);

impl Flier {
    /// Nobody.
    #[must_use]
    pub const fn new() -> Self {
        Self(AtomicU32::new(NOBODY))
    }

    /// From now on it is somebody else, or nobody.
    pub fn set(&self, sender: Option<(u8, u8)>) {
        let number = sender.map_or(NOBODY, |(system, component)| u16::from_be_bytes([system, component]).into());
        self.0.store(number, Ordering::Release);
    }

    /// Who it is.
    #[must_use]
    pub fn get(&self) -> Option<(u8, u8)> {
        let [system, component] = u16::try_from(self.0.load(Ordering::Acquire)).ok()?.to_be_bytes();
        Some((system, component))
    }
}

impl Default for Flier {
    fn default() -> Self {
        Self::new()
    }
}
