//! The threads that work is shared out to.
//!
//! Not rayon's own: a process that was forked, as multiprocessing does, has none of its parent's threads, and would
//! wait for them for ever.

use crate::errors::failed;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::{Arc, Mutex, PoisonError};

/// The threads of this process, and which process that is.
static OURS: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Does brief work on the threads that everything brief shares.
///
/// # Errors
/// If the machine gives no threads.
pub fn shared<T: Send>(work: impl FnOnce() -> T + Send) -> PyResult<T> {
    Ok(ours()?.install(work))
}

/// Does long work on threads of its own: on shared ones it could not end before other work that one of them took up
/// meanwhile.
///
/// # Errors
/// If the machine gives no threads.
pub fn alone<T: Send>(work: impl FnOnce() -> T + Send) -> PyResult<T> {
    Ok(made()?.install(work))
}

fn ours() -> PyResult<Arc<ThreadPool>> {
    let mut ours = OURS.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if let Some((owner, pool)) = &*ours
        && *owner == process
    {
        return Ok(Arc::clone(pool));
    }
    let pool = Arc::new(made()?);
    // The parent's pool is not shut down: its threads do not exist in this process.
    std::mem::forget(ours.replace((process, Arc::clone(&pool))));
    Ok(pool)
}

fn made() -> PyResult<ThreadPool> {
    ThreadPoolBuilder::new().build().map_err(failed)
}
