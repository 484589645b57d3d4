//! Long work: other Python threads run meanwhile, and Ctrl-C ends it.
//!
//! The work has a thread of its own; this one waits for it without Python's lock, and looks for signals now and then.
//! Python raises them in its main thread only, so Ctrl-C ends what the main thread waits for.

use host_sim::output::interrupt::Interrupt;
use pyo3::prelude::*;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Between two looks for signals.
const SIGNAL_POLL_INTERVAL: Duration = Duration::from_millis(50);

/// What `work` gives; it ends early once its interrupt says so.
///
/// # Errors
/// What a signal's handler raised, by default `KeyboardInterrupt`; what the work gave is dropped then.
pub fn interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&Interrupt) -> T + Send) -> PyResult<T> {
    let interrupt = &Interrupt::default();
    py.detach(|| {
        thread::scope(|scope| {
            let (sender, receiver) = channel();
            let worker = scope.spawn(move || {
                let done = work(interrupt);
                // The caller was interrupted and no longer waits.
                let _ = sender.send(());
                done
            });
            while let Err(RecvTimeoutError::Timeout) = receiver.recv_timeout(SIGNAL_POLL_INTERVAL) {
                if let Err(raised) = Python::attach(|py| py.check_signals()) {
                    interrupt.ask();
                    let _ = worker.join();
                    return Err(raised);
                }
            }
            worker.join().map_err(|panic| std::panic::resume_unwind(panic))
        })
    })
}
