//! Bounds in time: no task waits for anything without one.

use crate::hardware::{Clock, Fault};
use core::future::Future;
use embassy_futures::select::{Either, select};
use embedded_io_async::Write;

/// What `work` comes to, if it does so within `limit` microseconds.
/// Errors: [`Fault`] after `limit`; `work` is dropped then.
pub async fn within<T>(clock: &impl Clock, limit: u64, work: impl Future<Output = T>) -> Result<T, Fault> {
    match select(work, clock.until(clock.now() + limit)).await {
        Either::First(done) => Ok(done),
        Either::Second(()) => Err(Fault),
    }
}

/// Writes `frame` within `limit` microseconds or gives it up: what is out of it by then, its receiver takes for noise.
/// A line that fails, or takes no bytes (`Write::write_all` would panic), loses the frame at once.
pub async fn send(line: &mut impl Write, clock: &impl Clock, limit: u64, frame: &[u8]) {
    let all = async {
        let mut rest = frame;
        while let Ok(count @ 1..) = line.write(rest).await {
            rest = rest.get(count..).unwrap_or(&[]);
            if rest.is_empty() {
                break;
            }
        }
    };
    // The sender goes on with the next frame either way.
    let _ = within(clock, limit, all).await;
}
