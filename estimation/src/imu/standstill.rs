//! Means of a sensor that stands still, and the test that it does.
//!
//! Over [`STANDSTILL_SAMPLES`] samples the means of both halves and the spread of all are taken, as differences from
//! the first sample so that single precision loses nothing. The sensor stood still if
//!
//! - neither spread is larger than noise: a hand, or a motor that runs, shows there;
//! - the halves' means agree: a slow rotation moves gravity between them, by 9.81 m/s^2 times the angle;
//! - the mean rate is one that a bias can be: the data sheet allows a BMI088 1 deg/s.
//!
//! A rotation of less than that about the vertical passes for a bias. Nothing at standstill distinguishes the two.

use core::fmt;
use nalgebra::Vector3;

/// Samples of a standstill: 1 s at 1 kHz.
pub const STANDSTILL_SAMPLES: u16 = 1_000;

/// The greatest deviation of a rate on an axis, rad/s: BMI088 noise is 3.3e-3 in its 116 Hz.
const RATE_DEVIATION_MAX_RAD_PER_S: f32 = 0.015;

/// The greatest deviation of a force on an axis, m/s^2: BMI088 noise is 0.025 in its 145 Hz.
const FORCE_DEVIATION_MAX_M_PER_S2: f32 = 0.1;

/// The greatest difference of a half's mean force, m/s^2: 0.2 degrees of rotation.
const FORCE_DRIFT_MAX_M_PER_S2: f32 = 0.034;

/// The greatest bias on an axis, rad/s: 2 deg/s, twice the data sheet's.
const RATE_BIAS_MAX_RAD_PER_S: f32 = 0.035;

/// The means of a sensor at standstill, before calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StandstillMeans {
    /// The mean rate, rad/s.
    pub angular_velocity: Vector3<f32>,
    /// The mean specific force, m/s^2.
    pub specific_force: Vector3<f32>,
}

/// It did not stand still.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Moved {
    /// Rates or forces spread by more than noise, or are not finite.
    Shaken,
    /// Gravity was elsewhere in the second half.
    Turning,
    /// Its mean rate is too large for a bias.
    TooFast,
}

impl fmt::Display for Moved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Shaken => "Calibration: the vehicle was shaken",
            Self::Turning => "Calibration: the vehicle was turning",
            Self::TooFast => "Calibration: the gyro reads over 2 deg/s at rest",
        })
    }
}

/// Sums of deviations from the first sample, and of their squares.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Sums {
    rate: Vector3<f32>,
    force: Vector3<f32>,
    rate_squares: Vector3<f32>,
    force_squares: Vector3<f32>,
}

/// A standstill under way.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Standstill {
    count: u16,
    first: Option<StandstillMeans>,
    /// The sums at half time.
    half: Sums,
    all: Sums,
}

impl Standstill {
    /// Takes a sample as the sensor gives it, rad/s and m/s^2; after [`STANDSTILL_SAMPLES`] of them, returns their
    /// means, and begins anew.
    pub fn take(&mut self, rate: &Vector3<f32>, force: &Vector3<f32>) -> Option<Result<StandstillMeans, Moved>> {
        let first = *self.first.get_or_insert(StandstillMeans { angular_velocity: *rate, specific_force: *force });
        let (rate, force) = (rate - first.angular_velocity, force - first.specific_force);
        self.all.rate += rate;
        self.all.force += force;
        self.all.rate_squares += rate.component_mul(&rate);
        self.all.force_squares += force.component_mul(&force);
        self.count += 1;
        if self.count == STANDSTILL_SAMPLES / 2 {
            self.half = self.all;
        }
        if self.count < STANDSTILL_SAMPLES {
            return None;
        }
        let judged = self.judge(&first);
        *self = Self::default();
        Some(judged)
    }

    fn judge(&self, first: &StandstillMeans) -> Result<StandstillMeans, Moved> {
        let share = 1.0 / f32::from(STANDSTILL_SAMPLES);
        let (rate, force) = (self.all.rate * share, self.all.force * share);
        let variance = |squares: &Vector3<f32>, mean: &Vector3<f32>| squares * share - mean.component_mul(mean);
        let still = variance(&self.all.rate_squares, &rate)
            .iter()
            .all(|&v| v <= RATE_DEVIATION_MAX_RAD_PER_S * RATE_DEVIATION_MAX_RAD_PER_S)
            && variance(&self.all.force_squares, &force)
                .iter()
                .all(|&v| v <= FORCE_DEVIATION_MAX_M_PER_S2 * FORCE_DEVIATION_MAX_M_PER_S2);
        if !still {
            return Err(Moved::Shaken);
        }
        let drift = (self.all.force - self.half.force * 2.0) * (2.0 * share);
        if drift.iter().any(|component| component.abs() > FORCE_DRIFT_MAX_M_PER_S2) {
            return Err(Moved::Turning);
        }
        let angular_velocity = first.angular_velocity + rate;
        if angular_velocity.iter().any(|component| component.abs() > RATE_BIAS_MAX_RAD_PER_S) {
            return Err(Moved::TooFast);
        }
        Ok(StandstillMeans { angular_velocity, specific_force: first.specific_force + force })
    }
}

#[cfg(test)]
mod tests;
