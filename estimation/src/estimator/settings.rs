//! The sensors' noise and biases, and the limits on poses.
//!
//! ```text
//! gyro            omega_m = omega + b_g + n_g       b_g' = w_g
//! accelerometer   f_m = R' (v' + g e3) + b_a + n_a   b_a' = w_a
//! pose            p_m = p + n_p,   q_m = exp(n_q) * q
//! ```
//!
//! n_g, n_a, w_g and w_a are white; they are given as the root of their density. n_p and n_q are drawn for each pose. A
//! pose whose time stamp is off by sigma_t is displaced by v sigma_t and turned by omega sigma_t: that counts as noise
//! too.
//!
//! [`EstimatorParameters::BMI088`] has the data sheet's densities (Bosch, BST-BMI088-DS001, tables 2 and 3: 0.014
//! deg/s/sqrt(Hz), 190 ug/sqrt(Hz) on the worst axis). The sheet gives no random walk of the biases. Ours is a tenth of
//! a degree a second, and 20 mg, in the square root of three hours: generous, since the filter pays nothing for it in a
//! flight of minutes.

use controller_core::error::{ParameterError, Reason, require, require_finite, require_positive};
use controller_core::vehicle::Vehicle;

/// The sensors' noise and limits. SI units, radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimatorParameters {
    /// Density of n_g, rad/s/sqrt(Hz).
    pub gyro_noise: f32,
    /// Density of n_a, m/s^2/sqrt(Hz).
    pub accelerometer_noise: f32,
    /// Density of w_g, rad/s^2/sqrt(Hz).
    pub gyro_walk: f32,
    /// Density of w_a, m/s^3/sqrt(Hz).
    pub accelerometer_walk: f32,
    /// Standard deviation of b_g on each axis before the first pose, after calibration, rad/s.
    pub gyro_bias: f32,
    /// Standard deviation of b_a on each axis before the first pose, m/s^2.
    pub accelerometer_bias: f32,
    /// |b_g| beyond which a gyro is not plausible, rad/s: far enough beyond its deviation that no sound gyro is refused.
    pub gyro_bias_max: f32,
    /// |b_a| beyond which the accelerometer and the poses do not agree on where up is, m/s^2.
    pub accelerometer_bias_max: f32,
    /// Deviation of n_p on each axis, m, of poses that do not give their own; no pose is believed to be better.
    pub position_noise: f32,
    /// Deviation of n_q on each axis, rad, in the same way.
    pub attitude_noise: f32,
    /// sigma_t, s.
    pub time_noise: f32,
    /// Deviation of a pose's velocity on each axis, m/s; zero where velocities of poses are not believed.
    pub velocity_noise: f32,
    /// g, m/s^2.
    pub gravity: f32,
}

impl EstimatorParameters {
    /// A BMI088 whose biases at standstill were calibrated, and poses of a camera system: 1 mm, 0.3 degrees, 1 ms.
    pub const BMI088: Self = Self {
        gyro_noise: 2.44e-4,
        accelerometer_noise: 1.86e-3,
        gyro_walk: 1.7e-5,
        accelerometer_walk: 1.9e-3,
        gyro_bias: 5e-3,
        accelerometer_bias: 0.2,
        gyro_bias_max: 0.025,
        accelerometer_bias_max: 1.0,
        position_noise: 1e-3,
        attitude_noise: 5.2e-3,
        time_noise: 1e-3,
        velocity_noise: 0.0,
        gravity: 9.81,
    };
}

/// Checked [`EstimatorParameters`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings(EstimatorParameters);

/// The least deviation of a position and of an attitude that single precision resolves with room to spare, m and rad.
const DEVIATION_MIN: f32 = 1e-4;

/// The greatest of any deviation or density.
const DEVIATION_MAX: f32 = 10.0;

impl Settings {
    /// [`EstimatorParameters::BMI088`], with a vehicle's gravity.
    pub fn bmi088(vehicle: &Vehicle) -> Self {
        // A vehicle's gravity is positive, and the rest is checked by a test.
        Self(EstimatorParameters { gravity: vehicle.gravity, ..EstimatorParameters::BMI088 })
    }

    /// Checks `parameters`.
    ///
    /// # Errors
    /// Names the field that is not finite, not positive where it must be, or out of range.
    pub fn new(parameters: &EstimatorParameters) -> Result<Self, ParameterError> {
        let p = parameters;
        for (value, field) in [
            (p.gyro_noise, "estimator.gyro_noise"),
            (p.accelerometer_noise, "estimator.accelerometer_noise"),
            (p.gyro_bias, "estimator.gyro_bias"),
            (p.accelerometer_bias, "estimator.accelerometer_bias"),
            (p.gyro_bias_max, "estimator.gyro_bias_max"),
            (p.accelerometer_bias_max, "estimator.accelerometer_bias_max"),
            (p.position_noise, "estimator.position_noise"),
            (p.attitude_noise, "estimator.attitude_noise"),
        ] {
            require_positive(value, field)?;
            require(value < DEVIATION_MAX, field, Reason::NotBelow(DEVIATION_MAX))?;
        }
        for (value, field) in [
            (p.gyro_walk, "estimator.gyro_walk"),
            (p.accelerometer_walk, "estimator.accelerometer_walk"),
            (p.time_noise, "estimator.time_noise"),
            (p.velocity_noise, "estimator.velocity_noise"),
        ] {
            require_finite(value, field)?;
            require(value >= 0.0, field, Reason::Negative)?;
            require(value < DEVIATION_MAX, field, Reason::NotBelow(DEVIATION_MAX))?;
        }
        require_positive(p.gravity, "vehicle.gravity")?;
        Ok(Self(*p))
    }

    /// What they were made from.
    pub fn parameters(&self) -> &EstimatorParameters {
        &self.0
    }

    /// The deviations of a pose that reports `given` (position m, attitude rad), at least the settings'. A pose that
    /// claims to be more exact than it is would be refused for its own noise.
    pub(super) fn deviations(&self, given: Option<(f32, f32)>) -> (f32, f32) {
        let usual = (self.0.position_noise, self.0.attitude_noise);
        let floor = |value: f32, usual: f32| {
            let min = if usual > DEVIATION_MIN { usual } else { DEVIATION_MIN };
            controller_core::math::clamp(value, min, DEVIATION_MAX)
        };
        let (position, attitude) = given.unwrap_or(usual);
        (floor(position, usual.0), floor(attitude, usual.1))
    }
}

#[cfg(test)]
mod tests;
