//! The estimator: a state to fly on, from an IMU and from poses that come late, noisy, in gaps and sometimes wrong.
//!
//! An error-state Kalman filter on position, velocity, attitude, gyro bias and accelerometer bias. It stands at the
//! *horizon*, the time of the last pose: a pose is compared with where the vehicle was at the pose's own time, not with
//! where it is. From there the nominal state is carried on through the IMU's increments, which are kept in a ring, to
//! the present.
//!
//! ```text
//!                       ring of IMU increments, 320 ms
//!   ├──────┬──────┬──────┬──────┬──────┬──────┬──────┬──────┬──────┤ . . . . now
//!                    ^ horizon: filter      ^ pose arrives for here          ^ state() extrapolates
//!                    nominal, covariance -> advance, test, fuse -> nominal alone, to the end
//! ```
//!
//! - `present`: the state for the law, without the rotors' vibration;
//! - `mean_acceleration`: that between two ticks, by accelerometer alone;
//! - `nominal`: the state's motion, exact in rotation; attitude errors have no singularity;
//! - [`covariance`]: its error's, in blocks;
//! - [`filter`]: both together: advance, weigh a pose, fuse it;
//! - [`history`]: the ring; [`settings`]: the sensors' noise;
//! - `checkpoints`: poses out of order; `stream`: time stamps, quality, frozen streams;
//! - `candidate`: how an estimate begins, at rest or in motion, and how a lost body is found again;
//! - `pose_fusion`: what becomes of a pose, step by step;
//! - [`verdict`], [`health`]: the verdict on each pose, and the estimate's health, in words.
//!
//! # How a tick uses it
//!
//! The IMU task hands over [`Increment`]s, made by [`crate::imu`] from the samples since the last one. The link hands
//! over poses with the time at which they were true, on the vehicle's clock. Once a control tick:
//!
//! ```text
//! for increment in new increments { estimator.imu(&increment) }
//! for pose in new poses { report(estimator.pose(&pose, now)) }
//! let health = estimator.health(now);                   // arming, coasting and levelling are decided from this
//! if let Some(estimated) = estimator.state(now, &newest_rate, under_way) { law.step(&estimated.state, …) }
//! ```
//!
//! Without poses the state goes on by IMU alone, without a timeout; [`health`](Estimator::health) reports the age of
//! the last pose and the uncertainty. A pose stream that jumps, turns or drifts against the IMU is not followed. Its
//! poses are refused, with the reason, until they are again where coasting may have led; [`Estimator::adopt`] follows
//! it all the same, as on the ground.
//!
//! Every step is bounded: an increment costs one step of the nominal state; a pose the increments since the last pose,
//! with covariance, and those since its own time, without.

pub mod covariance;
pub mod filter;
pub mod health;
pub mod history;
pub mod settings;
pub mod verdict;

mod candidate;
mod checkpoints;
mod mean_acceleration;
mod measurement;
mod nominal;
mod pose_fusion;
mod present;
mod stream;

pub use health::{COASTING_AFTER_US, Faults, Health};
pub use history::{Clipped, EXTRAPOLATION_MAX_US, Increment};
pub use measurement::PoseMeasurement;
pub use nominal::Nominal;
pub use present::VELOCITY_LATE_S;
pub use settings::{EstimatorParameters, Settings};
pub use verdict::{Accepted, Fault, Rejected};

use crate::measurement::{STAMP_LEAD_MAX_US, Stamped};
use candidate::Candidate;
use checkpoints::Checkpoints;
use controller_core::state::State;
use filter::{Biases, Filter};
use health::Statistics;
use heapless::Vec;
use history::{History, is_measurable};
use mean_acceleration::MeanAcceleration;
use measurement::PoseMeasurement as Pose;
use nalgebra::{Quaternion, Vector3};
use present::PresentMotion;
use stream::Stream;

/// How long after a move of the sender's frame the next one is believed, us: a running counter is no moving frame.
/// Longer than the vehicle flies without a believed pose, or a stream of lies would be flown from one move to the next.
pub const REBASE_INTERVAL_MIN_US: u64 = 3_000_000;

/// The cosine of the greatest angle between the accelerometer's up and a pose's, or that of a frame before and after it
/// moved: 10 degrees.
const TILT_COSINE_MIN: f32 = 0.984_807_8;

/// What the biases of a sound gyro, rad/s, and of a sound accelerometer, m/s^2, change by in a flight: a BMI088's by 30
/// K, at 0.015 deg/s and 0.2 mg a kelvin.
const GYRO_BIAS_CHANGE_MAX_RAD_PER_S: f32 = 0.008;
const ACCELEROMETER_BIAS_CHANGE_MAX_M_PER_S2: f32 = 0.06;

/// The time constant with which the vertical speed goes from the accelerometer's to that of the poses, s.
const CLIMB_TIME_CONSTANT_S: f32 = 8.0;

/// Poses that may wait for the IMU.
const WAITING_POSES_MAX: usize = 4;

