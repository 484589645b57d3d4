//! The vehicle's time against real time.
//!
//! Time passes in slices of a millisecond of the desk's. A desk that is too slow, or was asleep, does not catch up with
//! more than `LAG_MAX`: clients would see a vehicle that leaps.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// The slice of the desk's time, and the shortest slice of the vehicle's.
const SLICE_US: f64 = 1_000.0;

/// The most that is caught up with.
const LAG_MAX: Duration = Duration::from_millis(200);

/// The most by which a vehicle is late that keeps up.
const KEEPS_UP: Duration = Duration::from_millis(1);

/// The relation of the two clocks.
#[derive(Debug)]
pub struct Pace {
    speed: f64,
    start: Instant,
    /// The vehicle's time at the start, us.
    from: u64,
}

impl Pace {
    /// A vehicle whose time passes `speed` times as fast, from zero now.
    #[must_use]
    pub fn new(speed: f64) -> Self {
        Self { speed, start: Instant::now(), from: 0 }
    }

    /// The end of the slice that begins at `now`, us of the vehicle's time.
    #[must_use]
    pub fn next(&self, now: u64) -> u64 {
        now + (SLICE_US * self.speed.max(1.0)) as u64
    }

    /// Waits until the vehicle's time may be `time`, us. Whether it keeps up with the desk's.
    pub fn wait(&mut self, time: u64) -> bool {
        let (due, passed) = (self.due(time), self.start.elapsed());
        if let Some(early) = due.checked_sub(passed) {
            std::thread::sleep(early);
        } else if passed - due > LAG_MAX {
            (self.start, self.from) = (Instant::now(), time);
        } else {
            return passed - due <= KEEPS_UP;
        }
        true
    }

    /// When by the desk's clock the vehicle's time was to be `time`, us: s since 1970.
    #[must_use]
    pub fn desk_time(&self, time: u64) -> f64 {
        // A clock before 1970 is as good as that.
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        now.as_secs_f64() - (self.start.elapsed().as_secs_f64() - self.due(time).as_secs_f64())
    }

    /// The time since the start at which the vehicle's is `time`, us.
    fn due(&self, time: u64) -> Duration {
        Duration::from_secs_f64(time.saturating_sub(self.from) as f64 * 1e-6 / self.speed)
    }
}
