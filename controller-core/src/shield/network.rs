//! A small network as a policy: layers of weights, tanh after each, the last one's four outputs times a scale.
//!
//! | inputs | columns | frame |
//! |---|---|---|
//! | the goal less the position, m | 0..3 | heading |
//! | velocity, m/s | 3..6 | heading |
//! | rotation, body to heading frame, row by row | 6..15 | |
//! | angular velocity, rad/s | 15..18 | body |
//! | its last outputs | 18..22 | |
//!
//! | outputs, in (-1, 1) | columns | times the scale |
//! |---|---|---|
//! | acceleration | 0..3 | m/s^2, heading frame |
//! | yaw rate | 3 | rad/s |
//!
//! The heading frame is the world's turned about z to where the shield's heading points. Sums go from left to right,
//! bias first: the same bits everywhere.

use super::{Demand, Observation, Policy};
use crate::error::{ParameterError, Reason, require, require_finite};
use crate::heading::Heading;
use crate::math;
use nalgebra::{Quaternion, Vector3};

/// The number of inputs.
pub const INPUT_COUNT: usize = 22;

/// The number of outputs.
pub const OUTPUT_COUNT: usize = 4;

/// The greatest number of outputs of a layer.
pub const WIDTH_MAX: usize = 64;

/// The greatest number of layers.
pub const LAYERS_MAX: usize = 4;

/// The greatest magnitude of a weight, a bias or a scale.
pub const WEIGHT_MAX: f32 = 1e4;

/// One layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer<'a> {
    /// The weights of the first output, one an input, then those of the second, and so on.
    pub weights: &'a [f32],
    /// One an output.
    pub biases: &'a [f32],
}

/// A network.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Network<'a> {
    layers: &'a [Layer<'a>],
    scale: [f32; OUTPUT_COUNT],
}

impl<'a> Network<'a> {
    /// Of `layers`, the inputs' first.
    ///
    /// # Errors
    /// Names what does not fit, is not finite or too great.
    pub fn new(layers: &'a [Layer<'a>], scale: [f32; OUTPUT_COUNT]) -> Result<Self, ParameterError> {
        let (count, sizes) = (layers.len(), "network.layers");
        require(count >= 1, sizes, Reason::TooFew(1))?;
        require(count <= LAYERS_MAX, sizes, Reason::TooMany(LAYERS_MAX))?;
        let mut inputs = INPUT_COUNT;
        for Layer { weights, biases } in layers {
            let outputs = biases.len();
            require(outputs >= 1, "network.layers.biases", Reason::TooFew(1))?;
            require(outputs <= WIDTH_MAX, "network.layers.biases", Reason::TooMany(WIDTH_MAX))?;
            let wanted = inputs * outputs;
            require(weights.len() >= wanted, "network.layers.weights", Reason::TooFew(wanted))?;
            require(weights.len() <= wanted, "network.layers.weights", Reason::TooMany(wanted))?;
            weights.iter().try_for_each(|weight| checked(*weight, "network.layers.weights"))?;
            biases.iter().try_for_each(|bias| checked(*bias, "network.layers.biases"))?;
            inputs = outputs;
        }
        require(inputs >= OUTPUT_COUNT, "network.layers.biases", Reason::TooFew(OUTPUT_COUNT))?;
        require(inputs <= OUTPUT_COUNT, "network.layers.biases", Reason::TooMany(OUTPUT_COUNT))?;
        scale.iter().try_for_each(|scale| checked(*scale, "network.scale"))?;
        Ok(Self { layers, scale })
    }

    /// What its outputs are multiplied by.
    pub fn scale(&self) -> [f32; OUTPUT_COUNT] {
        self.scale
    }

    /// The outputs for these inputs.
    pub fn outputs(&self, inputs: &[f32; INPUT_COUNT]) -> [f32; OUTPUT_COUNT] {
        let mut values = [0.0; WIDTH_MAX];
        for (value, input) in values.iter_mut().zip(inputs) {
            *value = *input;
        }
        let mut count = INPUT_COUNT;
        for Layer { weights, biases } in self.layers {
            let mut next = [0.0; WIDTH_MAX];
            for ((next, bias), weights) in next.iter_mut().zip(*biases).zip(weights.chunks_exact(count)) {
                let sum = weights.iter().zip(&values).fold(*bias, |sum, (weight, value)| sum + weight * value);
                *next = math::tanh_of_scaled(sum * math::TANH_SCALE as f32);
            }
            (values, count) = (next, biases.len());
        }
        let [first, second, third, fourth, ..] = values;
        [first, second, third, fourth]
    }

    /// The demand that outputs make.
    pub fn demand(&self, outputs: &[f32; OUTPUT_COUNT], heading: &Heading) -> Demand {
        let ([x, y, z, turn], [of_x, of_y, of_z, of_turn]) = (*outputs, self.scale);
        let (forwards, heading) = (Vector3::new(x * of_x, y * of_y, z * of_z), heading.direction());
        let acceleration = Vector3::new(
            heading.x * forwards.x - heading.y * forwards.y,
            heading.y * forwards.x + heading.x * forwards.y,
            forwards.z,
        );
        Demand::Acceleration { acceleration, yaw_rate: turn * of_turn }
    }
}

fn checked(value: f32, field: &'static str) -> Result<(), ParameterError> {
    require_finite(value, field)?;
    require(value.abs() <= WEIGHT_MAX, field, Reason::Above(WEIGHT_MAX))
}

/// The inputs for an observation, after these outputs.
pub fn inputs(observation: &Observation, last: &[f32; OUTPUT_COUNT]) -> [f32; INPUT_COUNT] {
    let Observation { state, goal, heading } = observation;
    let (cos, sin) = (heading.direction().x, heading.direction().y);
    let turned = |v: &Vector3<f32>| [cos * v.x + sin * v.y, cos * v.y - sin * v.x, v.z];
    let [first, second, third] = rows(&state.attitude);
    let across = |this: [f32; 3], other: [f32; 3], sin: f32| {
        let ([a, b, c], [d, e, f]) = (this, other);
        [cos * a + sin * d, cos * b + sin * e, cos * c + sin * f]
    };
    let w = &state.angular_velocity;
    let parts = [
        turned(&(goal - state.position)),
        turned(&state.velocity),
        across(first, second, sin),
        across(second, first, -sin),
        third,
        [w.x, w.y, w.z],
    ];
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

/// A network that flies, with its last outputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NetworkPolicy<'a> {
    network: Network<'a>,
    last: [f32; OUTPUT_COUNT],
}

impl<'a> NetworkPolicy<'a> {
    /// Before its first output.
    pub const fn new(network: Network<'a>) -> Self {
        Self { network, last: [0.0; OUTPUT_COUNT] }
    }
}

impl Policy for NetworkPolicy<'_> {
    fn act(&mut self, observation: &Observation) -> Option<Demand> {
        let outputs = self.network.outputs(&inputs(observation, &self.last));
        // A NaN would stay in its inputs for ever.
        let finite = outputs.iter().all(|output| output.is_finite());
        self.last = if finite { outputs } else { [0.0; OUTPUT_COUNT] };
        Some(self.network.demand(&outputs, &observation.heading))
    }
}

#[cfg(test)]
mod tests;
