//! An estimate of the force that the model does not know, per mass: wind, drag, errors of mass and thrust. Section 2 of
//! `docs/extended-law.md`.
//!
//! | here | equation |
//! |---|---|
//! | [`ForceObserver::observed`] | a = (v_k - v_(k-1)) / h - (bbar F / m - g e3 - kappa v): what accelerates the vehicle beside its thrust and its known drag |
//! | [`ForceObserver::averaged`] | zeta += (1 - e^(-L h)) (a - zeta) |
//! | [`ForceGenerator`] | d'' = sat(k_d^2 (P(zeta) - d) - 2 k_d d'; S), and so much less that \|d'\| <= S / k_d |
//!
//! P cuts each axis to its level D. The generator d does not copy zeta but moves towards it, so that d, d' and d'' have bounds
//! that the certificate can count on: D, S / k_d and S on each axis. Small changes pass with a double pole at k_d; large
//! ones at the rate S / k_d. d enters u with the reference's derivatives: u = … - d, u' = … - d', u'' = … - d''.
//!
//! That |d| <= D holds at every tick for k_d h <= 0.6 is proven in the document.

use super::parameters::EstimateParameters;
use crate::error::{ParameterError, Reason, require};
use crate::math::{self, within, within_rate};
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

/// What is learnt of an interval: its constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceObserver {
    per_period: f32,
    gravity: f32,
    /// kappa / 2, 1/s.
    half_drag: f32,
    /// 1 - e^(-L h).
    averaging_across: f32,
    averaging_vertical: f32,
}

impl ForceObserver {
    /// For intervals of `period`, s, under `gravity`, m/s^2.
    #[must_use]
    pub fn new(parameters: &EstimateParameters, gravity: f32, period: f32) -> Self {
        let averaging = |smoothing: f32| -math::exp_m1(-f64::from(smoothing) * f64::from(period)) as f32;
        Self {
            per_period: 1.0 / period,
            gravity,
            half_drag: 0.5 * parameters.drag_across,
            averaging_across: averaging(parameters.force_smoothing_across),
            averaging_vertical: averaging(parameters.force_smoothing_vertical),
        }
    }

    /// What accelerated the vehicle over an interval beside its thrust, gravity and known drag, m/s^2, world frame.
    ///
    /// `velocities` are those at the interval's start and end, m/s; `thrust` is what the thrust made of it, bbar F / m, m/s^2.
    #[must_use]
    pub fn observed(&self, velocities: [&Vector3<f32>; 2], thrust: &Vector3<f32>) -> Vector3<f32> {
        let [start, end] = velocities;
        let mut rest = (end - start) * self.per_period - thrust;
        rest.x += self.half_drag * (start.x + end.x);
        rest.y += self.half_drag * (start.y + end.y);
        rest.z += self.gravity;
        rest
    }

    /// The mean vertical acceleration over an interval less gravity's, v_z' + g, m/s^2.
    #[must_use]
    pub fn lift(&self, start: &Vector3<f32>, end: &Vector3<f32>) -> f32 {
        (end.z - start.z) * self.per_period + self.gravity
    }

    /// Takes what was [observed](Self::observed) into the average.
    #[must_use]
    pub fn averaged(&self, estimate: &ForceEstimate, observed: &Vector3<f32>) -> ForceEstimate {
        let ForceEstimate { average, .. } = estimate;
        let average = Vector3::new(
            average.x + self.averaging_across * (observed.x - average.x),
            average.y + self.averaging_across * (observed.y - average.y),
            average.z + self.averaging_vertical * (observed.z - average.z),
        );
        ForceEstimate { average, ..*estimate }
    }
}

/// One axis' constants of the generator.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Axis {
    /// k_d^2, 1/s^2.
    stiffness: f32,
    /// 2 k_d, 1/s.
    damping: f32,
    /// D, m/s^2.
    level: f32,
    /// S, m/s^4.
    snap: f32,
    /// S / k_d, m/s^3.
    jerk: f32,
}

impl Axis {
    fn new(bandwidth: f32, level: f32, snap: f32) -> Self {
        Self { stiffness: bandwidth * bandwidth, damping: 2.0 * bandwidth, level, snap, jerk: snap / bandwidth }
    }

    fn acceleration(&self, zeta: f32, d: f32, rate: f32, period: f32) -> f32 {
        let wanted = self.stiffness * (within(zeta, self.level) - d) - self.damping * rate;
        within_rate(within(wanted, self.snap), rate, self.jerk, period)
    }
}

/// The generator's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceGenerator {
    period: f32,
    across: Axis,
    vertical: Axis,
}

impl ForceGenerator {
    /// The greatest k_d h: up to there the generator never leaves its levels.
    pub const STEP_MAX: f32 = 0.6;

    /// Checks the bandwidths for steps of `period`, s.
    ///
    /// # Errors
    /// Names `estimates.force_bandwidth_…` where k_d h is beyond [`Self::STEP_MAX`].
    pub fn check(parameters: &EstimateParameters, period: f32) -> Result<(), ParameterError> {
        let e = parameters;
        let greatest = Self::STEP_MAX / period;
        for (bandwidth, field) in [
            (e.force_bandwidth_across, "estimates.force_bandwidth_across"),
            (e.force_bandwidth_vertical, "estimates.force_bandwidth_vertical"),
        ] {
            require(bandwidth <= greatest, field, Reason::Above(greatest))?;
        }
        Ok(())
    }

    /// For steps of `period`, s.
    ///
    /// # Errors
    /// [`Self::check`]'s.
    pub fn new(parameters: &EstimateParameters, period: f32) -> Result<Self, ParameterError> {
        Self::check(parameters, period)?;
        let e = parameters;
        Ok(Self {
            period,
            across: Axis::new(e.force_bandwidth_across, e.force_across, e.force_snap_across),
            vertical: Axis::new(e.force_bandwidth_vertical, e.force_vertical, e.force_snap_vertical),
        })
    }

    /// d'', m/s^4, to be held for the period to come.
    #[must_use]
    pub fn acceleration(&self, estimate: &ForceEstimate) -> Vector3<f32> {
        let ForceEstimate { average, value, rate } = estimate;
        Vector3::new(
            self.across.acceleration(average.x, value.x, rate.x, self.period),
            self.across.acceleration(average.y, value.y, rate.y, self.period),
            self.vertical.acceleration(average.z, value.z, rate.z, self.period),
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
