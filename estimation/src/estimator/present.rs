//! The present force and velocity from the last increments, without the rotors' vibration.
//!
//! Rotors out of balance vibrate the IMU at 70 to 130 Hz, by 1.2 to 2.3 mm/s for each m/s^2. That is a true motion, but
//! a law that samples it at 100 Hz sees an alias. So the law gets the mean of three velocities: v_0 at the end of the
//! last increment, v_1 and v_2 one and two increments before. That mean is 5 ms late, and the last increment A = 2 to 8
//! ms old: the low-passed force f_slow carries the velocity on to the present.
//!
//! ```text
//! v_smooth = (v_0 + 2 v_1 + v_2) / 4 + (H + A) (R f_slow - g e3) = v_0 - R (D - H f_slow) + A (R f_slow - g e3)
//! D = (3 d_0 + d_1) / 4      H = (3 h_0 + h_1) / 4
//! f_slow += h / 0.05 s (d / h - f_slow)                       at each increment, kept with the history
//! f = (d_0 + d_1) / (h_0 + h_1)                              the force for the reported acceleration
//! ```
//!
//! | vibration at | mean of three velocities, cos^2(pi f h) | f, mean of 10 ms | f_slow |
//! |---|---|---|---|
//! | 10 Hz | 0.98 | 0.98 | 0.31 |
//! | 70 Hz | 0.21 | 0.37 | 0.05 |
//! | 100 Hz | 0 | 0 | 0.03 |
//! | 130 Hz | 0.21 | 0.20 | 0.03 |
//!
//! f must not carry the velocity on: in 6 ms it adds as much as the vibration itself. Where the thrust changes within a
//! twentieth of a second, v_smooth is up to 12 ms late along it; across, R is that of now. The vertical loops bear five
//! times as much. All d are turned into the frame at the end of the last increment, to first order in the turn.

use super::history::Increment;
use nalgebra::Vector3;

/// How late the velocity of a state is at most, along a thrust that has just changed, s.
pub const VELOCITY_LATE_S: f32 = 0.012;

/// Of the last two increments, in the body frame at their end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PresentMotion {
    /// f, m/s^2.
    pub force: Vector3<f32>,
    /// D - H f_slow, m/s: the velocity's part that is vibration.
    pub vibration: Vector3<f32>,
}

impl PresentMotion {
    /// By the last increment, the one before it, and f_slow with both. The first one alone is cut in half.
    pub fn from_increments(last: &Increment, before: Option<&Increment>, slow: &Vector3<f32>) -> Self {
        let (newer, h_0) = (last.push_at_end(), last.seconds());
        let Some(before) = before else {
            return Self { force: newer / h_0, vibration: (newer - slow * h_0) * 0.5 };
        };
        let (older, h_1) = (last.turned_back(&before.push_at_end()), before.seconds());
        Self {
            force: (newer + older) / (h_0 + h_1),
            vibration: (newer - slow * h_0) * 0.75 + (older - slow * h_1) * 0.25,
        }
    }
}

#[cfg(test)]
mod tests;
