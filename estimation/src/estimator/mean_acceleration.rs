//! The mean acceleration between two ticks by the accelerometer alone: no pose moves it.
//!
//! ```text
//! a = (sum of (R d - g h e3) over the increments since the last tick + A_now - A_last) / T
//! A = R d_under_way + t (R f) - g (t + t_under_way) e3
//! ```
//!
//! A is what lies between the last increment and a tick: the increment that is under way, and then for a time t, as
//! long as the sensor's filter is late, the force f of the last 10 ms. d and f are without the accelerometer's bias. So
//! the mean is as late as the commands are, which it is compared with, but for what t adds. Vibration at 70 to 130 Hz
//! is in it; who takes it averages it.

use nalgebra::Vector3;

/// What was felt since the last tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MeanAcceleration {
    /// Of the increments, m/s, world.
    sum: Vector3<f32>,
    /// When the last tick was, us, and A then, m/s.
    last: Option<(u64, Vector3<f32>)>,
}

impl MeanAcceleration {
    /// Nothing, and no tick yet.
    pub const NOTHING: Self = Self { sum: Vector3::new(0.0, 0.0, 0.0), last: None };

    /// Takes what an increment did to the velocity, m/s.
    pub fn add(&mut self, change: &Vector3<f32>) {
        self.sum += change;
    }

    /// a, m/s^2, at a tick at `now`, us, with what is `ahead` of the last increment, A; none at the first.
    pub fn mean(&mut self, now: u64, ahead: &Vector3<f32>) -> Option<Vector3<f32>> {
        let sum = core::mem::take(&mut self.sum);
        let (then, before) = self.last.replace((now, *ahead))?;
        let time = now.checked_sub(then).filter(|time| *time > 0)?;
        Some((sum + ahead - before) / (time as f32 * 1e-6))
    }
}

#[cfg(test)]
mod tests;
