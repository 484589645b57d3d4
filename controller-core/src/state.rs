//! What goes into a control tick and what comes out: the vehicle's state and the wrench.

use crate::error::InputError;
use crate::math;
use nalgebra::{Quaternion, Vector3};

/// How far from one a quaternion's length may be; closer ones are normalised, others refused.
pub const UNIT_TOLERANCE: f32 = 1e-3;

/// The greatest magnitude of a state's component: its square still fits single precision with room to spare.
pub const STATE_RANGE: f32 = 1e15;

/// Where the vehicle is and how it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Position p, m, world frame (z up).
    pub position: Vector3<f32>,
    /// Velocity v, m/s, world frame.
    pub velocity: Vector3<f32>,
    /// Attitude, body to world, scalar first, unit length within [`UNIT_TOLERANCE`]; its sign does not matter.
    pub attitude: Quaternion<f32>,
    /// Angular velocity omega, rad/s, body frame.
    pub angular_velocity: Vector3<f32>,
}

/// Refuses non-finite components and magnitudes beyond `range`.
pub(crate) fn check_vector(vector: &Vector3<f32>, range: f32, field: &'static str) -> Result<(), InputError> {
    // A NaN compares false with everything, so it fails here too; no branch until all three are compared.
    let within = |component: f32| component.abs() <= range;
    if within(vector.x) & within(vector.y) & within(vector.z) {
        Ok(())
    } else if vector.iter().all(|component| component.is_finite()) {
        Err(InputError::OutOfRange { field })
    } else {
        Err(InputError::NotFinite { field })
    }
}

impl State {
    /// Checks every field and returns the attitude as an exactly normalised quaternion.
    pub(crate) fn checked_attitude(&self) -> Result<Quaternion<f32>, InputError> {
        check_vector(&self.position, STATE_RANGE, "state.position")?;
        check_vector(&self.velocity, STATE_RANGE, "state.velocity")?;
        check_vector(&self.angular_velocity, STATE_RANGE, "state.angular_velocity")?;
        let field = "state.attitude";
        let length = math::sqrt(self.attitude.norm_squared());
        if (length - 1.0).abs() <= UNIT_TOLERANCE {
            Ok(self.attitude * (1.0 / length))
        } else if self.attitude.coords.iter().all(|component| component.is_finite()) {
            Err(InputError::NotARotation { field })
        } else {
            Err(InputError::NotFinite { field })
        }
    }
}

/// Thrust along body z and torque about the body axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench {
    /// Thrust T, N, along +body z.
    pub thrust: f32,
    /// Torque tau, N m, body frame.
    pub torque: Vector3<f32>,
}
