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
    fn interval(&self, telemetry: u64, is_on_bench: bool) -> Option<u64> {
        let interval = self.requested_interval.or(match self.rate {
            Rate::OnRequest => None,
            Rate::Bench(interval) => Some(interval).filter(|_| is_on_bench),
            Rate::Every(interval) => Some(interval),
            Rate::Telemetry => Some(telemetry),
        });
        interval.filter(|&interval| interval < u64::MAX)
    }
}

/// When each message is due.
#[derive(Debug)]
pub struct Schedule {
    streams: [Stream; STREAMS.len()],
    /// Whether there is no estimate yet.
    is_on_bench: bool,
}

impl Schedule {
    /// Everything is due at `now`, us.
    pub fn new(now: u64) -> Self {
        let streams = STREAMS.map(|(kind, rate)| Stream { kind, rate, requested_interval: None, due: now });
        Self { streams, is_on_bench: false }
    }

    /// Sends what is for the bench, or not any more.
    pub fn set_bench(&mut self, is_on_bench: bool) {
        self.is_on_bench = is_on_bench;
    }

    /// The first message that is due at `now`, us, where telemetry goes out every `telemetry` us; it is then due an
    /// interval later, or an interval from now if that has passed as well.
    pub fn next_due(&mut self, telemetry: u64, now: u64) -> Option<Kind> {
        let is_on_bench = self.is_on_bench;
        self.streams.iter_mut().filter(|stream| now >= stream.due).find_map(|stream| {
            let interval = stream.interval(telemetry, is_on_bench)?;
            let next = stream.due.saturating_add(interval);
            stream.due = if next > now { next } else { now.saturating_add(interval) };
            Some(stream.kind)
        })
    }

    /// When something is due next, us.
    pub fn next(&self, telemetry: u64) -> u64 {
        let is_running = |stream: &&Stream| stream.interval(telemetry, self.is_on_bench).is_some();
        let running = self.streams.iter().filter(is_running);
        running.map(|stream| stream.due).min().unwrap_or(u64::MAX)
    }

    /// Sends a message every `interval` us from now on, in SET_MESSAGE_INTERVAL's terms: 0 is the table's rate, below
    /// that never.
    pub fn set_interval(&mut self, kind: Kind, interval: i64, now: u64) {
        for stream in self.streams.iter_mut().filter(|stream| stream.kind == kind) {
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
        let stream = self.streams.iter().find(|stream| stream.kind == kind)?;
        stream.interval(telemetry, self.is_on_bench)
    }
}

/// The interval of a rate, Hz, us. Parameters lie within their ranges,
/// [`crate::parameters::table::Name::TelemetryRate`] above zero.
pub fn interval_of_rate(rate: f32) -> u64 {
    (1e6 / rate) as u64
}

#[cfg(test)]
mod tests;
