//! The vehicle and its actuation limits, validated.

use crate::error::{ParameterError, Reason, require, require_finite, require_positive};
use core::ops::Deref;
use nalgebra::Vector3;

/// Names of the three torque limits, for errors.
const TORQUE_MAX_FIELDS: [&str; 3] = ["limits.torque_max[0]", "limits.torque_max[1]", "limits.torque_max[2]"];

/// What a rigid body needs to be described; see [`Vehicle`] for the validated form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VehicleParameters {
    /// Mass m, kg.
    pub mass: f32,
    /// Principal moments of inertia, the diagonal of J, kg m^2, body axes.
    pub inertia: Vector3<f32>,
    /// Gravitational acceleration g, m/s^2, positive; gravity pulls along -e3.
    pub gravity: f32,
}

/// A rigid body that can exist. Reads like its [`VehicleParameters`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vehicle(VehicleParameters);

impl Vehicle {
    /// By how much, relative, the largest moment of inertia may exceed the sum of the others. Moments are measured, and
    /// measured moments of flat vehicles come out slightly beyond the inequality: the paper's own by 3.1 %.
    pub const INERTIA_ALLOWANCE: f32 = 0.05;

    /// Checks that every number is finite and positive and that the inertia belongs to some mass distribution.
    ///
    /// # Errors
    /// Names the first field that is not.
    pub fn new(parameters: VehicleParameters) -> Result<Self, ParameterError> {
        let j = parameters.inertia;
        require_positive(parameters.mass, "vehicle.mass")?;
        require_positive(j.x, "vehicle.inertia[0]")?;
        require_positive(j.y, "vehicle.inertia[1]")?;
        require_positive(j.z, "vehicle.inertia[2]")?;
        require_positive(parameters.gravity, "vehicle.gravity")?;
        let largest = j.max();
        let others = j.sum() - largest;
        let rigid = largest <= (1.0 + Self::INERTIA_ALLOWANCE) * others;
        require(rigid, "vehicle.inertia", Reason::TriangleInequality)?;
        Ok(Self(parameters))
    }
}

impl Deref for Vehicle {
    type Target = VehicleParameters;

    fn deref(&self) -> &VehicleParameters {
        &self.0
    }
}

/// The user's limits on the wrench; see [`Limits`] for the validated form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitParameters {
    /// Greatest thrust T_max, N.
    pub thrust_max: f32,
    /// Greatest |torque| about each body axis, tau_max, N m.
    pub torque_max: Vector3<f32>,
}

/// Limits under which the vehicle can at least hover. Reads like its [`LimitParameters`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits(LimitParameters);

impl Limits {
    /// Checks that the limits are positive and that `vehicle` can hover below `thrust_max`.
    ///
    /// # Errors
    /// Names the field; [`Reason::NotAbove`] carries the hover thrust m g.
    pub fn new(parameters: LimitParameters, vehicle: &Vehicle) -> Result<Self, ParameterError> {
        require_finite(parameters.thrust_max, "limits.thrust_max")?;
        let hover = vehicle.mass * vehicle.gravity;
        require(parameters.thrust_max > hover, "limits.thrust_max", Reason::NotAbove(hover))?;
        for (torque, field) in parameters.torque_max.iter().zip(TORQUE_MAX_FIELDS) {
            require_positive(*torque, field)?;
        }
        Ok(Self(parameters))
    }
}

impl Deref for Limits {
    type Target = LimitParameters;

    fn deref(&self) -> &LimitParameters {
        &self.0
    }
}

#[cfg(test)]
mod tests;
