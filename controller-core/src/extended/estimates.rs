//! What the law estimates of its vehicle and the air from an interval between two ticks: the vehicle's motion against
//! the wrench that acted. Sections 2, 7 and 9 of `docs/extended-law.md`.
//!
//! | here | equation |
//! |---|---|
//! | [`ForceObserver::mean_acceleration`] | v' = (v_k - v_(k-1)) / h, where it is not measured |
//! | [`ForceObserver::driven_acceleration`] | y = v' + g e3 + kappa v: the acceleration by thrust and unknown force |
//! | [`ForceObserver::filtered`] | zeta += (1 - e^(-L h)) (a - zeta), a being y less the scaled thrust s bbar F / m |
//! | [`ForceObserver::estimate`] | d: zeta cut to D_h across (radially), to D_z+ upwards and D_z- downwards |
//! | [`TorqueBias::observed`] | J (omega_k - omega_(k-1)) / h + omega x J omega - tau, with omega and the scaled tau the means over the interval |
//! | [`TorqueBias::filtered`], [`TorqueBias::estimate`] | tau_b: the same averaged with the bandwidth L_tau, each component cut to its level |
//! | [`ThrustScale::updated`] | s += gamma_s h (dy - s df) . df / (\|df\|^2 + c_0^2), s in [s_lo, s_hi] |
//!
//! d enters the position law and passes its filters, tau_b is subtracted from the torque, and rotors are commanded f /
//! s: no derivative of them is needed. Where no velocity is known, the torque bias alone is learnt: rates are enough
//! for it.
//!
//! In steady flight a wrong scale and a force look alike, and the force carries both. So the scale is learnt from
//! variations alone: dy and df are y and f = bbar F / m, both less their slow averages. y - ybar = s (f - fbar) for any
//! constant force, so |s - s*| never rises while force and scale are constant, and s stands still where thrust does.

use super::measured::{Measured, Sensors};
use super::memory::{Averages, Estimates, Memory, ScaleEstimate};
use super::parameters::ExtendedParameters;
use crate::math;
use crate::state::State;
use crate::vehicle::{Limits, Vehicle};
use core::hint::cold_path;
use nalgebra::{Vector3, Vector4};

/// The greatest mean acceleration and change of a body rate in an interval that teaches. Beyond them the state has
/// jumped: a line of nonsense, a new frame.
const ACCELERATION_MAX_M_PER_S2: f32 = 1e3;
const RATE_CHANGE_MAX_RAD_PER_S: f32 = 1e3;

/// c_0: variations below it carry little information about the scale.
const VARIATION_MIN_M_PER_S2: f64 = 2.0;

/// Bandwidth of the slow averages ybar and fbar.
const AVERAGES_BANDWIDTH_PER_S: f64 = 0.7;

/// The part of U that a force may use up together with the reference.
pub const HELD_SHARE: f32 = 0.99;

/// 1 - e^(-`bandwidth` h): the share of the way that an average goes in a tick.
fn averaging(bandwidth: f64, period: f32) -> f32 {
    -math::exp_m1(-bandwidth * f64::from(period)) as f32
}

/// The observer of the force per mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ForceObserver {
    per_period: f32,
    gravity: f32,
    /// kappa / 2, 1/s.
    half_drag: f32,
    averaging_across: f32,
    averaging_vertical: f32,
    across: f32,
    up: f32,
    down: f32,
}

impl ForceObserver {
    pub fn new(parameters: &ExtendedParameters, gravity: f32, period: f32) -> Self {
        Self {
            per_period: 1.0 / period,
            gravity,
            half_drag: 0.5 * parameters.drag_across,
            averaging_across: averaging(parameters.force_bandwidth_across.into(), period),
            averaging_vertical: averaging(parameters.force_bandwidth_vertical.into(), period),
            across: parameters.force_across,
            up: parameters.force_up,
            down: parameters.force_down,
        }
    }

    /// Over an interval with these `velocities`, m/s, at its start and end.
    pub fn mean_acceleration(&self, velocities: [&Vector3<f32>; 2]) -> Vector3<f32> {
        let [start, end] = velocities;
        (end - start) * self.per_period
    }

    /// The mean `acceleration` without gravity and known drag, m/s^2, world frame.
    pub fn driven_acceleration(&self, acceleration: Vector3<f32>, velocities: [&Vector3<f32>; 2]) -> Vector3<f32> {
        let [start, end] = velocities;
        let mut driven = acceleration;
        driven.x += self.half_drag * (start.x + end.x);
        driven.y += self.half_drag * (start.y + end.y);
        driven.z += self.gravity;
        driven
    }

