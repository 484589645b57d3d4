//! The figures of a flight, of the true motion: height lost, overshoot, settling time, activity of the rotors.
//!
//! With x the position, x_d the reference's, at the ticks k = 0 … n - 1:
//!
//! | figure | |
//! |---|---|
//! | height lost | start minus lowest height |
//! | rise | greatest height above the start and above the reference |
//! | excursion | greatest \|x - x_d\| |
//! | settled | since when \|x - x_d\| has been within a distance, off the ground, for good |
//! | turned | since when the yaw has been within 0.1 rad of the reference's, for good |
//! | end error | \|x - x_d\| at the last tick |
//! | RMS | of \|x - x_d\| over the last half of the flight |
//! | activity | RMS of the change of a rotor's commanded thrust within 10 ms (a tick, if longer), over the last half |

use crate::flight::{Flight, FlightError, Tick};
use controller_core::allocation::Thrusts;
use scenario::Scenario;
use std::collections::VecDeque;

/// How near the yaw is to be.
const YAW_TOLERANCE_RAD: f64 = 0.1;

/// A flight's course.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// m.
    pub height_lost: f64,
    /// m; negative where it never rose above both.
    pub rise: f64,
    /// m.
    pub excursion: f64,
    /// s; none if it was further away at the last tick.
    pub settled: Option<f64>,
    /// s; none if it was further off at the last tick.
    pub turned: Option<f64>,
    /// m.
    pub end_error: f64,
    /// m.
    pub rms: f64,
    /// N; zero without rotors.
    pub activity: f64,
    /// Ticks at which something of a command was cut.
    pub clipped: u64,
    /// |yaw error| at the last tick, rad.
    pub yaw_error: f64,
}

/// Of the last half: the sum of squares of distances, of how many, and the rotors' activity.
#[derive(Debug, Clone)]
struct LastHalf {
    squares: f64,
    ticks: u64,
    activity: Activity,
}

/// The time within which a rotor's command changes: the same for laws of every rate.
const COMMAND_CHANGE_PERIOD_US: u64 = 10_000;

/// How much rotors' commands change within `COMMAND_CHANGE_PERIOD_US`.
#[derive(Debug, Clone)]
pub struct Activity {
    /// Commands that are younger, N, and how many that may be.
    past: VecDeque<Thrusts>,
    ticks: usize,
    /// Sum of squares of changes, N^2, and how many.
    squares: f64,
    changes: usize,
}

impl Activity {
    /// Of commands that are `period_us` apart.
    #[must_use]
    pub fn new(period_us: u64) -> Self {
        Self {
            past: VecDeque::new(),
            ticks: (COMMAND_CHANGE_PERIOD_US / period_us).max(1) as usize,
            squares: 0.0,
            changes: 0,
        }
    }

    /// Takes a tick's commands, N.
    pub fn observe(&mut self, thrusts: &Thrusts) {
        if self.past.len() == self.ticks
            && let Some(then) = self.past.pop_front()
        {
            let changes = thrusts.iter().zip(&then).map(|(now, then)| f64::from(now - then).powi(2));
            self.squares += changes.sum::<f64>();
            self.changes += thrusts.len();
        }
        self.past.push_back(thrusts.clone());
    }

    /// RMS of the changes, N.
    #[must_use]
    pub fn rms(&self) -> f64 {
        (self.squares / self.changes.max(1) as f64).sqrt()
    }
}

impl Course {
    /// Flies a whole `flight` of `scenario`; settled is within `near`, m.
    ///
    /// # Errors
    /// If it cannot be flown to its end.
    pub fn fly(scenario: &Scenario, flight: Flight, near: f64) -> Result<Self, FlightError> {
        Self::until_settled(scenario, flight, near, f64::INFINITY)
    }

    /// Likewise, to the end or until position and yaw have been settled for `rest`, s. What has long settled stays so
    /// where nothing acts on it.
    ///
    /// # Errors
    /// As [`Self::fly`].
    pub fn until_settled(scenario: &Scenario, mut flight: Flight, near: f64, rest: f64) -> Result<Self, FlightError> {
        let ticks = scenario.timing.ticks;
        let start = scenario.initial.position.z;
        let mut course = Self {
            height_lost: 0.0,
            rise: f64::NEG_INFINITY,
            excursion: 0.0,
            settled: Some(0.0),
            turned: Some(0.0),
            end_error: 0.0,
            rms: 0.0,
            activity: 0.0,
            clipped: 0,
            yaw_error: 0.0,
        };
        let mut last_half = LastHalf { squares: 0.0, ticks: 0, activity: Activity::new(scenario.timing.period_us) };
        for number in 0..ticks {
            let tick = flight.tick()?;
            course.observe(&tick, start, near, scenario.timing.period_us);
            if 2 * number >= ticks {
                last_half.observe(&tick, course.end_error);
            }
            let now = (tick.time_us + scenario.timing.period_us) as f64 / 1e6;
            let since = course.settled.into_iter().chain(course.turned).fold(0.0, f64::max);
            if now - since >= rest {
                break;
            }
        }
        let end = (ticks * scenario.timing.period_us) as f64 / 1e6;
        course.settled = course.settled.filter(|since| *since < end);
        course.turned = course.turned.filter(|_| course.yaw_error <= YAW_TOLERANCE_RAD);
        course.rms = (last_half.squares / last_half.ticks.max(1) as f64).sqrt();
        course.activity = last_half.activity.rms();
        Ok(course)
    }

    fn observe(&mut self, tick: &Tick, start: f64, near: f64, period_us: u64) {
        let (position, wanted) = (&tick.state.position, tick.reference.position.map(f64::from));
        let error = (position - wanted).norm();
        self.height_lost = self.height_lost.max(start - position.z);
        self.rise = self.rise.max(position.z - start.max(wanted.z));
        self.excursion = self.excursion.max(error);
        self.end_error = error;
        self.clipped += u64::from(tick.clipped);
        let next = (tick.time_us + period_us) as f64 / 1e6;
        if error > near || tick.surroundings.standing {
            self.settled = Some(next);
        }
        self.yaw_error = tick.state.heading_error(&tick.reference.heading);
        if self.yaw_error > YAW_TOLERANCE_RAD {
            self.turned = Some(next);
        }
    }
}

impl LastHalf {
    fn observe(&mut self, tick: &Tick, error: f64) {
        self.squares += error * error;
        self.ticks += 1;
        self.activity.observe(&tick.rotor_thrusts);
    }
}

#[cfg(test)]
mod tests;
