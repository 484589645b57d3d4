//! The layers of a network: dense ones, and recurrent ones that remember.
//!
//! | layer | outputs |
//! |---|---|
//! | [`Layer::Dense`] | a(W x + b), a the activation |
//! | [`Layer::Gru`] | h := z h + (1 - z) n, the memory itself |
//!
//! with, for a recurrent layer with the inputs x and the memory h, a gated recurrent unit (Cho et al., Learning phrase
//! representations using RNN encoder-decoder for statistical machine translation, 2014),
//!
//! ```text
//! r = s(W_r x + b_r + U_r h + c_r)       s(x) = 1/2 + tanh(x / 2) / 2
//! z = s(W_z x + b_z + U_z h + c_z)
//! n = tanh(W_n x + b_n + r (U_n h + c_n))
//! ```
//!
//! element by element where two vectors are multiplied. The rows of r come first, then those of z and n.

use super::sizes::{WIDTH_MAX, checked};
use crate::error::{ParameterError, Reason, require};
use crate::math;

/// r, z and n.
const GATES_PER_UNIT: usize = 3;

/// What a dense layer makes of its sums.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Activation {
    /// tanh x.
    #[default]
    Tanh,
    /// x where it is positive, otherwise zero. A NaN stays one.
    Relu,
    /// x.
    Identity,
}

impl Activation {
    fn of(self, x: f32) -> f32 {
        match self {
            Self::Tanh => tanh(x),
            Self::Relu => math::max(x, 0.0),
            Self::Identity => x,
        }
    }
}

/// Weights and biases: W x + b.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine<'a> {
    /// The weights of the first output, one an input, then those of the second, and so on.
    pub weights: &'a [f32],
    /// One an output.
    pub biases: &'a [f32],
}

impl Affine<'_> {
    /// Checks that there are so many weights and biases, and each of them.
    fn check(&self, inputs: usize, outputs: usize, [weights, biases]: [&'static str; 2]) -> Result<(), ParameterError> {
        for (given, wanted, field) in [(self.biases, outputs, biases), (self.weights, inputs * outputs, weights)] {
            require(given.len() >= wanted, field, Reason::TooFew(wanted))?;
            require(given.len() <= wanted, field, Reason::TooMany(wanted))?;
            given.iter().try_for_each(|value| checked(*value, field))?;
        }
        Ok(())
    }

    /// The sums of every output, the first first, of which `inputs` of the values are the inputs.
    fn sums<'s>(&'s self, values: &'s [f32; WIDTH_MAX], inputs: usize) -> impl Iterator<Item = f32> + 's {
        self.biases.iter().zip(self.weights.chunks_exact(inputs.max(1))).map(|(bias, row)| sum(row, values, *bias))
    }

    /// The sums of the outputs `unit`, `unit` + `units`, `unit` + 2 `units`.
    fn gates(&self, values: &[f32], inputs: usize, unit: usize, units: usize) -> [f32; GATES_PER_UNIT] {
        let rows = self.biases.iter().zip(self.weights.chunks_exact(inputs.max(1)));
        let mut rows = rows.skip(unit).step_by(units.max(1));
        core::array::from_fn(|_| rows.next().map_or(0.0, |(bias, row)| sum(row, values, *bias)))
    }
}

/// One layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Layer<'a> {
    /// Without a memory.
    Dense {
        /// W and b.
        affine: Affine<'a>,
        /// a.
        activation: Activation,
    },
    /// A gated recurrent unit.
    Gru {
        /// W and b, of the inputs: three rows a value that is remembered.
        input: Affine<'a>,
        /// U and c, of the memory: likewise.
        hidden: Affine<'a>,
        /// h at first.
        initial: &'a [f32],
    },
}

impl Layer<'_> {
    /// The number of its outputs.
    pub fn outputs(&self) -> usize {
        match self {
            Self::Dense { affine, .. } => affine.biases.len(),
            Self::Gru { initial, .. } => initial.len(),
        }
    }

    /// What it remembers at first: nothing, for a dense layer.
    pub fn initial(&self) -> &[f32] {
        match self {
            Self::Dense { .. } => &[],
            Self::Gru { initial, .. } => initial,
        }
    }

    /// Checks it, for so many inputs.
    ///
    /// # Errors
    /// Names what does not fit, is not finite or too great.
    pub(super) fn check(&self, inputs: usize) -> Result<(), ParameterError> {
        let outputs = self.outputs();
        let field = match self {
            Self::Dense { .. } => "network.layers.biases",
            Self::Gru { .. } => "network.layers.initial",
        };
        require(outputs >= 1, field, Reason::TooFew(1))?;
        require(outputs <= WIDTH_MAX, field, Reason::TooMany(WIDTH_MAX))?;
        match self {
            Self::Dense { affine, .. } => {
                affine.check(inputs, outputs, ["network.layers.weights", "network.layers.biases"])
            }
            Self::Gru { input, hidden, initial } => {
                input.check(
                    inputs,
                    GATES_PER_UNIT * outputs,
                    ["network.layers.input_weights", "network.layers.input_biases"],
                )?;
                hidden.check(
                    outputs,
                    GATES_PER_UNIT * outputs,
                    ["network.layers.hidden_weights", "network.layers.hidden_biases"],
                )?;
                initial.iter().try_for_each(|value| checked(*value, field))
            }
        }
    }

    /// Its outputs, zeros after the last, for values of which the first `count` are its inputs. `memory` begins with
    /// what it remembers.
    pub(super) fn advance(&self, values: &[f32; WIDTH_MAX], count: usize, memory: &mut [f32]) -> [f32; WIDTH_MAX] {
        let mut next = [0.0; WIDTH_MAX];
        match self {
            Self::Dense { affine, activation } => {
                for (next, sum) in next.iter_mut().zip(affine.sums(values, count)) {
                    *next = activation.of(sum);
                }
            }
            Self::Gru { input, hidden, initial } => {
                let units = initial.len();
                for ((unit, next), old) in next.iter_mut().enumerate().take(units).zip(&*memory) {
                    let [reset, keep, new] = input.gates(values, count, unit, units);
                    let [reset_hidden, keep_hidden, new_hidden] = hidden.gates(memory, units, unit, units);
                    let (reset, keep) = (sigmoid(reset + reset_hidden), sigmoid(keep + keep_hidden));
                    *next = keep * old + (1.0 - keep) * tanh(new + reset * new_hidden);
                }
                memory.iter_mut().zip(&next).take(units).for_each(|(value, next)| *value = *next);
            }
        }
        next
    }
}

/// The bias and the products, from left to right.
fn sum(weights: &[f32], values: &[f32], bias: f32) -> f32 {
    weights.iter().zip(values).fold(bias, |sum, (weight, value)| sum + weight * value)
}

fn tanh(x: f32) -> f32 {
    math::tanh_of_scaled(x * math::TANH_SCALE as f32)
}

/// 1 / (1 + e^-x).
fn sigmoid(x: f32) -> f32 {
    0.5 + 0.5 * tanh(0.5 * x)
}