    /// zeta after an interval whose acceleration has this `rest` beside the thrust's.
    pub fn filtered(&self, average: &Vector3<f32>, rest: &Vector3<f32>) -> Vector3<f32> {
        Vector3::new(
            average.x + self.averaging_across * (rest.x - average.x),
            average.y + self.averaging_across * (rest.y - average.y),
            average.z + self.averaging_vertical * (rest.z - average.z),
        )
    }

    /// d, m/s^2, world frame.
    pub fn estimate(&self, average: &Vector3<f32>) -> Vector3<f32> {
        let square = average.x * average.x + average.y * average.y;
        let share = if square > self.across * self.across { self.across / math::sqrt(square) } else { 1.0 };
        Vector3::new(average.x * share, average.y * share, math::clamp(average.z, -self.down, self.up))
    }
}

/// The part of `force` that |u| of at most `acceleration_max`, m/s^2, holds where u at the target is `rest` - d, world
/// frame: the vertical first, across what it leaves.
#[inline(always)] // into the law's step
pub(super) fn held(force: &Vector3<f32>, rest: &Vector3<f32>, acceleration_max: f32) -> Vector3<f32> {
    let max = acceleration_max * HELD_SHARE;
    let lift = rest.z - force.z;
    let (wind, across) = (force.xy().norm_squared(), rest.xy().norm_squared());
    // (a + b)^2 <= 2 (a^2 + b^2).
    if lift <= max && lift * lift + 2.0 * (wind + across) <= max * max {
        return *force;
    }
    cold_path();
    let lift = math::min(lift, max);
    let left = math::sqrt(math::max(max * max - lift * lift, 0.0)) - math::sqrt(across);
    let length = math::sqrt(wind);
    // Without a wind there is nothing to cut, whatever the reference takes.
    let share = if length > left { math::max(left, 0.0) / math::max(length, f32::MIN_POSITIVE) } else { 1.0 };
    Vector3::new(force.x * share, force.y * share, rest.z - lift)
}

/// The observer of a constant torque: a centre of mass off the rotors' middle, a weak rotor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TorqueBias {
    /// About z with half of L_tau.
    averaging: Vector3<f32>,
    level: Vector3<f32>,
    inertia_per_period: Vector3<f32>,
    /// (J_z - J_y, J_x - J_z, J_y - J_x) / 4, kg m^2: the mean of two rates, twice in a product, is a quarter of their
    /// sums'.
    quarter_differences: Vector3<f32>,
}

impl TorqueBias {
    pub fn new(parameters: &ExtendedParameters, inertia: &Vector3<f32>, period: f32) -> Self {
        let ExtendedParameters { torque_tilt, torque_yaw, torque_bandwidth, .. } = *parameters;
        let bandwidth = f64::from(torque_bandwidth);
        let [tilt, yaw] = [bandwidth, 0.5 * bandwidth].map(|bandwidth| averaging(bandwidth, period));
        Self {
            averaging: Vector3::new(tilt, tilt, yaw),
            level: Vector3::new(torque_tilt, torque_tilt, torque_yaw),
            inertia_per_period: inertia / period,
            quarter_differences: (inertia.zxy() - inertia.yzx()) * 0.25,
        }
    }

    /// The unexplained torque, N m, body frame, over an interval with these `angular_velocities`, rad/s, at its start
    /// and end, in which the mean `torque` acted.
    pub fn observed(&self, angular_velocities: [&Vector3<f32>; 2], torque: &Vector3<f32>) -> Vector3<f32> {
        let [start, end] = angular_velocities;
        let sum = start + end;
        self.inertia_per_period.component_mul(&(end - start))
            + self.quarter_differences.component_mul(&sum.yzx()).component_mul(&sum.zxy())
            - torque
    }

    pub fn filtered(&self, average: &Vector3<f32>, observed: &Vector3<f32>) -> Vector3<f32> {
        average + (observed - average).component_mul(&self.averaging)
    }

    pub fn estimate(&self, average: &Vector3<f32>) -> Vector3<f32> {
        average.zip_map(&self.level, math::saturate)
    }
}

/// The observer of the thrust scale: delivered over commanded thrust (battery, propellers, mass).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ThrustScale {
    /// gamma_s h.
    gain: f32,
    averaging: f32,
    /// c_0^2 / e^(-2 h bandwidth), m^2/s^4.
    square_min: f32,
    min: f32,
    max: f32,
}

