//! How regular the flight controller's commands are, by its own clock.

use std::fmt;

/// Counts commands and the times between them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HilPace {
    period: u64,
    ticks: u64,
    last: Option<u64>,
    /// Shortest and longest time between two commands, us.
    range: Option<(u64, u64)>,
    missed: u64,
}

impl HilPace {
    /// Commands that should come every `period` microseconds.
    #[must_use]
    pub fn new(period: u64) -> Self {
        Self { period, ticks: 0, last: None, range: None, missed: 0 }
    }

    /// A command has come that says it was given at `time`, us.
    pub fn take(&mut self, time: u64) {
        if let Some(last) = self.last {
            let gap = time.saturating_sub(last);
            let (least, greatest) = self.range.unwrap_or((gap, gap));
            self.range = Some((least.min(gap), greatest.max(gap)));
            // A gap of almost two periods is one tick left out.
            self.missed += ((gap + self.period / 2) / self.period).saturating_sub(1);
        }
        self.last = Some(time);
        self.ticks += 1;
    }

    /// Commands so far.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.ticks
    }
}

impl fmt::Display for HilPace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (least, greatest) = self.range.unwrap_or_default();
        let Self { ticks, missed, .. } = self;
        write!(f, "{ticks} ticks, {least} to {greatest} us apart by the flight controller's clock, {missed} missed")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steady_pace_has_no_jitter() {
        let mut pace = HilPace::new(10_000);
        (0..5).for_each(|k| pace.take(123 + k * 10_000));
        assert_eq!((pace.ticks(), pace.missed, pace.range), (5, 0, Some((10_000, 10_000))));
    }

    #[test]
    fn a_command_left_out_is_missed_and_a_late_one_is_not() {
        let mut pace = HilPace::new(10_000);
        [0, 10_400, 20_000, 40_000].into_iter().for_each(|time| pace.take(time));
        assert_eq!((pace.ticks(), pace.missed, pace.range), (4, 1, Some((9_600, 20_000))));
    }
}
