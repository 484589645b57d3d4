//! What goes into a control tick and what comes out: the vehicle's state and the wrench.

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

/// Refuses non-finite components and magnitudes beyond `range`.
#[inline]
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

impl State {
    /// The sum of the squares of position and velocity.
    #[inline(always)]
    pub(crate) fn travel_squares(&self) -> f32 {
        sum_of_squares(&[&self.position, &self.velocity])
    }

    /// The sum of the squares of the angular velocity.
    #[inline(always)]
    pub(crate) fn turning_squares(&self) -> f32 {
        sum_of_squares(&[&self.angular_velocity])
    }

    /// Whether the attitude is a rotation within [`UNIT_TOLERANCE`]: | |q| - 1 | <= e is | |q|^2 - (1 + e^2) | <= 2 e.
    #[inline(always)]
    pub(crate) fn has_unit_attitude(&self) -> bool {
        const SQUARE: f32 = 1.0 + UNIT_TOLERANCE * UNIT_TOLERANCE;
        (length_squared(&self.attitude) - SQUARE).abs() <= 2.0 * UNIT_TOLERANCE
    }

    /// Checks every field, one by one.
    #[inline]
    pub(crate) fn check(&self) -> Result<(), InputError> {
        check_vector(&self.position, STATE_RANGE, "state.position")?;
        check_vector(&self.velocity, STATE_RANGE, "state.velocity")?;
        check_vector(&self.angular_velocity, STATE_RANGE, "state.angular_velocity")?;
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
    /// Whether every component is.
    pub(crate) fn is_finite(&self) -> bool {
        self.thrust.is_finite() && self.torque.iter().all(|component| component.is_finite())
    }
}
