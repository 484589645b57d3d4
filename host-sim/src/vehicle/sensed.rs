//! What an IMU and motor controllers say beside the state: the force and the torque on the vehicle.
//!
//! ```text
//! f = R_m' ((v_k - v_k-1) / T + g e3)     R_m: halfway between the attitudes at the two ticks
//! ```
//!
//! f is the mean specific force since the last tick. The rotors' wrench is the mean over the same time, from measured
//! speeds and the coefficients that the controller knows: a weak rotor's thrust is less than it says, a sagging
//! battery's is not. Without rotors it is the wrench that acts.

use controller_core::vehicle::Vehicle;
use nalgebra::{UnitQuaternion, Vector3, Vector4};
use scenario::body::BodyState;

/// What is measured beside the state, at a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensed {
    /// f, m/s^2, body: what an accelerometer at the origin feels.
    pub specific_force: Vector3<f64>,
    /// Thrust, N, and torque, N m, body, of the rotors as they turned.
    pub wrench: Vector4<f64>,
}

impl Sensed {
    /// Of a `vehicle` that hovers level.
    pub fn hovering(vehicle: &Vehicle) -> Self {
        let (mass, gravity) = (f64::from(vehicle.mass), f64::from(vehicle.gravity));
        Self { specific_force: Vector3::z() * gravity, wrench: Vector4::x() * (mass * gravity) }
    }
}

/// The mean specific force, m/s^2, body, between two states that are `period`, s, apart, under `gravity`, m/s^2.
pub fn specific_force(before: &BodyState, now: &BodyState, period: f64, gravity: f64) -> Vector3<f64> {
    let acceleration = (now.velocity - before.velocity) / period;
    let halfway = UnitQuaternion::new_normalize(before.attitude + now.attitude);
    halfway.inverse_transform_vector(&(acceleration + Vector3::z() * gravity))
}

/// A sum of wrenches, for their mean.
#[derive(Debug, Clone, Default)]
pub struct Acted {
    sum: Vector4<f64>,
    count: u32,
}

impl Acted {
    /// Takes the thrust, N, and the torque, N m, of a plant step.
    #[inline]
    pub fn add(&mut self, thrust: f64, torque: &Vector3<f64>) {
        self.sum += Vector4::new(thrust, torque.x, torque.y, torque.z);
        self.count += 1;
    }

    /// The mean since the last call; none without a step between.
    pub fn take(&mut self) -> Option<Vector4<f64>> {
        let Self { sum, count } = std::mem::take(self);
        (count > 0).then(|| sum / f64::from(count))
    }
}

#[cfg(test)]
mod tests;
