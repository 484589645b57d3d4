//! Speeds of the rotors of an X as a wrench, within the rotors' ranges and the limits, and back.
//!
//! A speed a in [-1, 1] is the rotor's between its least and its greatest. Thrust is a speed's square, so
//!
//! ```text
//! sqrt(f) = sqrt(f_min) + (1 + a) / 2 (sqrt(f_max) - sqrt(f_min)),    w = s B f,    s the thrust scale
//! ```
//!
//! and the rotors, commanded w / s, turn at just these speeds. Two cuts keep w within the limits:
//!
//! 1. all thrusts go towards f_min by one share, as far as T_max wants it;
//! 2. all torques are multiplied by one share, as far as a limit of theirs wants it. With rotors that need equal
//!    thrusts for thrust alone, that moves every rotor towards the mean.
//!
//! Both stay in the box [f_min, f_max]^4, which is convex. A share of [`RANGE_UNUSED`] at its ends is left for the
//! rounding on the way through w, so that no rotor's command is ever clipped.

use crate::allocation::{Rotor, Rotors, Spin};
use crate::math;
use crate::state::Wrench;
use crate::vehicle::Limits;
use nalgebra::{Vector3, Vector4};

/// The share of a rotor's range that is left unused at either end.
pub const RANGE_UNUSED: f32 = 1e-5;

/// How far a rotor's share of thrust alone may be from a quarter.
const EVEN_SHARE_TOLERANCE: f64 = 1e-3;

/// How far rotors' ranges may differ, as a share.
const LIKE_RANGE_TOLERANCE: f32 = 1e-3;

/// Where the rotors of a demand are, as signs of x and y, and which way they turn.
const PLACES: [(f32, f32, Spin); 4] = [
    (1.0, -1.0, Spin::CounterClockwise),
    (-1.0, -1.0, Spin::Clockwise),
    (-1.0, 1.0, Spin::CounterClockwise),
    (1.0, 1.0, Spin::Clockwise),
];

/// The rotors of an X: front right, back right, back left, front left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotorSpeeds {
    /// Of B, and rows of its inverse.
    columns: [Vector4<f32>; 4],
    rows: [Vector4<f32>; 4],
    /// f_min and f_max, N, less what is unused.
    min: f32,
    max: f32,
    /// The roots of the thrusts in the middle of the speeds, and from there to an end, sqrt(N).
    middle: f32,
    half: f32,
    thrust_max: f32,
    torque_max: Vector3<f32>,
}

impl RotorSpeeds {
    /// For rotors that are an X: four of like ranges, one in each quarter, of which front right and back left turn
    /// counter-clockwise, and the others clockwise, and that need equal thrusts for thrust alone. None for others.
    pub fn new(rotors: &Rotors, limits: &Limits) -> Option<Self> {
        let first = rotors.first().filter(|_| rotors.len() == PLACES.len())?;
        let like = |a: f32, b: f32| (a - b).abs() <= LIKE_RANGE_TOLERANCE * first.thrust_max;
        let even = |row: &Vector4<f64>| (row.x - 0.25).abs() <= EVEN_SHARE_TOLERANCE;
        if !rotors
            .iter()
            .all(|rotor| like(rotor.thrust_min, first.thrust_min) && like(rotor.thrust_max, first.thrust_max))
            || !rotors.pseudo_inverse().iter().all(even)
        {
            return None;
        }
        let is_at = |rotor: &Rotor, (x, y, spin): &(f32, f32, Spin)| {
            rotor.position.x * x > 0.0 && rotor.position.y * y > 0.0 && rotor.spin == *spin
        };
        let (mut columns, mut rows) = ([Vector4::zeros(); 4], [Vector4::zeros(); 4]);
        for ((column, row), place) in columns.iter_mut().zip(&mut rows).zip(&PLACES) {
            let index = rotors.iter().position(|rotor| is_at(rotor, place))?;
            *column = rotors.effectiveness().get(index)?.map(|x| x as f32);
            *row = rotors.pseudo_inverse().get(index)?.map(|x| x as f32);
        }
        // The narrowest of ranges that are alike.
        let min = rotors.iter().map(|rotor| rotor.thrust_min).fold(0.0, math::max);
        let max = rotors.iter().map(|rotor| rotor.thrust_max).fold(f32::MAX, math::min);
        let [least, greatest] = [min, max].map(math::sqrt);
        let unused = RANGE_UNUSED * (max - min);
        Some(Self {
            columns,
            rows,
            min: min + unused,
            max: max - unused,
            middle: 0.5 * (least + greatest),
            half: 0.5 * (greatest - least),
            thrust_max: limits.thrust_max,
            torque_max: limits.torque_max,
        })
    }

    /// The wrench of rotors at these speeds, N and N m, for a thrust scale; a NaN counts as -1.
    pub fn wrench(&self, speeds: &[f32; 4], scale: f32) -> Wrench {
        let mut sum = Vector4::zeros();
        for (column, speed) in self.columns.iter().zip(speeds) {
            let speed = if speed.is_nan() { -1.0 } else { math::saturate(*speed, 1.0) };
            let root = self.middle + self.half * speed;
            sum += column * math::clamp(root * root, self.min, self.max);
        }
        let mut wrench = sum * scale;
        let least = 4.0 * self.min * scale;
        if wrench.x > self.thrust_max {
            let share = math::max(self.thrust_max - least, 0.0) / (wrench.x - least);
            wrench *= share;
            wrench.x += (1.0 - share) * least;
        }
        let torque = Vector3::new(wrench.y, wrench.z, wrench.w);
        let share = torque
            .iter()
            .zip(self.torque_max.iter())
            .fold(1.0, |share, (torque, max)| if torque.abs() * share > *max { max / torque.abs() } else { share });
        Wrench { thrust: wrench.x, torque: torque * share }
    }

    /// The speeds of rotors whose command is `commanded`, (T, tau) in N and N m, divided by the thrust scale.
    pub fn speeds(&self, commanded: &Vector4<f32>) -> [f32; 4] {
        self.rows.map(|row| {
            let thrust = math::max(row.dot(commanded), 0.0);
            math::saturate((math::sqrt(thrust) - self.middle) / self.half, 1.0)
        })
    }
}

#[cfg(test)]
mod tests;
