//! An estimate of a constant torque: a centre of mass off the rotors' middle, a weak rotor. Section 7 of
//! `docs/extended-law.md`.
//!
//! | here | equation |
//! |---|---|
//! | [`TorqueBias::observed`] | J (omega_k - omega_(k-1)) / h + omega x J omega - tau, with omega and tau the means over the interval |
//! | [`TorqueBias::filtered`] | the same averaged with the bandwidth L_tau |
//! | [`TorqueBias::estimate`] | each component cut to its level |
//!
//! The estimate is subtracted from the torque; nothing else depends on it, so that no derivative of it is needed.

use super::parameters::ExtendedParameters;
use crate::math;
use nalgebra::Vector3;

/// The estimate's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueBias {
    /// 1 - e^(-L_tau h), about z 1 - e^(-L_tau h / 2).
    averaging: Vector3<f32>,
    level: Vector3<f32>,
    /// The diagonal of J over h, kg m^2/s.
    inertia_per_period: Vector3<f32>,
    /// (J_z - J_y, J_x - J_z, J_y - J_x) / 4, kg m^2: the mean of two rates, twice in a product, is a quarter of their
    /// sums'.
    quarter_differences: Vector3<f32>,
}

impl TorqueBias {
    /// For steps of `period`, s, and the diagonal of J, kg m^2.
    #[must_use]
    pub fn new(parameters: &ExtendedParameters, inertia: &Vector3<f32>, period: f32) -> Self {
        let ExtendedParameters { torque_tilt, torque_yaw, torque_bandwidth, .. } = *parameters;
        let averaging = |bandwidth: f64| -math::exp_m1(-bandwidth * f64::from(period)) as f32;
        let bandwidth = f64::from(torque_bandwidth);
        let [tilt, yaw] = [bandwidth, 0.5 * bandwidth].map(averaging);
        Self {
            averaging: Vector3::new(tilt, tilt, yaw),
            level: Vector3::new(torque_tilt, torque_tilt, torque_yaw),
            inertia_per_period: inertia / period,
            quarter_differences: (inertia.zxy() - inertia.yzx()) * 0.25,
        }
    }

    /// The unexplained torque over an interval, beside the torque that acted, N m, body frame.
    ///
    /// `angular_velocities` are those at the interval's start and end, rad/s; `torque` the mean of the torque that
    /// acted, N m.
    #[must_use]
    pub fn observed(&self, angular_velocities: [&Vector3<f32>; 2], torque: &Vector3<f32>) -> Vector3<f32> {
        let [start, end] = angular_velocities;
        let sum = start + end;
        self.inertia_per_period.component_mul(&(end - start))
            + self.quarter_differences.component_mul(&sum.yzx()).component_mul(&sum.zxy())
            - torque
    }

    /// Takes the [observed](Self::observed) torque into the `average`, N m.
    #[must_use]
    pub fn filtered(&self, average: &Vector3<f32>, observed: &Vector3<f32>) -> Vector3<f32> {
        average + (observed - average).component_mul(&self.averaging)
    }

    /// The average cut to its levels, N m.
    #[must_use]
    pub fn estimate(&self, average: &Vector3<f32>) -> Vector3<f32> {
        average.zip_map(&self.level, math::saturate)
    }
}