impl ThrustScale {
    pub fn new(parameters: &ExtendedParameters, period: f32) -> Self {
        let kept = math::exp(-AVERAGES_BANDWIDTH_PER_S * f64::from(period));
        Self {
            gain: parameters.scale_rate * period,
            averaging: (1.0 - kept) as f32,
            square_min: (VARIATION_MIN_M_PER_S2 * VARIATION_MIN_M_PER_S2 / (kept * kept)) as f32,
            min: parameters.scale_least,
            max: parameters.scale_greatest,
        }
    }

    /// The estimate after an interval with y = `driven` and f = `commanded`, both m/s^2, world frame.
    #[inline(always)] // into the law's step
    pub fn updated(&self, estimate: &ScaleEstimate, driven: &Vector3<f32>, commanded: &Vector3<f32>) -> ScaleEstimate {
        let scale = estimate.scale;
        let Some([slow_driven, slow_commanded]) = estimate.slow else {
            return ScaleEstimate { slow: Some([*driven, *commanded]), scale };
        };
        // From the averages before this interval; those with it are e^(-h bandwidth) times as far, which is in c_0.
        let (driven, commanded) = (driven - slow_driven, commanded - slow_commanded);
        let square = commanded.norm_squared();
        let step = self.gain * (driven.dot(&commanded) - scale * square) / (square + self.square_min);
        ScaleEstimate {
            slow: Some([slow_driven + driven * self.averaging, slow_commanded + commanded * self.averaging]),
            scale: math::clamp(scale + step, self.min, self.max),
        }
    }
}

/// All observers, for intervals of one length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Learning {
    pub force: ForceObserver,
    torque: TorqueBias,
    scale: ThrustScale,
    pub sensors: Sensors,
    per_mass: f32,
}

impl Learning {
    pub fn new(parameters: &ExtendedParameters, vehicle: &Vehicle, limits: &Limits, period: f32) -> Self {
        Self {
            force: ForceObserver::new(parameters, vehicle.gravity, period),
            torque: TorqueBias::new(parameters, &vehicle.inertia, period),
            scale: ThrustScale::new(parameters, period),
            sensors: Sensors::new(vehicle, limits, period),
            per_mass: 1.0 / vehicle.mass,
        }
    }

    /// The averages in `memory` brought up to this tick, if the last interval can teach anything; `axis` is R e3 now,
    /// `acted` the mean wrench as commanded, N and N m.
    #[inline(always)] // into the law's step
    pub fn updated(
        &self,
        memory: &Memory,
        state: &State,
        axis: &Vector3<f32>,
        measured: &Measured,
        acted: &Vector4<f32>,
    ) -> Averages {
        let averages = &memory.averages;
        let Some(last) = memory.last.as_ref().filter(|_| memory.held == 0) else {
            return *averages;
        };
        let rates = [&last.angular_velocity, &state.angular_velocity];
        if memory.without_velocity > 0 {
            cold_path();
            let acted = Vector3::new(acted.y, acted.z, acted.w) * averages.scale.scale;
            let torque = self.torque.filtered(&averages.torque, &self.torque.observed(rates, &acted));
            return Averages { torque, ..*averages };
        }
        let velocities = [&last.velocity, &state.velocity];
        let differed = self.force.mean_acceleration(velocities);
        let driven = self.force.driven_acceleration(differed, velocities);
        let turned = (state.angular_velocity - last.angular_velocity).norm_squared();
        let moves = driven.norm_squared() < ACCELERATION_MAX_M_PER_S2 * ACCELERATION_MAX_M_PER_S2;
        if !(moves & (turned < RATE_CHANGE_MAX_RAD_PER_S * RATE_CHANGE_MAX_RAD_PER_S)) {
            return *averages;
        }
        let felt = measured.usable_acceleration();
        let felt = felt.map(|felt| self.sensors.acceleration(felt, &differed, &averages.offset));
        let (driven, offset) = felt.map_or((driven, averages.offset), |[acceleration, offset]| {
            (self.force.driven_acceleration(acceleration, velocities), offset)
        });
        let commanded = (last.thrust_axis + axis) * (0.5 * self.per_mass * acted.x);
        let scale = self.scale.updated(&averages.scale, &driven, &commanded);
        let force = self.force.filtered(&averages.force, &(driven - commanded * scale.scale));
        let torque = Vector3::new(acted.y, acted.z, acted.w) * scale.scale;
        let torque = self.torque.observed(rates, &torque);
        Averages { force, scale, torque: self.torque.filtered(&averages.torque, &torque), offset }
    }

    /// The averages cut to their levels.
    pub fn estimates(&self, averages: &Averages) -> Estimates {
        let Averages { force, torque, scale, .. } = averages;
        Estimates { force: self.force.estimate(force), torque: self.torque.estimate(torque), scale: scale.scale }
    }
}
