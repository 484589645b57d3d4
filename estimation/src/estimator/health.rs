//! The estimate's health: the age of its last pose, its uncertainty, and whether its sensors are plausible.
//!
//! Uncertainties are those at the horizon, which is as far back as the last pose, or as the history goes where none
//! comes. Means of NIS run over the last 50 poses that were weighed (an exponential average, each NIS cut at
//! [`NIS_MAX`]); a filter whose sensors match its settings has 3.

use super::filter::Filter;
use super::history::EXTRAPOLATION_MAX_US;
use super::settings::Settings;
use super::verdict::{Accepted, Fault, Rejected};
use controller_core::math;
use nalgebra::Matrix3;

/// The age of the last pose that was fused at which the estimate counts as coasting, us: poses of 10 Hz that come 150
/// ms late, and their jitter.
pub const COASTING_AFTER_US: u64 = 300_000;

/// Deviations beyond which an estimate is not good enough to fly on: m, m/s, rad (each the root of a trace). As with
/// poses, not for longer than [`COASTING_AFTER_US`]: a few poses restore what a shock has left out.
const DEVIATIONS_MAX: (f32, f32, f32) = (0.3, 0.5, 0.1);

/// The mean NIS beyond which poses are noisier than their covariance: by a factor of 1.7, or not white.
pub const NIS_MEAN_MAX: f32 = 9.0;

/// What a single NIS counts for at most.
pub const NIS_MAX: f32 = 50.0;

/// One over the poses that a mean runs over.
const NIS_AVERAGING_SHARE: f32 = 0.02;

/// A set of faults.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Faults(u8);

impl Faults {
    /// These and, if `holds`, one more.
    #[must_use]
    const fn with(self, fault: Fault, holds: bool) -> Self {
        Self(self.0 | (holds as u8) << fault as u8)
    }

    /// Whether `fault` is one of them.
    pub const fn contain(self, fault: Fault) -> bool {
        self.0 >> fault as u8 & 1 == 1
    }

    /// The worst of them.
    pub fn worst(self) -> Option<Fault> {
        Fault::ALL.into_iter().find(|&fault| self.contain(fault))
    }
}

/// The estimate's health at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Health {
    /// Its faults; none where the estimate may be flown.
    pub faults: Faults,
    /// The age of the last pose that was fused, us; none before the first.
    pub pose_age: Option<u64>,
    /// The verdict on the last pose that did not have to wait.
    pub last: Option<Result<Accepted, Rejected>>,
    /// Poses that were believed, and not.
    pub counts: (u32, u32),
    /// How often the state has jumped.
    pub jumps: u32,
    /// Roots of the traces of the covariance: position m, velocity m/s, attitude rad.
    pub deviations: (f32, f32, f32),
    /// Means of NIS: position, attitude.
    pub nis: (f32, f32),
    /// |b_g|, rad/s, and |b_a|, m/s^2.
    pub biases: (f32, f32),
}

/// What is counted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Statistics {
    /// When the last pose that was fused was true, us.
    pub fused_at: u64,
    /// When the estimate last was certain, us.
    pub certain_at: u64,
    pub jumps: u32,
    last: Option<Result<Accepted, Rejected>>,
    counts: (u32, u32),
    nis: (f32, f32),
}

impl Statistics {
    pub const NONE: Self = Self { fused_at: 0, certain_at: 0, jumps: 0, last: None, counts: (0, 0), nis: (3.0, 3.0) };

    /// None, after a restart: the state's jumps go on counting.
    pub fn restarted(&self) -> Self {
        Self { jumps: self.jumps, ..Self::NONE }
    }

    /// Takes the verdict on a pose that was true at `time`, us.
    pub fn record(&mut self, verdict: Result<Accepted, Rejected>, time: u64) {
        if verdict == Ok(Accepted::Waiting) {
            return;
        }
        self.last = Some(verdict);
        match verdict {
            Ok(taken) => {
                self.counts.0 = self.counts.0.saturating_add(1);
                if taken.is_believed() {
                    self.fused_at = self.fused_at.max(time);
                }
            }
            Err(_) => self.counts.1 = self.counts.1.saturating_add(1),
        }
    }

