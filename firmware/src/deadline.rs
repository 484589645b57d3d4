//! Bounds in time: no task waits for anything without one.

use crate::hardware::{Clock, Fault};
use core::future::Future;
use embassy_futures::select::{Either, select};

/// What `work` comes to, if it does so within `limit` microseconds.
///
/// # Errors
/// [`Fault`] after `limit`; `work` is dropped then.
pub async fn within<T>(clock: &impl Clock, limit: u64, work: impl Future<Output = T>) -> Result<T, Fault> {
    match select(work, clock.until(clock.now() + limit)).await {
        Either::First(done) => Ok(done),
        Either::Second(()) => Err(Fault),
    }
}
