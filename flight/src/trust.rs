//! Whether a source of poses may still be believed in this flight.
//!
//! One refused pose proves nothing, and a lost body may be found again. A source whose poses are refused and found
//! again over and over lies. Evidence against it is counted in seconds of doubt, which decays slowly:
//!
//! | what happens in flight | doubt |
//! |---|---|
//! | poses are refused for their values | for as long as that lasts |
//! | poses are believed, and turn as the gyro's bias cannot explain | for as long as that lasts |
//! | the estimate is reset to where the body was found again | [`REFOUND_DOUBT_S`] more |
//! | the sender's frame moves | [`FRAME_MOVED_DOUBT_S`] more |
//! | poses that were lost are flown again | [`REGAINED_DOUBT_S`] more; [`RESUMED_DOUBT_S`] where a landing resumes |
//! | poses are believed | [`DOUBT_DECAY_SHARE`] of that time less |
//!
//! At [`DOUBT_MAX_S`] the source is given up until the vehicle is disarmed.

use estimation::estimator::{Accepted, COASTING_AFTER_US, Rejected};

/// Doubt at which a source is given up.
pub const DOUBT_MAX_S: f32 = 3.0;

/// What adds to the doubt beside the time of refusals.
const REFOUND_DOUBT_S: f32 = 0.7;
const FRAME_MOVED_DOUBT_S: f32 = 0.3;
const REGAINED_DOUBT_S: f32 = 1.1;
const RESUMED_DOUBT_S: f32 = 1.6;

/// The decay of doubt in a second of believed poses, s.
const DOUBT_DECAY_SHARE: f32 = 0.03;

/// The time that one pose accounts for.
const POSE_INTERVAL_MAX_US: u64 = 100_000;

/// The evidence against a source of poses.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Trust {
    /// s.
    doubt: f32,
    /// When the last poses were judged, us.
    judged: u64,
    is_given_up: bool,
    /// From when on poses have been refused for their values, and until when, us; none once one is believed.
    refused: Option<(u64, u64)>,
}

impl Trust {
    /// Takes note of what became of a tick's poses, in flight. Where the gyro's bias is not `plausible` with them, they
    /// turn as the vehicle does not, and are no better than refused.
    pub fn judge(&mut self, pose: Option<Result<Accepted, Rejected>>, plausible: bool, now: u64) {
        let Some(pose) = pose else { return };
        let seconds = now.saturating_sub(self.judged).min(POSE_INTERVAL_MAX_US) as f32 * 1e-6;
        self.judged = now;
        self.doubt(match pose {
            Err(rejected) if rejected.is_lie() => seconds,
            Ok(Accepted::Refound) => REFOUND_DOUBT_S,
            Ok(Accepted::Rebased) => FRAME_MOVED_DOUBT_S,
            Ok(taken) if taken.is_believed() && plausible => -DOUBT_DECAY_SHARE * seconds,
            Ok(taken) if taken.is_believed() => seconds,
            Ok(_) | Err(_) => 0.0,
        });
    }

    /// Notes a pose that is refused for its values, or believed.
    pub fn note(&mut self, pose: Result<Accepted, Rejected>, now: u64) {
        match pose {
            Ok(taken) if taken.is_believed() => self.refused = None,
            Err(rejected) if rejected.is_lie() => {
                self.refused = Some((self.refused.map_or(now, |(first, _)| first), now));
            }
            Ok(_) | Err(_) => {}
        }
    }

    /// Whether poses have lied: one outlier before an outage is no lie.
    pub fn has_lied(&self) -> bool {
        self.is_given_up || self.refused.is_some_and(|(first, last)| last.saturating_sub(first) >= COASTING_AFTER_US)
    }

    /// Whether poses lied before `levelled`, us, or still did then: what they agree on later is no better.
    pub fn lied_until(&self, levelled: u64) -> bool {
        self.has_lied() || self.refused.is_some_and(|(_, last)| levelled.saturating_sub(last) <= COASTING_AFTER_US)
    }

    /// Whether poses that were lost may be flown again, by a landing or not; if so, they are.
    pub fn regain(&mut self, landing: bool) -> bool {
        self.doubt(if landing { RESUMED_DOUBT_S } else { REGAINED_DOUBT_S });
        !self.is_given_up
    }

    fn doubt(&mut self, more: f32) {
        self.doubt = (self.doubt + more).max(0.0);
        self.is_given_up |= self.doubt >= DOUBT_MAX_S;
    }

    /// The source is given up.
    pub fn give_up(&mut self) {
        self.is_given_up = true;
    }

    /// Whether it is.
    pub fn is_given_up(&self) -> bool {
        self.is_given_up
    }
}

#[cfg(test)]
mod tests;
