//! Being asked to stop: SIGINT (Ctrl-C) and SIGTERM end long work at its next step, so that nothing half-written stays behind.

use signal_hook::consts::{SIGINT, SIGTERM};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Whether somebody asked; clones know the same.
#[derive(Debug, Clone, Default)]
pub struct Interrupt(Arc<AtomicUsize>);

impl Interrupt {
    /// Takes note of both signals from now on, instead of being ended by them.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn watch() -> io::Result<Self> {
        let interrupt = Self::default();
        for signal in [SIGINT, SIGTERM] {
            signal_hook::flag::register_usize(signal, Arc::clone(&interrupt.0), signal as usize)?;
        }
        Ok(interrupt)
    }

    /// Asks for it as a signal would.
    pub fn ask(&self) {
        self.0.store(SIGINT as usize, Ordering::Relaxed);
    }

    /// The signal that came, if one did: the exit status is 128 more, as shells have it.
    #[must_use]
    pub fn signal(&self) -> Option<u8> {
        u8::try_from(self.0.load(Ordering::Relaxed)).ok().filter(|signal| *signal > 0)
    }
}
