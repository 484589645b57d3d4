//! Input and output of a control tick: the vehicle's state and the wrench.

use crate::error::InputError;
use nalgebra::{Quaternion, Vector3};

/// How far from one a quaternion's length may be; closer ones serve as the rotation they are along, others are refused.
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

/// Refuses the first of `vectors` with a component that is not finite, or greater than the range beside it.
pub(crate) fn check_vectors(vectors: &[(&Vector3<f32>, f32, &'static str)]) -> Result<(), InputError> {
    for &(vector, range, field) in vectors {
        // A NaN compares false with everything, so it fails here too.
        if !vector.iter().all(|component| component.abs() <= range) {
            let finite = vector.iter().all(|component| component.is_finite());
            return Err(if finite { InputError::OutOfRange { field } } else { InputError::NotFinite { field } });
        }
    }
    Ok(())
}

/// The sum of all components' squares: below the square of a range, every component is finite and in that range.
#[inline(always)]
pub(crate) fn sum_of_squares(vectors: &[&Vector3<f32>]) -> f32 {
    vectors.iter().fold(0.0, |sum, v| sum + v.x * v.x + v.y * v.y + v.z * v.z)
}

/// |q|^2, summed in one order everywhere: its parts then serve others.
#[inline(always)]
pub(crate) fn length_squared(q: &Quaternion<f32>) -> f32 {
    q.i * q.i + q.j * q.j + q.k * q.k + q.w * q.w
}

/// Whether `q` is a rotation within [`UNIT_TOLERANCE`]: | |q| - 1 | <= e is | |q|^2 - (1 + e^2) | <= 2 e.
#[inline(always)]
pub(crate) fn is_rotation(q: &Quaternion<f32>) -> bool {
    const SQUARE_AND_TOLERANCE: f32 = 1.0 + UNIT_TOLERANCE * UNIT_TOLERANCE;
    (length_squared(q) - SQUARE_AND_TOLERANCE).abs() <= 2.0 * UNIT_TOLERANCE
}

impl State {
    /// The sum of the squares of position, velocity and angular velocity.
    #[inline(always)]
    pub(crate) fn squares(&self) -> f32 {
        sum_of_squares(&[&self.position, &self.velocity, &self.angular_velocity])
    }

    /// Whether the attitude is a rotation.
    #[inline(always)]
    pub(crate) fn has_unit_attitude(&self) -> bool {
        is_rotation(&self.attitude)
    }

    /// Checks every field, one by one.
    pub(crate) fn check(&self) -> Result<(), InputError> {
        check_vectors(&[
            (&self.position, STATE_RANGE, "state.position"),
            (&self.velocity, STATE_RANGE, "state.velocity"),
            (&self.angular_velocity, STATE_RANGE, "state.angular_velocity"),
        ])?;
        let field = "state.attitude";
        if self.has_unit_attitude() {
            Ok(())
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

impl Wrench {
    /// The same wrench, `factor` times as strong.
    pub fn scaled(&self, factor: f32) -> Self {
        Self { thrust: self.thrust * factor, torque: self.torque * factor }
    }

    /// Whether every component is, for which their sum is enough: what is not finite stays so, whatever is added.
    pub(crate) fn is_finite(&self) -> bool {
        (self.thrust + self.torque.x + self.torque.y + self.torque.z).is_finite()
    }
}

#[cfg(test)]
mod tests;