/// The state at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimatedState {
    /// For the law. The body rate is the one handed over, less its bias; the velocity is without the rotors' vibration.
    pub state: State,
    /// v', m/s^2, world: the mean over the last two increments, by accelerometer.
    pub acceleration: Vector3<f32>,
    /// How often the state has jumped since the start: each [`Accepted::Rebased`], [`Accepted::Refound`] and
    /// [`Estimator::adopt`]. A differentiator of the state begins anew when it changes.
    pub jumps: u32,
    /// What the vertical speed has gained by the accelerometer alone, m/s; only differences count.
    pub gained: f32,
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
    /// Whether the vehicle may stand still, for all that is known.
    may_stand: bool,
    /// The biases of gyro, rad/s, and accelerometer, m/s^2, when it last was not.
    grounded: Option<(Vector3<f32>, Vector3<f32>)>,
    /// What [`EstimatedState::gained`] was at the end of the history, m/s.
    gained: f32,
    /// The vertical speed of [`Self::climb`], m/s.
    climb: f32,
    felt: MeanAcceleration,
    waiting: Vec<Stamped<Pose>, WAITING_POSES_MAX>,
    /// The sender's reset counter when the filter last followed it, and when that was, us.
    frame: Option<(u8, u64)>,
    statistics: Statistics,
}

