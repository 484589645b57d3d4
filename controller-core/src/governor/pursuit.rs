//! The command generator: a double integrator that makes for the target as fast as its cylinder of accelerations
//! allows.
//!
//! Wanted velocity: w = feed + |e|-directed approach, cut to the speed limits. Commanded acceleration: w - u, scaled
//! (not cut by component) into the cylinder C. "How long" is measured by C itself, ||y|| = max(|y_12|/A_12, |y_3|/A_3),
//! so one number gives both the size of a step and its use of C, and everything along one direction is the scalar
//! problem of [`super::braking`]: from rest the path is the straight segment to the target, run without overshoot and
//! ended on the exact point.
//!
//! The bounds do not depend on any of this: the windows need no more than alpha in C. From a state in motion, arrival
//! is by feedback: far from the target w turns slowly and ||w - u|| falls at nearly one a tick until u = w, which then
//! persists; when the target is passed at speed the same law brakes and returns. That every such pursuit ends is shown
//! by test (at worst 1.4 times as late as stopping first would) and by the campaign in
//! `tests/setpoints/governor_campaign.rs`, not proven.

use super::braking::{BRAKING_SHARE, approach_speed};
use super::windows::Windows;
use crate::math;
use nalgebra::Vector3;

/// A cylinder about the vertical: |y_12| <= `horizontal`, |y_3| <= `vertical`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cylinder {
    per_horizontal: f32,
    per_vertical: f32,
}

impl Cylinder {
    const NONE: Self = Self { per_horizontal: 0.0, per_vertical: 0.0 };

    fn new(horizontal: f32, vertical: f32) -> Self {
        Self { per_horizontal: 1.0 / horizontal, per_vertical: 1.0 / vertical }
    }

    /// ||y||: at most one inside.
    fn measure(&self, y: &Vector3<f32>) -> f32 {
        (math::sqrt(y.x * y.x + y.y * y.y) * self.per_horizontal).max(y.z.abs() * self.per_vertical)
    }

    /// `y` brought inside along its own direction; as it is if inside. Rounds towards zero.
    fn limited(&self, y: &Vector3<i64>) -> Vector3<i64> {
        shortened(y, self.measure(&single(y)), 1.0)
    }
}

/// `y` as single precision has it.
fn single(y: &Vector3<i64>) -> Vector3<f32> {
    y.map(math::i64_to_f32)
}

/// `y` with its measure brought down to `to`, rounded towards zero; as it is if its measure is one or less.
fn shortened(y: &Vector3<i64>, measure: f32, to: f32) -> Vector3<i64> {
    if measure <= 1.0 { *y } else { (single(y) * (to / measure)).map(math::f32_to_i64) }
}

/// The law, in length units and ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pursuit {
    accelerations: Cylinder,
    speeds: Cylinder,
}

impl Pursuit {
    /// Not designed yet.
    pub const NONE: Self = Self { accelerations: Cylinder::NONE, speeds: Cylinder::NONE };

    /// Speeds in m/s.
    pub fn new(windows: &Windows, horizontal_speed: f32, vertical_speed: f32, period: f32) -> Self {
        let unit = windows.per_metre * period;
        Self {
            accelerations: Cylinder::new(windows.horizontal, windows.vertical),
            speeds: Cylinder::new(horizontal_speed * unit, vertical_speed * unit),
        }
    }

    /// The acceleration that takes velocity `u` to `wanted`, as far as one tick may.
    pub fn towards_velocity(&self, wanted: &Vector3<i64>, u: &Vector3<i64>) -> Vector3<i32> {
        self.accelerations.limited(&(self.speeds.limited(wanted) - u)).map(|component| component as i32)
    }

    /// How far velocity `u` goes until it has been braked to rest.
    pub fn braking_way(&self, u: &Vector3<f32>) -> Vector3<f32> {
        u * (0.5 * self.accelerations.measure(u))
    }

    /// The velocity wanted to reach a target `error` away that moves with `feed` and accelerates with `acceleration`
    /// (units per tick squared): the greatest along `error` from which braking ends on it. Braking is planned with what
    /// following the target leaves.
    pub fn approach(&self, error: &Vector3<i64>, feed: &Vector3<i64>, acceleration: &Vector3<f32>) -> Vector3<i64> {
        let share = (BRAKING_SHARE - self.accelerations.measure(acceleration)).max(CLOSING_SHARE_MIN);
        let distance = self.accelerations.measure(&single(error)) / share;
        feed + shortened(error, distance, approach_speed(distance))
    }
}

/// The share of the acceleration with which targets are closed in on that take all of it.
const CLOSING_SHARE_MIN: f32 = 0.1;

#[cfg(test)]
mod tests;
