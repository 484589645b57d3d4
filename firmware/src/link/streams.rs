//! What is sent by the clock, and how often: a table that a ground station may change.

use super::telemetry::kind::Kind;
use crate::parameters::table::Name;

/// How often a message goes out unless somebody says otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rate {
    /// Only when it is asked for.
    OnRequest,
    /// Every so many us.
    Every(u64),
    /// As often as [`Name::TelemetryRate`] says.
    Telemetry,
}

/// The messages, those first that matter most. At the default rates they take 4 KB/s of a line's 5.7 KB/s at 57,600 baud.
#[rustfmt::skip]
pub const STREAMS: [(Kind, Rate); 18] = [
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
    (Kind::HomePosition,       Rate::Every(2_000_000)),
    (Kind::SystemTime,         Rate::Every(2_000_000)),
    (Kind::GlobalOrigin,       Rate::OnRequest),
    (Kind::AutopilotVersion,   Rate::OnRequest),
    (Kind::ProtocolVersion,    Rate::OnRequest),
];

/// The shortest interval that is granted, us: a control tick.
const SHORTEST: u64 = 10_000;

/// When each message is due.
#[derive(Debug)]
pub struct Schedule {
    due: [u64; STREAMS.len()],
    /// What was asked for in the table's place, us; never for [`u64::MAX`].
    asked: [Option<u64>; STREAMS.len()],
}

/// The message of this number, if it can be sent.
#[must_use]
pub fn of_number(number: u32) -> Option<Kind> {
    STREAMS.iter().map(|(kind, _)| *kind).find(|kind| kind.number() == number)
}

impl Schedule {
    /// Everything is due at `now`, us.
    #[must_use]
    pub fn new(now: u64) -> Self {
        Self { due: [now; STREAMS.len()], asked: [None; STREAMS.len()] }
    }

    /// The first message that is due at `now`, us, where telemetry goes out every `telemetry` us; it is then due an interval later, or
    /// an interval from now if that has passed as well.
    pub fn next_due(&mut self, telemetry: u64, now: u64) -> Option<Kind> {
        let index = (0..STREAMS.len()).find(|&index| {
            self.interval(index, telemetry).is_some() && self.due.get(index).is_some_and(|due| now >= *due)
        })?;
        let interval = self.interval(index, telemetry)?;
        let due = self.due.get_mut(index)?;
        let next = due.saturating_add(interval);
        *due = if next > now { next } else { now.saturating_add(interval) };
        STREAMS.get(index).map(|(kind, _)| *kind)
    }

    /// When something is due next, us.
    #[must_use]
    pub fn next(&self, telemetry: u64) -> u64 {
        let running = (0..STREAMS.len()).filter(|&index| self.interval(index, telemetry).is_some());
        running.filter_map(|index| self.due.get(index).copied()).min().unwrap_or(u64::MAX)
    }

    /// Sends a message every `interval` us from now on, as SET_MESSAGE_INTERVAL says it: 0 is the table's rate, below that never.
    pub fn ask(&mut self, kind: Kind, interval: i64, now: u64) {
        for (index, (listed, _)) in STREAMS.iter().enumerate() {
            if let (true, Some(asked), Some(due)) =
                (*listed == kind, self.asked.get_mut(index), self.due.get_mut(index))
            {
                *asked = match u64::try_from(interval) {
                    Ok(0) => None,
                    Ok(interval) => Some(interval.max(SHORTEST)),
                    Err(_) => Some(u64::MAX),
                };
                *due = now;
            }
        }
    }

    /// How often a message goes out, us; none if only on request.
    #[must_use]
    pub fn interval_of(&self, kind: Kind, telemetry: u64) -> Option<u64> {
        (0..STREAMS.len())
            .find(|&index| STREAMS.get(index).is_some_and(|(listed, _)| *listed == kind))
            .and_then(|index| self.interval(index, telemetry))
    }

    fn interval(&self, index: usize, telemetry: u64) -> Option<u64> {
        let asked = self.asked.get(index).copied().flatten();
        let interval = asked.or_else(|| match STREAMS.get(index)?.1 {
            Rate::OnRequest => None,
            Rate::Every(interval) => Some(interval),
            Rate::Telemetry => Some(telemetry),
        });
        interval.filter(|&interval| interval < u64::MAX)
    }
}

/// The interval of a rate in Hz, which lies within that parameter's range, us.
#[must_use]
pub fn interval_of_rate(rate: f32) -> u64 {
    debug_assert!(Name::TelemetryRate.row().allows(rate));
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
        // No faster than control ticks.
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
        let bytes: u64 = STREAMS
            .iter()
            .map(|(kind, rate)| {
                let interval = match rate {
                    Rate::OnRequest => return 0,
                    Rate::Every(interval) => *interval,
                    Rate::Telemetry => 40_000,
                };
                kind.bytes_at_most() as u64 * 1_000_000 / interval
            })
            .sum();
        assert!(bytes < 4_600, "{bytes} bytes a second");
    }
}