    /// Takes the uncertainty of `filter` after a pose.
    pub fn record_certainty(&mut self, filter: &Filter) {
        if is_certain(deviations(filter)) {
            self.certain_at = filter.time;
        }
    }

    /// The filter is another one: the last one's innovations do not count.
    pub fn forget_nis(&mut self) {
        self.nis = Self::NONE.nis;
    }

    /// The NIS of a pose, believed or not.
    pub fn record_nis(&mut self, (position, attitude): (f32, f32)) {
        let average = |mean: f32, nis: f32| mean + NIS_AVERAGING_SHARE * (math::clamp(nis, 0.0, NIS_MAX) - mean);
        self.nis = (average(self.nis.0, position), average(self.nis.1, attitude));
    }
}

impl Health {
    /// The health without an estimate.
    pub const NONE: Self = Self {
        faults: Faults(0).with(Fault::NotStarted, true).with(Fault::ImuStale, true),
        pose_age: None,
        last: None,
        counts: (0, 0),
        jumps: 0,
        deviations: (0.0, 0.0, 0.0),
        nis: Statistics::NONE.nis,
        biases: (0.0, 0.0),
    };

    /// No fault.
    pub fn is_good(&self) -> bool {
        self.faults == Faults::default()
    }

    pub(super) fn new(
        filter: Option<&Filter>,
        statistics: &Statistics,
        settings: &Settings,
        imu_age: u64,
        now: u64,
    ) -> Self {
        let Statistics { fused_at, certain_at, jumps, last, counts, nis } = *statistics;
        let stale = imu_age > EXTRAPOLATION_MAX_US;
        let mut health = Self {
            faults: Faults::default().with(Fault::NotStarted, filter.is_none()).with(Fault::ImuStale, stale),
            pose_age: filter.map(|_| now.saturating_sub(fused_at)),
            last,
            counts,
            jumps,
            nis,
            ..Self::NONE
        };
        let Some(filter) = filter else { return health };
        health.deviations = deviations(filter);
        let gyro = math::sqrt(filter.nominal.gyro_bias.norm_squared());
        let accelerometer = math::sqrt(filter.nominal.accelerometer_bias.norm_squared());
        health.biases = (gyro, accelerometer);
        let parameters = settings.parameters();
        let uncertain = !is_certain(health.deviations) && now.saturating_sub(certain_at) > COASTING_AFTER_US;
        health.faults = health
            .faults
            .with(Fault::NoPose, now.saturating_sub(fused_at) > COASTING_AFTER_US)
            .with(Fault::Uncertain, uncertain)
            .with(Fault::GyroBias, !within(gyro, parameters.gyro_bias_max))
            .with(Fault::AccelerometerBias, !within(accelerometer, parameters.accelerometer_bias_max))
            .with(Fault::Inconsistent, !(within(nis.0, NIS_MEAN_MAX) && within(nis.1, NIS_MEAN_MAX)));
        health
    }
}

/// Roots of the traces of the covariance: position m, velocity m/s, attitude rad.
fn deviations(filter: &Filter) -> (f32, f32, f32) {
    let deviation = |block: &Matrix3<f32>| math::sqrt(block.m11 + block.m22 + block.m33);
    let covariance = &filter.covariance;
    (deviation(&covariance.pp), deviation(&covariance.vv), deviation(&covariance.tt))
}

fn is_certain((position, velocity, attitude): (f32, f32, f32)) -> bool {
    within(position, DEVIATIONS_MAX.0) && within(velocity, DEVIATIONS_MAX.1) && within(attitude, DEVIATIONS_MAX.2)
}

/// Written so that NaN is a fault.
fn within(value: f32, max: f32) -> bool {
    value <= max
}

#[cfg(test)]
mod tests;
