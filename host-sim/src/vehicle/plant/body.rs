//! The vehicle's numbers in the equations of motion, and the limits of its thrust and torque.

use controller_core::state::Wrench;
use controller_core::vehicle::{Limits, Vehicle};
use nalgebra::Vector3;

/// A rigid body, and the step in which its motion is integrated.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// 1/m, 1/kg.
    pub inverse_mass: f64,
    /// g, m/s^2.
    pub gravity: f64,
    /// Diagonal of J^-1, 1/(kg m^2).
    pub inverse_inertia: Vector3<f64>,
    /// (J_jj - J_kk) / J_ii: what omega_j omega_k adds to omega_i'.
    pub gyroscopic: Vector3<f64>,
    /// h, s.
    pub step: f64,
    thrust_max: f64,
    torque_max: Vector3<f64>,
}

impl Body {
    /// For `vehicle`, moved within `limits`, in steps of `step` seconds.
    pub fn new(vehicle: &Vehicle, limits: &Limits, step: f64) -> Self {
        let inertia = vehicle.inertia.map(f64::from);
        let differences = Vector3::new(inertia.y - inertia.z, inertia.z - inertia.x, inertia.x - inertia.y);
        Self {
            inverse_mass: 1.0 / f64::from(vehicle.mass),
            gravity: f64::from(vehicle.gravity),
            inverse_inertia: inertia.map(|moment| 1.0 / moment),
            gyroscopic: differences.component_div(&inertia),
            step,
            thrust_max: f64::from(limits.thrust_max),
            torque_max: limits.torque_max.map(f64::from),
        }
    }

    /// Thrust, N, and torque, N m, of `wrench` as far as the limits let them act, and whether they cut anything.
    #[inline]
    pub fn clipped(&self, wrench: &Wrench) -> (f64, Vector3<f64>, bool) {
        let commanded = (f64::from(wrench.thrust), wrench.torque.map(f64::from));
        let thrust = commanded.0.clamp(0.0, self.thrust_max);
        let torque = commanded.1.zip_map(&self.torque_max, |value, limit| value.clamp(-limit, limit));
        (thrust, torque, thrust != commanded.0 || torque != commanded.1)
    }
}
