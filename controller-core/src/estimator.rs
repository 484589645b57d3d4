//! The estimator: a state to fly on, from an IMU and from poses that come late, noisy, in gaps and sometimes wrong.
//!
//! An error-state Kalman filter on position, velocity, attitude, gyro bias and accelerometer bias. It stands at the *horizon*, the
//! time of the last pose: a pose is compared with where the vehicle was at the pose's own time, not with where it is. From
//! there the nominal state is carried on through the IMU's increments, which are kept in a ring, to the present.
//!
//! ```text
//!                       ring of IMU increments, 320 ms
//!   ├──────┬──────┬──────┬──────┬──────┬──────┬──────┬──────┬──────┤ . . . . now
//!                    ^ horizon: filter      ^ pose arrives for here          ^ state() extrapolates
//!                    nominal, covariance -> advance, test, fuse -> nominal alone, to the end
//! ```
//!
//! - `nominal`: the state's motion, exact in rotation; attitude errors have no singularity;
//! - [`covariance`]: its error's, in blocks;
//! - [`filter`]: both together: advance, weigh a pose, fuse it;
//! - [`history`]: the ring; [`settings`]: what the sensors are like;
//! - `checkpoints`: poses out of order; `stream`: time stamps, quality, frozen streams;
//! - `candidate`: how an estimate begins, at rest or in motion, and how a lost body is found again;
//! - [`verdict`], [`health`]: what became of each pose, and what the estimate is worth, in words.
//!
//! # How a tick uses it
//!
//! The IMU task hands over [`Increment`]s, made by [`crate::imu`] from the samples since the last one; whoever receives poses
//! hands them over with the time at which they were true, on the vehicle's clock. Once a control tick:
//!
//! ```text
//! for increment in new increments { estimator.imu(&increment) }
//! for pose in new poses { report(estimator.pose(&pose, now)) }
//! let health = estimator.health(now);                   // arming, coasting and levelling are decided from this
//! if let Some(estimated) = estimator.state(now) { law.step(&estimated.state, …) }
//! ```
//!
//! Without poses the state goes on, by IMU alone, for as long as anybody asks; [`health`](Estimator::health) says for how long
//! that has been so and how uncertain it has become. A pose stream that jumps, turns or drifts against the IMU is not followed.
//! Its poses are refused, with the reason, until they are again where coasting may have led; [`Estimator::adopt`] follows it
//! all the same: on the ground, say.
//!
//! Every step is bounded: an increment costs one step of the nominal state; a pose the increments since the last pose, with
//! covariance, and those since its own time, without.

pub mod covariance;
pub mod filter;
pub mod health;
pub mod history;
pub mod settings;
pub mod verdict;

mod candidate;
mod checkpoints;
mod measurement;
mod nominal;
mod stream;

pub use health::{Faults, Health};
pub use history::Increment;
pub use measurement::PoseMeasurement;
pub use nominal::Nominal;
pub use settings::{EstimatorParameters, Settings};
pub use verdict::{Fault, Rejected, Taken};

use crate::flight::{STAMP_LEAD_MAX, Stamped};
use crate::state::State;
use candidate::Candidate;
use checkpoints::Checkpoints;
use filter::{Biases, Filter};
use health::Statistics;
use heapless::Vec;
use history::History;
use measurement::PoseMeasurement as Pose;
use nalgebra::{Quaternion, Vector3};
use stream::Stream;

/// How far beyond the last increment a state is extrapolated, and the longest increment, us.
pub const EXTRAPOLATION_MAX: u64 = 20_000;

/// The age of the last pose that was fused at which the estimate counts as coasting, us: poses of 10 Hz that come 150 ms late,
/// and their jitter.
pub const COASTING_AFTER: u64 = 300_000;

/// How long after a move of the sender's frame the next one is believed, us: a counter that runs is no frame that moves.
pub const REBASE_EVERY: u64 = 1_000_000;

/// The cosine of the greatest angle between the accelerometer's up and a pose's, or that of a frame before and after it moved:
/// 10 degrees.
const TILT_COSINE: f32 = 0.984_807_8;

/// Poses that may wait for the IMU.
const WAITING: usize = 4;

/// The state at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimatedState {
    /// For the law. The body rate is the low-passed one, less its bias.
    pub state: State,
    /// v', m/s^2, world: the mean over the last increment, by accelerometer.
    pub acceleration: Vector3<f32>,
    /// How often the state has jumped since the start: each [`Taken::Rebased`], [`Taken::Refound`] and [`Estimator::adopt`]. Who
    /// differentiates the state, begins anew when it changes.
    pub jumps: u32,
}

