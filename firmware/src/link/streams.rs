//! Periodic messages and their rates: a table that a ground station may change.

use super::telemetry::kind::Kind;

/// A message's default rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rate {
    /// Only on request.
    OnRequest,
    /// Every so many us.
    Every(u64),
    /// At [`crate::parameters::table::Name::TelemetryRate`].
    Telemetry,
}

/// The messages, those first that matter most. At the default rates they take 4 KB/s of a line's 5.7 KB/s at 57,600
/// baud.
#[rustfmt::skip]
pub const STREAMS: [(Kind, Rate); 19] = [
    (Kind::Heartbeat,          Rate::Every(1_000_000)),
    (Kind::AttitudeQuaternion, Rate::Telemetry),
    (Kind::Position,           Rate::Telemetry),
    (Kind::Attitude,           Rate::Every(100_000)),
    (Kind::TimeSync,           Rate::Every(1_000_000)),
    (Kind::SystemStatus,       Rate::Every(1_000_000)),
    (Kind::ExtendedState,      Rate::Every(500_000)),
    (Kind::GlobalPosition,     Rate::Every(200_000)),
    (Kind::PositionTarget,     Rate::Every(200_000)),
    (Kind::Odometry,           Rate::Every(500_000)),
    (Kind::EstimatorStatus,    Rate::Every(1_000_000)),
    (Kind::BatteryStatus,      Rate::Every(2_000_000)),
    (Kind::CurrentMode,        Rate::Every(1_000_000)),
    (Kind::MissionCurrent,     Rate::Every(1_000_000)),
    (Kind::HomePosition,       Rate::Every(2_000_000)),
    (Kind::SystemTime,         Rate::Every(2_000_000)),
    (Kind::GlobalOrigin,       Rate::OnRequest),
    (Kind::AutopilotVersion,   Rate::OnRequest),
    (Kind::ProtocolVersion,    Rate::OnRequest),
];

/// The shortest interval that is granted.
const INTERVAL_MIN_US: u64 = 10_000;

/// One message: how often it goes out, and when next.
#[derive(Debug, Clone, Copy)]
struct Stream {
    kind: Kind,
    rate: Rate,
    /// The requested interval in place of the table's, us; never for [`u64::MAX`].
    asked: Option<u64>,
    due: u64,
}

impl Stream {
    /// How often it goes out where telemetry goes out every `telemetry` us, us; none if only on request.
    fn interval(&self, telemetry: u64) -> Option<u64> {
        let interval = self.asked.or(match self.rate {
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

/// The message of this number, if it can be sent.
#[must_use]
pub fn of_number(number: u32) -> Option<Kind> {
    STREAMS.iter().map(|(kind, _)| *kind).find(|kind| kind.number() == number)
}

impl Schedule {
    /// Everything is due at `now`, us.
    #[must_use]
    pub fn new(now: u64) -> Self {
        Self(STREAMS.map(|(kind, rate)| Stream { kind, rate, asked: None, due: now }))
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
    #[must_use]
    pub fn next(&self, telemetry: u64) -> u64 {
        let running = self.0.iter().filter(|stream| stream.interval(telemetry).is_some());
        running.map(|stream| stream.due).min().unwrap_or(u64::MAX)
    }

    /// Sends a message every `interval` us from now on, in SET_MESSAGE_INTERVAL's terms: 0 is the table's rate, below
    /// that never.
    pub fn ask(&mut self, kind: Kind, interval: i64, now: u64) {
        for stream in self.0.iter_mut().filter(|stream| stream.kind == kind) {
            stream.asked = match u64::try_from(interval) {
                Ok(0) => None,
                Ok(interval) => Some(interval.max(INTERVAL_MIN_US)),
                Err(_) => Some(u64::MAX),
            };
            stream.due = now;
        }
    }

    /// How often a message goes out, us; none if only on request.
    #[must_use]
    pub fn interval_of(&self, kind: Kind, telemetry: u64) -> Option<u64> {
        self.0.iter().find(|stream| stream.kind == kind).and_then(|stream| stream.interval(telemetry))
    }
}

/// The interval of a rate, Hz, us. Parameters lie within their ranges,
/// [`crate::parameters::table::Name::TelemetryRate`] above zero.
#[must_use]
pub fn interval_of_rate(rate: f32) -> u64 {
    (1e6 / rate) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How often each message comes in `seconds` of a line that takes one every 2 ms.
    fn counts(schedule: &mut Schedule, seconds: u64) -> Vec<(Kind, usize)> {
        let sent: Vec<Kind> = (0..seconds * 500).filter_map(|step| schedule.next_due(40_000, step * 2_000)).collect();
        STREAMS.iter().map(|(kind, _)| (*kind, sent.iter().filter(|other| *other == kind).count())).collect()
    }

    fn count(counts: &[(Kind, usize)], kind: Kind) -> usize {
        counts.iter().find(|(other, _)| *other == kind).unwrap().1
    }

    #[test]
    fn each_message_comes_at_its_rate_and_those_on_request_do_not() {
        for (kind, count) in counts(&mut Schedule::new(0), 10) {
            let rate = STREAMS.iter().find(|(other, _)| *other == kind).unwrap().1;
            let expected = match rate {
                Rate::OnRequest => 0,
                Rate::Every(interval) => 10_000_000 / interval as usize,
                Rate::Telemetry => 250,
            };
            assert!(count.abs_diff(expected) <= 1, "{kind:?}: {count}, {expected} expected");
        }
    }

    #[test]
    fn rates_are_changed_stopped_and_put_back() {
        let mut schedule = Schedule::new(0);
        schedule.ask(Kind::Odometry, 20_000, 0);
        schedule.ask(Kind::Attitude, -1, 0);
        schedule.ask(Kind::GlobalOrigin, 1_000_000, 0);
        schedule.ask(Kind::Position, 1, 0);
        let changed = counts(&mut schedule, 2);
        assert!(count(&changed, Kind::Odometry).abs_diff(100) <= 1);
        assert_eq!((count(&changed, Kind::Attitude), count(&changed, Kind::GlobalOrigin)), (0, 2));
        // No faster than a hundred a second.
        assert!(count(&changed, Kind::Position).abs_diff(200) <= 1);
        assert_eq!(schedule.interval_of(Kind::Attitude, 40_000), None);
        schedule.ask(Kind::Attitude, 0, 0);
        assert_eq!(schedule.interval_of(Kind::Attitude, 40_000), Some(100_000));
    }

    #[test]
    fn every_message_is_known_by_its_number() {
        for (kind, _) in STREAMS {
            assert_eq!(of_number(kind.number()).unwrap().number(), kind.number());
        }
        assert_eq!(of_number(148), Some(Kind::AutopilotVersion));
        assert_eq!(of_number(9_999), None);
    }

    #[test]
    fn the_default_rates_fit_a_slow_line() {
        let bytes = |signature: usize| -> u64 {
            let of_one = |(kind, rate): &(Kind, Rate)| {
                let interval = match rate {
                    Rate::OnRequest => return 0,
                    Rate::Every(interval) => *interval,
                    Rate::Telemetry => 40_000,
                };
                (kind.bytes_at_most() + signature) as u64 * 1_000_000 / interval
            };
            STREAMS.iter().map(of_one).sum()
        };
        assert!(bytes(0) < 4_600, "{} bytes a second", bytes(0));
        assert!(bytes(13) < 5_700, "{} bytes a second, signed", bytes(13));
    }
}
