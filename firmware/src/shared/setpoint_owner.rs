//! Whose setpoints are flown.

use core::sync::atomic::{AtomicU32, Ordering};

/// No sender. A system and a component make a smaller number.
const NO_SENDER: u32 = u32::MAX;

/// A system and a component, or none.
#[derive(Debug)]
pub struct SetpointOwner(AtomicU32);

impl SetpointOwner {
    /// No sender.
    pub const fn new() -> Self {
        Self(AtomicU32::new(NO_SENDER))
    }

    /// Sets the sender, or none.
    pub fn set(&self, sender: Option<(u8, u8)>) {
        let number = sender.map_or(NO_SENDER, |(system, component)| u16::from_be_bytes([system, component]).into());
        self.0.store(number, Ordering::Release);
    }

    /// Who it is.
    pub fn get(&self) -> Option<(u8, u8)> {
        let [system, component] = u16::try_from(self.0.load(Ordering::Acquire)).ok()?.to_be_bytes();
        Some((system, component))
    }
}
