//! How an estimate begins: with a candidate that must prove itself, at rest or in motion, for the first time or again.
//!
//! A candidate is a filter that starts at a pose and knows no velocity. It fuses the poses that come, through the same
//! gates as any filter, and may pass over [`MISSES_MAX`] in a row; one more is the start of a new candidate. After
//! [`POSES_MIN`] poses over [`PROVING_MIN_US`] they agree among themselves and with the gyro, about every turn, and
//! with the accelerometer, about every change of velocity. Where up is comes out of that too, at rest as in motion:
//! with an attitude that is off by an angle e, gravity is an acceleration of g sin(e) that the poses do not show. The
//! filter has nowhere to put it but the accelerometer's bias, which is then not plausible.
//!
//! Where there is an estimate already, coasting since it believed no pose any more, a candidate that has proven itself
//! is the same body found again if it is no further away than coasting for T seconds may have drifted:
//!
//! ```text
//! turned by      0.1 + 0.02 T rad          an error of the gyro's bias that any calibration leaves
//! at velocity    0.1 + 0.3 T m/s           an error of 0.3 m/s^2: 1.8 degrees of tilt, or 30 mg
//! at position    0.1 + 0.1 T + 0.15 T^2 m
//! ```
//!
//! Otherwise the poses lie, or their frame has moved without a report. Nothing here decides which: the caller of
//! [`super::Estimator::adopt`] does.

use super::filter::{Biases, Filter};
use super::history::History;
use super::measurement::PoseMeasurement;
use super::settings::Settings;
use super::verdict::Rejected;
use controller_core::math;
use nalgebra::Vector3;

/// The least number of poses that prove a candidate.
pub const POSES_MIN: u16 = 5;

/// The least time from its first pose to its last, us.
pub const PROVING_MIN_US: u64 = 500_000;

/// Poses in a row that a candidate may not believe: an outlier is no reason to begin anew.
pub const MISSES_MAX: u8 = 2;

/// A filter on trial.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    pub filter: Filter,
    /// When its first pose was true, and its last, us: the filter's own time may be later.
    since: u64,
    until: u64,
    poses: u16,
    misses: u8,
}

impl Candidate {
    /// Begins at a pose.
    pub fn new(time: u64, pose: &PoseMeasurement, biases: &Biases, settings: &Settings) -> Self {
        let filter = Filter::start(time, pose, biases, settings);
        Self { filter, since: time, until: time, poses: 1, misses: 0 }
    }

    /// Takes one more pose, later than the last.
    ///
    /// # Errors
    /// If the pose does not go with those before it; see `Self::is_lost`.
    pub fn take(
        &mut self,
        time: u64,
        pose: &PoseMeasurement,
        history: &History,
        settings: &Settings,
    ) -> Result<(), Rejected> {
        self.filter.advance(time, history, settings);
        self.misses = self.misses.saturating_add(1);
        let tested = self.filter.weigh(pose, settings)?;
        tested.gate()?;
        self.filter.fuse(pose, &tested)?;
        self.poses = self.poses.saturating_add(1);
        self.until = time;
        self.misses = 0;
        Ok(())
    }

    /// Whether there is no use for it any more: it believes no pose, or has found up where the accelerometer has it
    /// not.
    pub fn is_lost(&self, settings: &Settings) -> bool {
        self.misses > MISSES_MAX || !self.filter.covariance.is_positive() || self.check_gravity(settings).is_err()
    }

    /// Whether it has proven itself.
    pub fn is_proven(&self) -> bool {
        self.poses >= POSES_MIN && self.until.saturating_sub(self.since) >= PROVING_MIN_US
    }

    /// Whether up is where the accelerometer says.
    pub fn check_gravity(&self, settings: &Settings) -> Result<(), Rejected> {
        let max = settings.parameters().accelerometer_bias_max;
        if self.filter.nominal.accelerometer_bias.norm_squared() > max * max { Err(Rejected::Gravity) } else { Ok(()) }
    }

    /// Whether it may be what `filter`, at the same time, has lost sight of `lost` us ago.
    pub fn compare(&self, filter: &Filter, lost: u64) -> Result<(), Rejected> {
        let t = lost as f32 * 1e-6;
        let exceeds = |apart: &Vector3<f32>, max: f32| math::sqrt(apart.norm_squared()) > max;
        let (there, here) = (&self.filter.nominal, &filter.nominal);
        let turned = super::nominal::difference(&there.attitude, &here.attitude);
        if exceeds(&turned, 0.1 + 0.02 * t) {
            Err(Rejected::Turned)
        } else if exceeds(&(there.velocity - here.velocity), 0.1 + 0.3 * t) {
            Err(Rejected::Drift)
        } else if exceeds(&(there.position - here.position), 0.1 + (0.1 + 0.15 * t) * t) {
            Err(Rejected::Jump)
        } else {
            Ok(())
        }
    }
}
