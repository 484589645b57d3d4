//! When each message is due, at rates that a ground station may change.

use super::telemetry::kind::{Kind, Rate, STREAMS};

/// The shortest interval that is granted.
const INTERVAL_MIN_US: u64 = 10_000;

/// One message: how often it goes out, and when next.
#[derive(Debug, Clone, Copy)]
struct Stream {
    kind: Kind,
    rate: Rate,
    /// The requested interval in place of the table's, us; never for [`u64::MAX`].
    requested_interval: Option<u64>,
    due: u64,
}

impl Stream {
    /// How often it goes out where telemetry goes out every `telemetry` us, us; none if only on request.
    fn interval(&self, telemetry: u64) -> Option<u64> {
        let interval = self.requested_interval.or(match self.rate {
            Rate::OnRequest => None,
            Rate::Every(interval) => Some(interval),
            Rate::Telemetry => Some(telemetry),
        });
        interval.filter(|&interval| interval < u64::MAX)
    }
}

/// When each message is due.
#[derive(Debug)]
pub struct Schedule([Stream; STREAMS.len()]);

impl Schedule {
    /// Everything is due at `now`, us.
    pub fn new(now: u64) -> Self {
        Self(STREAMS.map(|(kind, rate)| Stream { kind, rate, requested_interval: None, due: now }))
    }

    /// The first message that is due at `now`, us, where telemetry goes out every `telemetry` us; it is then due an
    /// interval later, or an interval from now if that has passed as well.
    pub fn next_due(&mut self, telemetry: u64, now: u64) -> Option<Kind> {
        self.0.iter_mut().filter(|stream| now >= stream.due).find_map(|stream| {
            let interval = stream.interval(telemetry)?;
            let next = stream.due.saturating_add(interval);
            stream.due = if next > now { next } else { now.saturating_add(interval) };
            Some(stream.kind)
        })
    }

    /// When something is due next, us.
    pub fn next(&self, telemetry: u64) -> u64 {
        let running = self.0.iter().filter(|stream| stream.interval(telemetry).is_some());
        running.map(|stream| stream.due).min().unwrap_or(u64::MAX)
    }

    /// Sends a message every `interval` us from now on, in SET_MESSAGE_INTERVAL's terms: 0 is the table's rate, below
    /// that never.
    pub fn set_interval(&mut self, kind: Kind, interval: i64, now: u64) {
        for stream in self.0.iter_mut().filter(|stream| stream.kind == kind) {
            stream.requested_interval = match u64::try_from(interval) {
                Ok(0) => None,
                Ok(interval) => Some(interval.max(INTERVAL_MIN_US)),
                Err(_) => Some(u64::MAX),
            };
            stream.due = now;
        }
    }

    /// How often a message goes out, us; none if only on request.
    pub fn interval_of(&self, kind: Kind, telemetry: u64) -> Option<u64> {
        self.0.iter().find(|stream| stream.kind == kind).and_then(|stream| stream.interval(telemetry))
    }
}

/// The interval of a rate, Hz, us. Parameters lie within their ranges,
/// [`crate::parameters::table::Name::TelemetryRate`] above zero.
pub fn interval_of_rate(rate: f32) -> u64 {
    (1e6 / rate) as u64
}

#[cfg(test)]
mod tests;
