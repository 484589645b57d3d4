//! Vibration of the accelerometer, as ArduPilot measures it, so that its limits serve: below 15 m/s^2 is well, above 30
//! m/s^2 is trouble for any estimate.
//!
//! On each axis, with the mean of the specific force through a first-order low-pass of 5 Hz and the square of what is
//! left through one of 2 Hz,
//!
//! ```text
//! m' = 2 pi 5 Hz (f - m),   s' = 2 pi 2 Hz ((f - m)^2 - s),   level = sqrt(s)
//! ```
//!
//! A sample at full scale is counted: there the sensor is blind. Ask the levels of motors that turn: a person's hand
//! shows as well.

use controller_core::math;
use core::f32::consts::TAU;
use nalgebra::Vector3;

/// Cut-off of the mean.
const MEAN_HZ: f32 = 5.0;

/// Cut-off of the squares' mean.
const LEVEL_HZ: f32 = 2.0;

/// The part of the full scale from which on a sample counts as clipped.
const CLIPPED_FROM: f32 = 0.99;

/// The longest time between samples that counts, s: a filter of 5 Hz takes no more.
const STEP_MAX_S: f32 = 0.02;

/// How much it vibrates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VibrationReport {
    /// Level on each body axis, m/s^2.
    pub level: Vector3<f32>,
    /// Samples at full scale since boot.
    pub clipped: u32,
}

/// What the samples have shown so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Vibration {
    /// The accelerometer's full scale, m/s^2.
    range: f32,
    mean: Option<Vector3<f32>>,
    squares: Vector3<f32>,
    clipped: u32,
}

impl Vibration {
    /// Of an accelerometer of this full scale, m/s^2.
    pub fn new(range: f32) -> Self {
        Self { range, mean: None, squares: Vector3::zeros(), clipped: 0 }
    }

    /// Takes a specific force, m/s^2, `elapsed` us after the one before. One that is not finite is left out.
    pub fn take(&mut self, force: &Vector3<f32>, elapsed: u64) {
        if !force.iter().all(|component| component.is_finite()) {
            return;
        }
        let is_clipped = force.iter().any(|component| component.abs() >= CLIPPED_FROM * self.range);
        self.clipped = self.clipped.saturating_add(u32::from(is_clipped));
        let step = (elapsed as f32 * 1e-6).min(STEP_MAX_S);
        let mean = self.mean.get_or_insert(*force);
        let left = *force - *mean;
        *mean += left * share(step, MEAN_HZ);
        self.squares += (left.component_mul(&left) - self.squares) * share(step, LEVEL_HZ);
    }

    /// How much it vibrates.
    pub fn report(&self) -> VibrationReport {
        VibrationReport { level: self.squares.map(|square| math::sqrt(square.max(0.0))), clipped: self.clipped }
    }
}

/// The share of a difference that a first-order low-pass takes in a step, s.
fn share(step: f32, cutoff: f32) -> f32 {
    let turn = TAU * cutoff * step;
    turn / (1.0 + turn)
}

#[cfg(test)]
mod tests;
