//! A heading: a point on the circle with its two derivatives, never a wrapped angle.
//!
//! nu = (cos psi, sin psi) in the horizontal world plane; psi' = nu x nu', psi'' = nu x nu'', and conversely nu' = psi'
//! S nu, nu'' = psi'' S nu - psi'^2 nu with S the quarter turn. The pair (psi', psi'') holds the same facts as (nu',
//! nu'') with the constraint |nu| = 1 built in, so that is what is stored. No angle is.

use crate::error::{ParameterError, Reason, require};
use crate::math;
use nalgebra::{Quaternion, Vector2};

/// A heading nu_d on S^1 with its rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heading {
    direction: Vector2<f32>,
    rate: f32,
    acceleration: f32,
}

impl Heading {
    /// How far from one the length of a direction may be, and its derivatives from the tangent, relative.
    pub const UNIT_LENGTH_TOLERANCE: f32 = 1e-3;

    /// The heading along world x, at rest.
    pub const FORWARD: Self = Self { direction: Vector2::new(1.0, 0.0), rate: 0.0, acceleration: 0.0 };

    /// From a direction (normalised here), psi' in rad/s and psi'' in rad/s^2.
    ///
    /// # Errors
    /// [`Reason::NotFinite`], or [`Reason::NotOnCircle`] if |direction| is not one within
    /// [`Self::UNIT_LENGTH_TOLERANCE`].
    pub fn new(direction: Vector2<f32>, rate: f32, acceleration: f32) -> Result<Self, ParameterError> {
        let finite = direction.x.is_finite() && direction.y.is_finite() && rate.is_finite() && acceleration.is_finite();
        require(finite, "heading", Reason::NotFinite)?;
        let length = math::sqrt(direction.x * direction.x + direction.y * direction.y);
        require((length - 1.0).abs() <= Self::UNIT_LENGTH_TOLERANCE, "heading.direction", Reason::NotOnCircle)?;
        Ok(Self { direction: direction / length, rate, acceleration })
    }

    /// From a direction that another heading gave, taken bit for bit: headings stored as numbers give the same one
    /// back.
    ///
    /// # Errors
    /// As [`Self::new`]'s, and [`Reason::NotOnCircle`] already if |direction| differs from one by more than its own
    /// rounding.
    pub fn restored(direction: Vector2<f32>, rate: f32, acceleration: f32) -> Result<Self, ParameterError> {
        let heading = Self::new(direction, rate, acceleration)?;
        let apart = direction - heading.direction;
        let rounding = 2.0 * f32::EPSILON;
        require(apart.x.abs().max(apart.y.abs()) <= rounding, "heading.direction", Reason::NotOnCircle)?;
        Ok(Self { direction, rate, acceleration })
    }

    /// From the paper's nu_d with its first and second derivative.
    ///
    /// # Errors
    /// As [`Self::new`], and [`Reason::NotOnCircle`] if the derivatives do not belong to a point on the circle:
    /// nu.nu' = 0 and nu.nu'' = -|nu'|^2.
    pub fn from_derivatives(
        direction: Vector2<f32>,
        first: Vector2<f32>,
        second: Vector2<f32>,
    ) -> Result<Self, ParameterError> {
        let rate = direction.x * first.y - direction.y * first.x;
        let acceleration = direction.x * second.y - direction.y * second.x;
        let heading = Self::new(direction, rate, acceleration)?;
        let room = Self::UNIT_LENGTH_TOLERANCE * (1.0 + first.norm_squared() + second.norm());
        let on_circle =
            direction.dot(&first).abs() <= room && (direction.dot(&second) + first.norm_squared()).abs() <= room;
        require(on_circle, "heading.derivatives", Reason::NotOnCircle)?;
        Ok(heading)
    }

    /// From an exact phase psi = `turns` / 2^64 of a full turn, with psi' (rad/s) and psi'' (rad/s^2).
    pub(crate) fn from_phase(turns: u64, rate: f32, acceleration: f32) -> Self {
        let (sin, cos) = math::sin_cos_turns(turns);
        Self { direction: Vector2::new(cos, sin), rate, acceleration }
    }

    /// Where a vehicle's x axis points, at rest; along world x where that points up or down.
    pub fn from_attitude(attitude: &Quaternion<f32>) -> Self {
        let forwards = forwards(attitude);
        let length = math::sqrt(forwards.norm_squared());
        if length > Self::UNIT_LENGTH_TOLERANCE { Self::near_unit(forwards, 0.0, 0.0) } else { Self::FORWARD }
    }

    /// A direction that is not zero, normalised, with rates that are finite.
    pub(crate) fn near_unit(direction: Vector2<f32>, rate: f32, acceleration: f32) -> Self {
        Self { direction: direction / math::sqrt(direction.norm_squared()), rate, acceleration }
    }

    /// The same direction with its rates dropped.
    pub fn at_rest(&self) -> Self {
        Self { rate: 0.0, acceleration: 0.0, ..*self }
    }

    /// nu_d, unit length.
    pub fn direction(&self) -> Vector2<f32> {
        self.direction
    }

    /// psi', rad/s.
    pub fn rate(&self) -> f32 {
        self.rate
    }

    /// psi'', rad/s^2.
    pub fn acceleration(&self) -> f32 {
        self.acceleration
    }

    /// nu_d' = psi' S nu, 1/s.
    pub fn first_derivative(&self) -> Vector2<f32> {
        Vector2::new(-self.direction.y, self.direction.x) * self.rate
    }

    /// nu_d'' = psi'' S nu - psi'^2 nu, 1/s^2.
    pub fn second_derivative(&self) -> Vector2<f32> {
        Vector2::new(-self.direction.y, self.direction.x) * self.acceleration - self.direction * (self.rate * self.rate)
    }
}

/// The horizontal part of R e1, for a quaternion of unit length.
pub(crate) fn forwards(q: &Quaternion<f32>) -> Vector2<f32> {
    Vector2::new(1.0 - 2.0 * (q.j * q.j + q.k * q.k), 2.0 * (q.i * q.j + q.w * q.k))
}

#[cfg(test)]
mod tests;
