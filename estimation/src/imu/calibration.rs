//! The calibration of a sensor: the gyro's bias, the accelerometer's offsets and scales, and the tilt at which it sits.
//!
//! ```text
//! omega = L (omega_m - b)          f = L S (f_m - o)          S diagonal, L a small rotation
//! ```
//!
//! b comes from [`super::standstill`], o and S from [`super::six_point`], and L from one more standstill with the
//! *vehicle* level: the rotation about a horizontal axis that takes the mean force to straight up. A turn of the sensor
//! about the vertical cannot be seen by standing still; the mounting must have that right.

use super::standstill::StandstillMeans;
use controller_core::math;
use nalgebra::{Matrix3, Vector3};

/// The cosine of the greatest tilt that levelling corrects, 5 degrees: more is a slope, or a sensor mounted otherwise.
const LEVEL_COSINE: f32 = 0.996_194_7;

/// What corrects samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// b, rad/s, sensor's axes.
    pub gyro_bias: Vector3<f32>,
    /// o, m/s^2, sensor's axes.
    pub offset: Vector3<f32>,
    /// The diagonal of S.
    pub scale: Vector3<f32>,
    /// L.
    pub level: Matrix3<f32>,
}

/// Level calibration found the vehicle tilted by more than 5 degrees, or no gravity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NotLevel;

impl core::fmt::Display for NotLevel {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Not level: tilted by more than 5 degrees")
    }
}

impl Calibration {
    /// Corrects nothing.
    pub const NONE: Self = Self {
        gyro_bias: Vector3::new(0.0, 0.0, 0.0),
        offset: Vector3::new(0.0, 0.0, 0.0),
        scale: Vector3::new(1.0, 1.0, 1.0),
        level: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
    };

    /// omega, rad/s.
    pub fn rate(&self, measured: &Vector3<f32>) -> Vector3<f32> {
        self.level * (measured - self.gyro_bias)
    }

    /// f, m/s^2.
    pub fn force(&self, measured: &Vector3<f32>) -> Vector3<f32> {
        self.level * (measured - self.offset).component_mul(&self.scale)
    }

    /// The same with the gyro's bias as a standstill showed it.
    pub fn with_gyro_bias(&self, rest: &StandstillMeans) -> Self {
        Self { gyro_bias: rest.angular_velocity, ..*self }
    }

    /// The same, levelled by a standstill of the level vehicle: L takes u = S (f_m - o) / |…| to e3, about the axis u x
    /// e3.
    ///
    /// ```text
    /// L = I + [a]x + [a]x^2 / (1 + u_z),   a = u x e3
    /// ```
    ///
    /// # Errors
    /// If the sensor is tilted by more than 5 degrees, or feels no gravity.
    pub fn levelled(&self, rest: &StandstillMeans) -> Result<Self, NotLevel> {
        let force = (rest.specific_force - self.offset).component_mul(&self.scale);
        let up = force / math::sqrt(force.norm_squared());
        // Without gravity the direction up is NaN, and not level.
        let level = up.z >= LEVEL_COSINE;
        if !level {
            return Err(NotLevel);
        }
        let axis = up.cross(&Vector3::z()).cross_matrix();
        Ok(Self { level: Matrix3::identity() + axis + axis * axis * (1.0 / (1.0 + up.z)), ..*self })
    }
}

#[cfg(test)]
mod tests;
