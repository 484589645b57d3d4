//! What the inputs and the outputs of a network mean. Two layouts:
//!
//! | inputs | of accelerations | of rotors | frame |
//! |---|---|---|---|
//! | where the goal is, m | 0..3, goal less position | 0..3, position less goal, each cut to `farthest` | heading |
//! | velocity, m/s | 3..6 | 12..15, each cut to `fastest` | heading |
//! | rotation, body to heading frame, row by row | 6..15 | 3..12 | |
//! | angular velocity, rad/s | 15..18 | 15..18 | body |
//! | last | 18..22, its outputs | 18..22, the rotors' commands that flew | |
//!
//! | outputs | columns | |
//! |---|---|---|
//! | of accelerations: acceleration | 0..3 | times the scale, m/s^2, heading frame |
//! | yaw rate | 3 | times the scale, rad/s |
//! | of rotors: speeds | 0..4 | -1, the least, to 1, the greatest; front right, back right, back left, front left |
//!
//! The heading frame is the world's turned about z to where the shield's heading points. The layout of rotors is that
//! of the policy RAPTOR (Eschmann et al., A foundation policy for quadrotor control, 2025, arXiv 2509.11481).

use super::sizes::{INPUT_COUNT, OUTPUT_COUNT, checked};
use crate::error::{ParameterError, require_positive};
use crate::heading::Heading;
use crate::math;
use crate::shield::{Demand, Observation};
use nalgebra::{Quaternion, Vector3};

/// A layout of inputs and outputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Interface {
    /// Accelerations and a yaw rate are demanded.
    Acceleration {
        /// What the outputs are multiplied by: m/s^2 three times, rad/s.
        scale: [f32; OUTPUT_COUNT],
    },
    /// Speeds of the rotors of an X are demanded.
    Rotors {
        /// The farthest that the goal is seen along each axis, m.
        farthest: f32,
        /// The fastest that the vehicle is seen along each axis, m/s.
        fastest: f32,
    },
}

impl Interface {
    /// Checks its numbers.
    ///
    /// # Errors
    /// Names the one that is not finite, too great, or not positive where it has to be.
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        match self {
            Self::Acceleration { scale } => scale.iter().try_for_each(|scale| checked(*scale, "network.scale")),
            Self::Rotors { farthest, fastest } => {
                for (value, field) in [(*farthest, "network.farthest"), (*fastest, "network.fastest")] {
                    require_positive(value, field)?;
                    checked(value, field)?;
                }
                Ok(())
            }
        }
    }

    /// The inputs for an observation, after these outputs.
    pub fn inputs(&self, observation: &Observation, last: &[f32; OUTPUT_COUNT]) -> [f32; INPUT_COUNT] {
        let Observation { state, goal, heading, rotors } = observation;
        let (cos, sin) = (heading.direction().x, heading.direction().y);
        let turned = |v: &Vector3<f32>| [cos * v.x + sin * v.y, cos * v.y - sin * v.x, v.z];
        let [first, second, third] = rows(&state.attitude);
        let across = |this: [f32; 3], other: [f32; 3], sin: f32| {
            let ([a, b, c], [d, e, f]) = (this, other);
            [cos * a + sin * d, cos * b + sin * e, cos * c + sin * f]
        };
        let rotation = [across(first, second, sin), across(second, first, -sin), third];
        let w = &state.angular_velocity;
        let rates = [w.x, w.y, w.z];
        let [first, second, third] = rotation;
        match self {
            Self::Acceleration { .. } => {
                let (goal, velocity) = (turned(&(goal - state.position)), turned(&state.velocity));
                joined(&[goal, velocity, first, second, third, rates], last)
            }
            Self::Rotors { farthest, fastest } => {
                let away = turned(&(state.position - goal)).map(|place| math::saturate(place, *farthest));
                let velocity = turned(&state.velocity).map(|speed| math::saturate(speed, *fastest));
                joined(&[away, first, second, third, velocity, rates], rotors)
            }
        }
    }

    /// The demand that outputs make.
    pub fn demand(&self, outputs: &[f32; OUTPUT_COUNT], heading: &Heading) -> Demand {
        let Self::Acceleration { scale } = self else { return Demand::Rotors { speeds: *outputs } };
        let ([x, y, z, turn], [of_x, of_y, of_z, of_turn]) = (*outputs, *scale);
        let (forwards, heading) = (Vector3::new(x * of_x, y * of_y, z * of_z), heading.direction());
        let acceleration = Vector3::new(
            heading.x * forwards.x - heading.y * forwards.y,
            heading.y * forwards.x + heading.x * forwards.y,
            forwards.z,
        );
        Demand::Acceleration { acceleration, yaw_rate: turn * of_turn }
    }
}

/// Parts one after another.
fn joined(parts: &[[f32; 3]; 6], last: &[f32; OUTPUT_COUNT]) -> [f32; INPUT_COUNT] {
    let mut inputs = [0.0; INPUT_COUNT];
    for (input, value) in inputs.iter_mut().zip(parts.iter().flatten().chain(last)) {
        *input = *value;
    }
    inputs
}

/// The rows of R.
fn rows(q: &Quaternion<f32>) -> [[f32; 3]; 3] {
    let (w, x, y, z) = (q.w, q.i, q.j, q.k);
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}