/// The estimator. Size: about 11 KB.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimator {
    settings: Settings,
    history: History,
    filter: Option<Filter>,
    /// The nominal state at the end of the history.
    latest: Option<Nominal>,
    /// What is known of the biases while there is no filter.
    biases: Biases,
    checkpoints: Checkpoints,
    candidate: Option<Candidate>,
    stream: Stream,
    waiting: Vec<Stamped<Pose>, WAITING>,
    /// The sender's reset counter when the filter last followed it, and when that was, us.
    frame: Option<(u8, u64)>,
    statistics: Statistics,
}

impl Estimator {
    /// One that knows nothing yet.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        Self {
            settings: *settings,
            history: History::EMPTY,
            filter: None,
            latest: None,
            biases: Biases::unknown(settings),
            checkpoints: Checkpoints::EMPTY,
            candidate: None,
            stream: Stream::EMPTY,
            waiting: Vec::new(),
            frame: None,
            statistics: Statistics::NONE,
        }
    }

    /// Takes what the IMU did, which begins where the last increment ended. After a gap, or an increment with numbers that cannot be,
    /// everything begins anew, with the biases as they were: nothing carries a state over what nobody measured.
    pub fn imu(&mut self, increment: &Increment) {
        let follows = self.history.newest().is_none_or(|newest| newest.end == increment.start);
        if !follows || !increment.is_usable(EXTRAPOLATION_MAX) {
            self.restart();
        }
        if !increment.is_usable(EXTRAPOLATION_MAX) {
            return;
        }
        if let Some(leaving) = self.history.leaving() {
            let end = leaving.end;
            let candidate = self.candidate.as_mut().map(|candidate| &mut candidate.filter);
            for filter in self.filter.as_mut().into_iter().chain(candidate) {
                filter.advance(end, &self.history, &self.settings);
            }
            self.checkpoints.forget_before(end);
        }
        self.history.push(increment);
        self.stream.note(self.moves(increment));
        if let Some(latest) = &mut self.latest {
            latest.advance(increment, self.settings.parameters().gravity);
        }
        self.take_waiting(increment.end);
    }

    /// Takes a pose that was true at its time stamp and arrives at `now`, us.
    ///
    /// # Errors
    /// Says why it is not believed; the state is as it was.
    pub fn pose(&mut self, pose: &Stamped<Pose>, now: u64) -> Result<Taken, Rejected> {
        let verdict = self.stream.admit(pose, now).and_then(|()| self.take_in_time(pose));
        self.statistics.record(verdict, pose.time);
        verdict
    }

    /// The state at `now`, us; none before the first, beyond [`EXTRAPOLATION_MAX`] after the last increment, and before it.
    #[must_use]
    pub fn state(&self, now: u64) -> Option<EstimatedState> {
        let (latest, last) = (self.latest.as_ref()?, self.history.newest()?);
        let ahead = self.imu_age(now).filter(|&age| age <= EXTRAPOLATION_MAX)?;
        let per_second = 1.0 / last.seconds();
        let bent = last.delta_angle.cross(&last.delta_velocity) * 0.5;
        let force = (last.delta_velocity - bent) * per_second;
        let seconds = ahead as f32 * 1e-6;
        let increment = Increment {
            start: last.end,
            end: last.end + ahead,
            delta_angle: last.delta_angle * (per_second * seconds),
            delta_velocity: force * seconds,
            angular_velocity: last.angular_velocity,
        };
        let (mut nominal, gravity) = (*latest, self.settings.parameters().gravity);
        let mut acceleration = rotated(&nominal.attitude, &(force - nominal.accelerometer_bias));
        acceleration.z -= gravity;
        nominal.advance(&increment, gravity);
        let Nominal { position, velocity, attitude, gyro_bias, .. } = nominal;
        let angular_velocity = last.angular_velocity - gyro_bias;
        let state = State { position, velocity, attitude, angular_velocity };
        Some(EstimatedState { state, acceleration, jumps: self.statistics.jumps })
    }

    /// What the estimate is worth at `now`, us.
    #[must_use]
    pub fn health(&self, now: u64) -> Health {
        let imu_age = self.imu_age(now).unwrap_or(u64::MAX);
        Health::new(self.filter.as_ref(), &self.statistics, &self.settings, imu_age, now)
    }

    /// The filter at its horizon, if there is one: nominal state, covariance and time.
    #[must_use]
    pub fn filter(&self) -> Option<&Filter> {
        self.filter.as_ref()
    }

    /// Follows the poses to where they have jumped, turned or drifted, if they have proven to agree among themselves and with the
    /// IMU; whether there was such a place. The estimate jumps.
    pub fn adopt(&mut self) -> bool {
        match self.candidate.take_if(|candidate| candidate.is_proven()) {
            Some(candidate) if candidate.check_gravity(&self.settings).is_ok() => {
                self.follow(&candidate.filter);
                self.statistics.jumps += 1;
                true
            }
            _ => false,
        }
    }

    /// How long ago the last increment ended, us; none before the first, or if the clock has run back since.
    fn imu_age(&self, now: u64) -> Option<u64> {
        let end = self.history.newest()?.end;
        (end <= now.saturating_add(STAMP_LEAD_MAX)).then(|| now.saturating_sub(end))
    }

    /// Takes a pose if the IMU has got that far, or keeps it.
    fn take_in_time(&mut self, pose: &Stamped<Pose>) -> Result<Taken, Rejected> {
        let (start, end) = self.history.span().ok_or(Rejected::NoImu)?;
        if pose.time < start {
            Err(Rejected::TooOld)
        } else if pose.time <= end {
            self.take(pose)
        } else if pose.time - end > EXTRAPOLATION_MAX {
            Err(Rejected::NoImu)
        } else {
            self.waiting.push(*pose).map_or(Err(Rejected::NoImu), |()| Ok(Taken::Waiting))
        }
    }

    /// Takes the poses that have waited for the IMU to get to `end`, us.
    fn take_waiting(&mut self, end: u64) {
        for pose in core::mem::take(&mut self.waiting) {
            if pose.time <= end {
                let verdict = self.take(&pose);
                self.statistics.record(verdict, pose.time);
            } else {
                // It was there before: it fits.
                let _ = self.waiting.push(pose);
            }
        }
    }

    fn take(&mut self, pose: &Stamped<Pose>) -> Result<Taken, Rejected> {
        let Some(filter) = self.filter else {
            return self.seek(pose, None);
        };
        let verdict = if pose.time < filter.time { self.fuse_late(pose) } else { self.fuse_next(&filter, pose) };
        match verdict {
            Err(Rejected::NotFinite) => self.restart(),
            Ok(_) => self.carry_on(),
            Err(_) => {}
        }
        verdict
    }

    /// A pose later than the horizon.
    fn fuse_next(&mut self, before: &Filter, pose: &Stamped<Pose>) -> Result<Taken, Rejected> {
        let mut filter = *before;
        filter.advance(pose.time, &self.history, &self.settings);
        self.filter = Some(filter);
        if self.is_moved_frame(pose) {
            return self.rebase(filter, pose);
        }
        match self.fuse(&mut filter, pose) {
            Ok(()) => {
                self.checkpoints.push(before, pose);
                self.filter = Some(filter);
                self.candidate = None;
                Ok(Taken::Fused)
            }
            Err(Rejected::NotFinite) => Err(Rejected::NotFinite),
            Err(why) => self.seek(pose, Some(why)),
        }
    }

    /// A pose that belongs before the horizon: the poses after its time are taken back, and fused again after it.
    fn fuse_late(&mut self, pose: &Stamped<Pose>) -> Result<Taken, Rejected> {
        let (mut filter, later) = self.checkpoints.rewind(pose.time).ok_or(Rejected::TooOld)?;
        let mut verdict = Err(Rejected::TooOld);
        for (number, next) in core::iter::once(pose).chain(later.iter().rev()).enumerate() {
            let before = filter;
            filter.advance(next.time, &self.history, &self.settings);
            let fused = self.fuse(&mut filter, next);
            if fused.is_ok() {
                self.checkpoints.push(&before, next);
            }
            if number == 0 || fused == Err(Rejected::NotFinite) {
                verdict = fused.map(|()| Taken::Fused);
            }
        }
        self.filter = Some(filter);
        // Where the poses after it no longer count, the state has changed all the same.
        self.carry_on();
        verdict
    }

    /// Weighs a pose, and takes it into account if it is within its gates.
    fn fuse(&mut self, filter: &mut Filter, pose: &Stamped<Pose>) -> Result<(), Rejected> {
        let tested = filter.test(&pose.value, &self.settings)?;
        self.statistics.weigh(tested.nis());
        tested.gate()?;
        filter.fuse(&pose.value, &tested)
    }

    /// Whether the sender says that its frame has moved, and can be believed.
    fn is_moved_frame(&mut self, pose: &Stamped<Pose>) -> bool {
        let (resets, since) = *self.frame.get_or_insert((pose.value.resets, 0));
        resets != pose.value.resets && pose.time.saturating_sub(since) >= REBASE_EVERY
    }

    fn rebase(&mut self, mut filter: Filter, pose: &Stamped<Pose>) -> Result<Taken, Rejected> {
        let moved = pose.value.attitude * filter.nominal.attitude.conjugate();
        if 1.0 - 2.0 * (moved.i * moved.i + moved.j * moved.j) < TILT_COSINE {
            return Err(Rejected::Gravity);
        }
        filter.rebase(&pose.value, &self.settings);
        self.follow(&filter);
        self.frame = Some((pose.value.resets, pose.time));
        self.statistics.jumps += 1;
        Ok(Taken::Rebased)
    }

    /// Tries a pose on the candidate: without a filter, or where the filter does not believe the pose for the reason given.
    fn seek(&mut self, pose: &Stamped<Pose>, why: Option<Rejected>) -> Result<Taken, Rejected> {
        let unproven = why.map_or(Ok(Taken::Aligning), Err);
        self.check_up(&pose.value)?;
        let biases = self.filter.as_ref().map_or(self.biases, Filter::biases);
        let fresh = Candidate::new(pose.time, &pose.value, &biases, &self.settings);
        let candidate = self.candidate.get_or_insert_with(|| fresh.clone());
        if pose.time < candidate.filter.time {
            return Err(Rejected::TooOld);
        }
        if pose.time > candidate.filter.time {
            let taken = candidate.take(pose.time, &pose.value, &self.history, &self.settings);
            if let Err(error) = candidate.check_gravity(&self.settings).and(taken) {
                *candidate = fresh;
                return Err(why.unwrap_or(error));
            }
        }
        if !candidate.is_proven() {
            return unproven;
        }
        let found = candidate.filter;
        if let Some(filter) = &self.filter {
            candidate.compare(filter, pose.time.saturating_sub(self.statistics.fused_at))?;
        }
        let taken = if self.filter.is_some() { Taken::Refound } else { Taken::Started };
        self.statistics.jumps += u32::from(taken == Taken::Refound);
        self.frame = Some((pose.value.resets, self.frame.map_or(0, |(_, since)| since)));
        self.follow(&found);
        Ok(taken)
    }

    /// Makes `filter` the one, whose past does not matter.
    fn follow(&mut self, filter: &Filter) {
        self.filter = Some(*filter);
        self.candidate = None;
        self.checkpoints.clear();
        self.statistics.forget_nis();
        self.carry_on();
    }

    /// Carries the nominal state from the horizon to the end of the history.
    fn carry_on(&mut self) {
        self.latest = self.filter.as_ref().map(|filter| {
            let (mut nominal, gravity) = (filter.nominal, self.settings.parameters().gravity);
            for increment in self.history.between(filter.time, u64::MAX) {
                nominal.advance(&increment, gravity);
            }
            nominal
        });
    }

    /// Begins anew, with the biases as they are if they are plausible.
    fn restart(&mut self) {
        let unknown = Biases::unknown(&self.settings);
        self.biases = match &self.filter {
            Some(filter) if filter.covariance.is_positive() => filter.biases(),
            _ => unknown,
        };
        self.history.clear();
        self.checkpoints.clear();
        self.waiting.clear();
        (self.filter, self.latest, self.candidate) = (None, None, None);
        self.statistics = self.statistics.restarted();
    }

    /// Whether up is where the accelerometer says, as far as one increment can tell: of a vehicle at rest.
    fn check_up(&self, pose: &Pose) -> Result<(), Rejected> {
        let Some(newest) = self.history.newest().filter(|newest| !self.moves(newest)) else { return Ok(()) };
        let force = rotated(&pose.attitude, &newest.delta_velocity);
        let cosine = force.z / crate::math::sqrt(force.norm_squared());
        if cosine < TILT_COSINE { Err(Rejected::Gravity) } else { Ok(()) }
    }

    /// Whether an increment is of a vehicle that moves, beyond any noise at rest.
    fn moves(&self, increment: &Increment) -> bool {
        /// rad/s: six times a BMI088's noise over 5 ms.
        const RATE: f32 = 0.02;
        /// m/s^2: a plausible bias, and noise.
        const ACCELERATION: f32 = 0.5;
        let biases = self.filter.as_ref().map_or(self.biases, Filter::biases);
        let per_second = 1.0 / increment.seconds();
        let rate = increment.delta_angle * per_second - biases.gyro;
        let force = increment.delta_velocity * per_second - biases.accelerometer;
        let weight = crate::math::sqrt(force.norm_squared()) - self.settings.parameters().gravity;
        rate.norm_squared() > RATE * RATE || weight.abs() > ACCELERATION
    }
}

/// R(q) x.
fn rotated(q: &Quaternion<f32>, x: &Vector3<f32>) -> Vector3<f32> {
    nalgebra::UnitQuaternion::new_unchecked(*q) * x
}

#[cfg(test)]
mod tests;
