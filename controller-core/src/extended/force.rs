//! An estimate of the force that the model does not know, per mass: wind, drag, errors of mass and thrust. Section 2 of
//! `docs/extended-law.md`.
//!
//! | here | equation |
//! |---|---|
//! | [`observed`] | a = (v_k - v_(k-1)) / h - (bbar F / m - g e3 - kappa v): what accelerates the vehicle beside its thrust and its known drag |
//! | `average` | zeta += (1 - e^(-L h)) (a - zeta) |
//! | `value`, `rate` | d'' = sat(k_d^2 (P(zeta) - d) - 2 k_d d'; S), and so much less that \|d'\| <= S / k_d |
//!
//! P cuts each axis to its level D. The generator d does not copy zeta but moves towards it, so that d, d' and d'' have bounds
//! that the certificate can count on: D, S / k_d and S on each axis. Small changes pass with a double pole at k_d; large
//! ones at the rate S / k_d. d enters u with the reference's derivatives: u = … - d, u' = … - d', u'' = … - d''.
//!
//! That |d| <= D holds at every tick for k_d h <= 0.6 is proven in the document.

use super::parameters::EstimateParameters;
use crate::error::{ParameterError, Reason, require};
use crate::math::{self, within};
use nalgebra::Vector3;

/// zeta, d and d', world frame; m/s^2 and m/s^3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceEstimate {
    /// zeta.
    pub average: Vector3<f32>,
    /// d.
    pub value: Vector3<f32>,
    /// d'.
    pub rate: Vector3<f32>,
}

impl ForceEstimate {
    /// Nothing known.
    pub const NONE: Self = Self {
        average: Vector3::new(0.0, 0.0, 0.0),
        value: Vector3::new(0.0, 0.0, 0.0),
        rate: Vector3::new(0.0, 0.0, 0.0),
    };
}

/// What accelerated the vehicle over an interval beside its thrust, gravity and known drag, m/s^2, world frame.
///
/// `velocities` are those at the interval's start and end, m/s; `thrust_axis` the mean of R e3 there; `thrust` the mean thrust,
/// per mass, m/s^2; `drag` is kappa along each axis, 1/s.
#[must_use]
pub fn observed(
    velocities: [&Vector3<f32>; 2],
    thrust_axis: &Vector3<f32>,
    thrust: f32,
    constants: &ForceGenerator,
) -> Vector3<f32> {
    let [start, end] = velocities;
    let acceleration = (end - start) * constants.per_period;
    let half_drag = 0.5 * constants.drag;
    let mut rest = acceleration - thrust_axis * thrust;
    rest.x += half_drag * (start.x + end.x);
    rest.y += half_drag * (start.y + end.y);
    rest.z += constants.gravity;
    rest
}

/// The estimate's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceGenerator {
    period: f32,
    per_period: f32,
    gravity: f32,
    drag: f32,
    /// 1 - e^(-L h) of each axis.
    averaging: Vector3<f32>,
    /// k_d of each axis, 1/s.
    bandwidth: Vector3<f32>,
    /// D of each axis, m/s^2.
    level: Vector3<f32>,
    /// S of each axis, m/s^4.
    snap: Vector3<f32>,
    /// S / k_d of each axis, m/s^3.
    jerk: Vector3<f32>,
}

impl ForceGenerator {
    /// The greatest k_d h: up to there the generator never leaves its levels.
    pub const STEP_MAX: f32 = 0.6;

    /// For steps of `period`, s, under `gravity`, m/s^2.
    ///
    /// # Errors
    /// Names `estimates.force_bandwidth` where k_d h is beyond [`Self::STEP_MAX`].
    pub fn new(parameters: &EstimateParameters, gravity: f32, period: f32) -> Result<Self, ParameterError> {
        let e = parameters;
        let greatest = Self::STEP_MAX / period;
        for (bandwidth, field) in [
            (e.force_bandwidth_across, "estimates.force_bandwidth_across"),
            (e.force_bandwidth_vertical, "estimates.force_bandwidth_vertical"),
        ] {
            require(bandwidth <= greatest, field, Reason::NotBelow(greatest))?;
        }
        let axes = |across: f32, vertical: f32| Vector3::new(across, across, vertical);
        let averaging = |smoothing: f32| -math::exp_m1(-f64::from(smoothing) * f64::from(period)) as f32;
        let snap = axes(e.force_snap_across, e.force_snap_vertical);
        let bandwidth = axes(e.force_bandwidth_across, e.force_bandwidth_vertical);
        Ok(Self {
            period,
            per_period: 1.0 / period,
            gravity,
            drag: e.drag_across,
            averaging: axes(averaging(e.force_smoothing_across), averaging(e.force_smoothing_vertical)),
            bandwidth,
            level: axes(e.force_across, e.force_vertical),
            snap,
            jerk: snap.component_div(&bandwidth),
        })
    }

    /// Takes what was [`observed`] into the average.
    #[must_use]
    pub fn averaged(&self, estimate: &ForceEstimate, observed: &Vector3<f32>) -> ForceEstimate {
        let average = estimate.average + (observed - estimate.average).component_mul(&self.averaging);
        ForceEstimate { average, ..*estimate }
    }

    /// d'', m/s^4, to be held for the period to come.
    #[must_use]
    pub fn acceleration(&self, estimate: &ForceEstimate) -> Vector3<f32> {
        let ForceEstimate { average, value, rate } = estimate;
        let axis = |zeta: f32, d: f32, rate: f32, k: f32, [level, snap, jerk]: [f32; 3]| {
            let wanted = within(k * (k * (within(zeta, level) - d) - 2.0 * rate), snap);
            (within(rate + wanted * self.period, jerk) - rate) * self.per_period
        };
        let (k, level, snap, jerk) = (&self.bandwidth, &self.level, &self.snap, &self.jerk);
        Vector3::new(
            axis(average.x, value.x, rate.x, k.x, [level.x, snap.x, jerk.x]),
            axis(average.y, value.y, rate.y, k.y, [level.y, snap.y, jerk.y]),
            axis(average.z, value.z, rate.z, k.z, [level.z, snap.z, jerk.z]),
        )
    }

    /// The estimate one period later, d'' = `acceleration` held.
    #[must_use]
    pub fn advanced(&self, estimate: &ForceEstimate, acceleration: &Vector3<f32>) -> ForceEstimate {
        let rate = estimate.rate + acceleration * self.period;
        let value = estimate.value + (estimate.rate + rate) * (0.5 * self.period);
        ForceEstimate { average: estimate.average, value, rate }
    }
}
