//! The vehicle's motion without the vibration of its rotors, by a low-pass.
//!
//! Rotors out of balance vibrate a vehicle that stands or lies. A first-order low-pass, y += h / (T + h) (x - y) in
//! ticks of h with T = [`TIME_CONSTANT_S`], reaches nine tenths of a change after 0.1 s and passes one eighth of a
//! vibration at 25 Hz. Accelerations vibrate most: theirs is of second order, which passes one sixtieth. A hit at speed
//! would stay in it for too long: an acceleration counts up to [`ACCELERATION_MAX_M_PER_S2`] only.

use controller_core::math;
use controller_core::state::State;
use estimation::estimator::EstimatedState;
use nalgebra::Vector3;

const TIME_CONSTANT_S: f32 = 0.04;

/// The largest acceleration that counts along each axis. One tick of it leaves less in the average than wind may.
const ACCELERATION_MAX_M_PER_S2: f32 = 40.0;

/// Averages, and how often the state had jumped.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Average {
    /// m/s.
    velocity: Vector3<f32>,
    /// rad/s.
    angular_velocity: Vector3<f32>,
    /// m/s^2; the average of it, and the average of that.
    acceleration: (Vector3<f32>, Vector3<f32>),
    jumps: u32,
}

/// The average, if there is a state, and the share of each tick's value that it takes in.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct LowPass {
    share: f32,
    average: Option<Average>,
}

impl LowPass {
    /// In ticks of `period` us.
    pub fn new(period: u64) -> Self {
        let seconds = period as f32 * 1e-6;
        Self { share: seconds / (TIME_CONSTANT_S + seconds), average: None }
    }

    /// Whether a state has jumped since the last one.
    pub fn jumps_to(&self, estimated: &EstimatedState) -> bool {
        self.average.is_some_and(|last| last.jumps != estimated.jumps)
    }

    /// The state of a tick with its motion averaged. It begins anew where there was none, and where the state has
    /// jumped.
    pub fn tick(&mut self, estimated: Option<&EstimatedState>) -> Option<EstimatedState> {
        let Some(&EstimatedState { state, acceleration, jumps, gained }) = estimated else {
            self.average = None;
            return None;
        };
        let last = self.average.filter(|last| last.jumps == jumps);
        let averaged =
            |new: Vector3<f32>, last: Option<Vector3<f32>>| last.map_or(new, |last| last + (new - last) * self.share);
        let velocity = averaged(state.velocity, last.map(|last| last.velocity));
        let angular_velocity = averaged(state.angular_velocity, last.map(|last| last.angular_velocity));
        let counted = acceleration.map(|a| math::clamp(a, -ACCELERATION_MAX_M_PER_S2, ACCELERATION_MAX_M_PER_S2));
        let once = averaged(counted, last.map(|last| last.acceleration.0));
        let acceleration = averaged(once, last.map(|last| last.acceleration.1));
        let smoothed =
            EstimatedState { state: State { velocity, angular_velocity, ..state }, acceleration, jumps, gained };
        self.average = Some(Average { velocity, angular_velocity, acceleration: (once, acceleration), jumps });
        Some(smoothed)
    }
}

#[cfg(test)]
mod tests;