impl Estimator {
    /// One without an estimate.
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
            may_stand: true,
            grounded: None,
            gained: 0.0,
            climb: 0.0,
            felt: MeanAcceleration::NOTHING,
            waiting: Vec::new(),
            frame: None,
            statistics: Statistics::NONE,
        }
    }

    /// Takes what the IMU did, which begins where the last increment ended. After a gap, or an invalid increment,
    /// everything begins anew, with the biases as they were: no state carries over a time without measurements.
    pub fn imu(&mut self, increment: &Increment) {
        let follows = self.history.newest().is_none_or(|newest| newest.end == increment.start);
        if !follows || !increment.is_usable(EXTRAPOLATION_MAX_US) {
            self.restart();
        }
        if !increment.is_usable(EXTRAPOLATION_MAX_US) {
            return;
        }
        if let Some(leaving) = self.history.leaving() {
            let end = leaving.end;
            let candidate = self.candidate.as_mut().map(|candidate| &mut candidate.filter);
            for filter in self.filter.as_mut().into_iter().chain(candidate).filter(|filter| filter.time < end) {
                filter.advance(end, &self.history, &self.settings);
            }
            self.checkpoints.forget_before(end);
        }
        self.history.push(increment);
        self.stream.note(if self.may_stand { self.moves(increment) } else { self.differs_from_rest(increment) });
        if let Some(latest) = &mut self.latest {
            let before = latest.velocity;
            latest.advance(increment, self.settings.parameters().gravity);
            let taught = self.grounded.map_or(0.0, |(_, grounded)| latest.accelerometer_bias.z - grounded.z);
            let change = latest.velocity - before;
            self.felt.add(&change);
            let felt = change.z;
            self.gained += felt;
            self.climb += felt
                + taught * increment.seconds()
                + (latest.velocity.z - self.climb) * (increment.seconds() / CLIMB_TIME_CONSTANT_S);
        }
        self.take_waiting(increment.end);
    }

    /// The vehicle may stand still, or not: in the air nothing does, and poses that do are frozen.
    pub fn may_stand(&mut self, may_stand: bool) {
        if may_stand && !self.may_stand {
            self.stream.come_to_stand();
        }
        self.may_stand = may_stand;
    }

    /// The vehicle is known to be in the air, or not.
    pub fn is_airborne(&mut self, airborne: bool) {
        if let (false, Some(Filter { nominal, .. })) = (airborne, &self.filter) {
            self.grounded = Some((nominal.gyro_bias, nominal.accelerometer_bias));
            self.climb = 0.0;
        }
    }

    /// The vertical speed, m/s: at once that of the accelerometer, with its bias as it was on the ground, and after
    /// 8 s that of the poses.
    pub fn climb(&self) -> f32 {
        self.climb
    }

    /// The poses since lift-off may have lied: what they taught of the gyro, and of the accelerometer along body z,
    /// beyond what a sensor changes by in a flight, is what it was on the ground. There gravity and rest show both;
    /// across, flight alone separates the accelerometer's bias from a tilt.
    pub fn distrust(&mut self) {
        let (Some(filter), Some((gyro, accelerometer))) = (&mut self.filter, self.grounded) else { return };
        let nominal = &mut filter.nominal;
        if (nominal.gyro_bias - gyro).norm_squared() > GYRO_BIAS_CHANGE_MAX_RAD_PER_S * GYRO_BIAS_CHANGE_MAX_RAD_PER_S {
            nominal.gyro_bias = gyro;
        }
        if (nominal.accelerometer_bias.z - accelerometer.z).abs() > ACCELEROMETER_BIAS_CHANGE_MAX_M_PER_S2 {
            nominal.accelerometer_bias.z = accelerometer.z;
        }
        self.carry_on();
    }

    /// Takes a pose that was true at its time stamp and arrives at `now`, us.
    ///
    /// # Errors
    /// The reason for a refusal; the state is as it was.
    pub fn pose(&mut self, pose: &Stamped<Pose>, now: u64) -> Result<Accepted, Rejected> {
        let verdict = self.stream.admit(pose, now).and_then(|()| self.take_in_time(pose));
        self.statistics.record(verdict, pose.time);
        verdict
    }

    /// The state at `now`, us, with the newest body rate as the law may have it: low-passed, rad/s, its bias included.
    /// The increment that is `under_way` since the last one turns the attitude on, and beyond it the mean rate of the
    /// time of one increment. None before the first, beyond [`EXTRAPOLATION_MAX_US`] after the last increment, before
    /// it, and with a rate that is not finite or beyond every sensor.
    pub fn state(&self, now: u64, rate: &Vector3<f32>, under_way: Option<&Increment>) -> Option<EstimatedState> {
        let (latest, last) = (self.latest.as_ref()?, self.history.newest()?);
        let ahead = self.imu_age(now).filter(|&age| age <= EXTRAPOLATION_MAX_US && is_measurable(rate))?;
        let PresentMotion { force, vibration } =
            PresentMotion::from_increments(last, self.history.before_newest(), self.history.slow_force());
        let seconds = ahead as f32 * 1e-6;
        let increment = Increment {
            start: last.end,
            end: last.end + ahead,
            delta_angle: last.turn_ahead(under_way, ahead),
            delta_velocity: self.history.slow_force() * seconds,
            ..*last
        };
        let (mut nominal, gravity) = (*latest, self.settings.parameters().gravity);
        let mut acceleration = rotated(&latest.attitude, &(force - latest.accelerometer_bias));
        acceleration.z -= gravity;
        nominal.advance(&increment, gravity);
        let Nominal { position, velocity, attitude, gyro_bias, .. } = nominal;
        let angular_velocity = rate - gyro_bias;
        let state =
            State { position, velocity: velocity - rotated(&latest.attitude, &vibration), attitude, angular_velocity };
        let gained = self.gained + state.velocity.z - latest.velocity.z;
        Some(EstimatedState { state, acceleration, jumps: self.statistics.jumps, gained })
    }

    /// The mean of v', m/s^2, world, since the last call, to be called once a tick: by accelerometer, with the
    /// increment that is `under_way`. None at the first call, and where [`Self::state`] has none.
    pub fn mean_acceleration(&mut self, now: u64, under_way: Option<&Increment>) -> Option<Vector3<f32>> {
        let Some(ahead) = self.velocity_ahead(now, under_way) else {
            self.felt = MeanAcceleration::NOTHING;
            return None;
        };
        self.felt.mean(now, &ahead)
    }

    /// By how much the velocity changes from the end of the last increment to `now`, m/s, world.
    fn velocity_ahead(&self, now: u64, under_way: Option<&Increment>) -> Option<Vector3<f32>> {
        let (latest, last) = (self.latest.as_ref()?, self.history.newest()?);
        let ahead = self.imu_age(now).filter(|&age| age <= EXTRAPOLATION_MAX_US)?;
        let PresentMotion { force, .. } =
            PresentMotion::from_increments(last, self.history.before_newest(), self.history.slow_force());
        let goes_on = |next: &&Increment| next.start == last.end && next.is_usable(ahead);
        let (pushed, known) =
            under_way.filter(goes_on).map_or((Vector3::zeros(), 0.0), |next| (next.delta_velocity, next.seconds()));
        let seconds = ahead as f32 * 1e-6;
        let pushed = pushed + force * (seconds - known) - latest.accelerometer_bias * seconds;
        let mut change = rotated(&latest.attitude, &pushed);
        change.z -= self.settings.parameters().gravity * seconds;
        Some(change)
    }

    /// What the estimate is worth at `now`, us.
    pub fn health(&self, now: u64) -> Health {
        let imu_age = self.imu_age(now).unwrap_or(u64::MAX);
        Health::new(self.filter.as_ref(), &self.statistics, &self.settings, imu_age, now)
    }

    /// The filter at its horizon, if there is one: nominal state, covariance and time.
    pub fn filter(&self) -> Option<&Filter> {
        self.filter.as_ref()
    }

    /// Follows the poses to where they have jumped, turned or drifted, if they have proven to agree among themselves
    /// and with the IMU; whether there was such a place. The estimate jumps.
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
        (end <= now.saturating_add(STAMP_LEAD_MAX_US)).then(|| now.saturating_sub(end))
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
        self.felt = MeanAcceleration::NOTHING;
        self.statistics = self.statistics.restarted();
    }
}

/// R(q) x.
fn rotated(q: &Quaternion<f32>, x: &Vector3<f32>) -> Vector3<f32> {
    nalgebra::UnitQuaternion::new_unchecked(*q) * x
}

#[cfg(test)]
mod tests;
