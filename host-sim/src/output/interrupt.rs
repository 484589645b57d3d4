//! Interruption: SIGINT (Ctrl-C), SIGTERM and SIGHUP (a terminal that closes) end long work at its next step, so
//! that no half-written file stays behind.

#[cfg(unix)]
use signal_hook::consts::SIGHUP;
use signal_hook::consts::{SIGINT, SIGTERM};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Whether a signal has come; clones share it.
#[derive(Debug, Clone, Default)]
pub struct Interrupt(Arc<AtomicUsize>);

impl Interrupt {
    /// Takes note of these signals from now on, instead of being ended by them. A SIGHUP that is ignored, as under
    /// `nohup`, stays ignored.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn watch() -> io::Result<Self> {
        let interrupt = Self::default();
        for signal in [SIGINT, SIGTERM].into_iter().chain(hangup()) {
            signal_hook::flag::register_usize(signal, Arc::clone(&interrupt.0), signal as usize)?;
        }
        Ok(interrupt)
    }

    /// Asks for it as a signal would.
    pub fn ask(&self) {
        self.0.store(SIGINT as usize, Ordering::Relaxed);
    }

    /// The signal that came, if one did: the exit status is 128 more, as shells have it.
    pub fn signal(&self) -> Option<u8> {
        u8::try_from(self.0.load(Ordering::Relaxed)).ok().filter(|signal| *signal > 0)
    }
}

/// SIGHUP, if the system says that it would end this program: Linux does.
#[cfg(unix)]
fn hangup() -> Option<i32> {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    ignored.filter(|ignored| ignored & 1 << (SIGHUP - 1) == 0).map(|_| SIGHUP)
}

/// Windows has none.
#[cfg(not(unix))]
fn hangup() -> Option<i32> {
    None
}
