//! When a sensor has a new sample: at the edges of its data-ready pin, or by the clock where they stay away.
//!
//! An edge is waited for no longer than two and a half periods. From then on samples are due a period after the last
//! one, edge or not, until an edge comes again: a broken line costs a little of a sample's age, and not the vehicle.

use crate::deadline::within;
use crate::hardware::{Clock, DataReady};

/// A data-ready pin and the clock beside it.
pub struct Pace<P> {
    data_ready: P,
    /// Between samples, us.
    period: u64,
    /// The last sample, us.
    last: u64,
    polled: bool,
}

impl<P: DataReady> Pace<P> {
    /// For a sensor that rises its pin every `period`, us.
    pub fn new(data_ready: P, period: u64) -> Self {
        Self { data_ready, period, last: 0, polled: false }
    }

    /// Whether the last sample was taken by the clock.
    pub fn is_polled(&self) -> bool {
        self.polled
    }

    /// Waits for the next sample; when it was ready, us.
    pub async fn next(&mut self, clock: &impl Clock) -> u64 {
        let now = clock.now();
        let limit =
            if self.polled { (self.last + self.period).saturating_sub(now) } else { 2 * self.period + self.period / 2 };
        let edge = within(clock, limit, self.data_ready.rise()).await;
        if matches!(edge, Ok(Err(_))) {
            // A pin that fails at once counts as missing.
            clock.until(now + limit).await;
        }
        let edge = edge.ok().and_then(Result::ok);
        self.polled = edge.is_none();
        self.last = edge.unwrap_or_else(|| clock.now());
        self.last
    }
}

#[cfg(test)]
mod tests;
