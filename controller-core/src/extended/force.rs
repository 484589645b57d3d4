//! An estimate of the unmodelled force, per mass: wind, drag, errors of mass and thrust. Section 2 of
//! `docs/extended-law.md`.
//!
//! | here | equation |
//! |---|---|
//! | [`ForceObserver::driven_acceleration`] | v' + g e3 + kappa v: the acceleration by thrust and unknown force |
//! | [`ForceObserver::mean_acceleration`] | v' = (v_k - v_(k-1)) / h, where it is not measured |
//! | [`ForceObserver::filtered`] | zeta += (1 - e^(-L h)) (a - zeta), a being what is made beside the thrust, s bbar F / m |
//! | [`ForceObserver::estimate`] | d: zeta cut to D_h across (radially), to D_z+ upwards and D_z- downwards |
//!
//! d enters the position law and passes its filters, so that no derivative of it is needed.

use super::parameters::ExtendedParameters;
use crate::math;
use core::hint::cold_path;
use nalgebra::Vector3;

/// The part of U that a force may use up together with the reference.
pub const HELD_SHARE: f32 = 0.99;

/// The constants of learning from an interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceObserver {
    per_period: f32,
    gravity: f32,
    /// kappa / 2, 1/s.
    half_drag: f32,
    /// 1 - e^(-L h).
    averaging_across: f32,
    averaging_vertical: f32,
    across: f32,
    up: f32,
    down: f32,
}

impl ForceObserver {
    /// For intervals of `period`, s, under `gravity`, m/s^2.
    #[must_use]
    pub fn new(parameters: &ExtendedParameters, gravity: f32, period: f32) -> Self {
        let averaging = |bandwidth: f32| -math::exp_m1(-f64::from(bandwidth) * f64::from(period)) as f32;
        Self {
            per_period: 1.0 / period,
            gravity,
            half_drag: 0.5 * parameters.drag_across,
            averaging_across: averaging(parameters.force_bandwidth_across),
            averaging_vertical: averaging(parameters.force_bandwidth_vertical),
            across: parameters.force_across,
            up: parameters.force_up,
            down: parameters.force_down,
        }
    }

    /// The mean acceleration over an interval by its difference of `velocities`, m/s, at start and end.
    #[must_use]
    pub fn mean_acceleration(&self, velocities: [&Vector3<f32>; 2]) -> Vector3<f32> {
        let [start, end] = velocities;
        (end - start) * self.per_period
    }

    /// The mean `acceleration` over an interval without gravity and known drag, m/s^2, world frame. `velocities`, m/s,
    /// belong to the interval's start and end.
    #[must_use]
    pub fn driven_acceleration(&self, acceleration: Vector3<f32>, velocities: [&Vector3<f32>; 2]) -> Vector3<f32> {
        let [start, end] = velocities;
        let mut made = acceleration;
        made.x += self.half_drag * (start.x + end.x);
        made.y += self.half_drag * (start.y + end.y);
        made.z += self.gravity;
        made
    }

    /// Averages the `rest` of the observed acceleration, without the thrust's part, into zeta.
    #[must_use]
    pub fn filtered(&self, average: &Vector3<f32>, rest: &Vector3<f32>) -> Vector3<f32> {
        Vector3::new(
            average.x + self.averaging_across * (rest.x - average.x),
            average.y + self.averaging_across * (rest.y - average.y),
            average.z + self.averaging_vertical * (rest.z - average.z),
        )
    }

    /// d, m/s^2, world frame.
    #[must_use]
    pub fn estimate(&self, average: &Vector3<f32>) -> Vector3<f32> {
        let square = average.x * average.x + average.y * average.y;
        let share = if square > self.across * self.across { self.across / math::sqrt(square) } else { 1.0 };
        Vector3::new(average.x * share, average.y * share, math::clamp(average.z, -self.down, self.up))
    }
}

/// The part of `force` that the greatest |u|, m/s^2, holds where u at the target is `rest` - d, world frame: the
/// vertical first, across what it leaves.
#[must_use]
#[inline(always)] // see position.rs
pub fn held(force: &Vector3<f32>, rest: &Vector3<f32>, greatest: f32) -> Vector3<f32> {
    let most = greatest * HELD_SHARE;
    let lift = rest.z - force.z;
    let (wind, across) = (force.xy().norm_squared(), rest.xy().norm_squared());
    // (a + b)^2 <= 2 (a^2 + b^2).
    if lift <= most && lift * lift + 2.0 * (wind + across) <= most * most {
        return *force;
    }
    cold_path();
    let lift = math::min(lift, most);
    let left = math::sqrt(math::max(most * most - lift * lift, 0.0)) - math::sqrt(across);
    let length = math::sqrt(wind);
    // Without a wind there is nothing to cut, whatever the reference takes.
    let share = if length > left { math::max(left, 0.0) / math::max(length, f32::MIN_POSITIVE) } else { 1.0 };
    Vector3::new(force.x * share, force.y * share, rest.z - lift)
}
