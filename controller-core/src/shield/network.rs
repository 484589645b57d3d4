//! A small network as a policy: layers of weights, of which some may remember.
//!
//! ```text
//! Observation -> inputs (22) -> Layer, ... -> outputs (4) -> Demand
//!                               '- Memory, of recurrent layers
//! ```
//!
//! - [`layer`]: dense and recurrent layers, and what they compute;
//! - [`interface`]: what the 22 inputs and the four outputs mean: two layouts.
//!
//! Sums go from left to right, bias first: the same bits everywhere.

pub mod interface;
pub mod layer;
mod sizes;

pub use interface::Interface;
pub use layer::{Activation, Affine, Layer};
pub use sizes::{INPUT_COUNT, LAYERS_MAX, MEMORY_MAX, OUTPUT_COUNT, WEIGHT_MAX, WIDTH_MAX};

use super::{Demand, Observation, Policy};
use crate::error::{ParameterError, Reason, require};
use crate::heading::Heading;

/// A network.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Network<'a> {
    layers: &'a [Layer<'a>],
    interface: Interface,
}

/// What the recurrent layers of a network remember, one layer's values after another's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Memory {
    /// The values; zeros after the last one that is used.
    pub values: [f32; MEMORY_MAX],
}

impl<'a> Network<'a> {
    /// Of `layers`, the inputs' first.
    ///
    /// # Errors
    /// Names what does not fit, is not finite or too great.
    pub fn new(layers: &'a [Layer<'a>], interface: Interface) -> Result<Self, ParameterError> {
        let count = layers.len();
        require(count >= 1, "network.layers", Reason::TooFew(1))?;
        require(count <= LAYERS_MAX, "network.layers", Reason::TooMany(LAYERS_MAX))?;
        let (mut inputs, mut remembered) = (INPUT_COUNT, 0);
        for layer in layers {
            layer.check(inputs)?;
            inputs = layer.outputs();
            remembered += layer.initial().len();
        }
        require(inputs >= OUTPUT_COUNT, "network.layers.biases", Reason::TooFew(OUTPUT_COUNT))?;
        require(inputs <= OUTPUT_COUNT, "network.layers.biases", Reason::TooMany(OUTPUT_COUNT))?;
        require(remembered <= MEMORY_MAX, "network.layers.initial", Reason::TooMany(MEMORY_MAX))?;
        interface.check()?;
        Ok(Self { layers, interface })
    }

    /// What inputs and outputs mean.
    pub fn interface(&self) -> &Interface {
        &self.interface
    }

    /// The number of values that it remembers.
    pub fn remembered(&self) -> usize {
        self.layers.iter().map(|layer| layer.initial().len()).sum()
    }

    /// What it remembers at first.
    pub fn fresh(&self) -> Memory {
        let mut values = [0.0; MEMORY_MAX];
        let initial = self.layers.iter().flat_map(|layer| layer.initial());
        values.iter_mut().zip(initial).for_each(|(value, initial)| *value = *initial);
        Memory { values }
    }

    /// The outputs for these inputs; recurrent layers remember them.
    pub fn outputs(&self, inputs: &[f32; INPUT_COUNT], memory: &mut Memory) -> [f32; OUTPUT_COUNT] {
        let mut values = [0.0; WIDTH_MAX];
        for (value, input) in values.iter_mut().zip(inputs) {
            *value = *input;
        }
        let (mut count, mut remembered) = (INPUT_COUNT, 0);
        for layer in self.layers {
            let own = memory.values.get_mut(remembered..).unwrap_or_default();
            values = layer.advance(&values, count, own);
            count = layer.outputs();
            remembered += layer.initial().len();
        }
        let [first, second, third, fourth, ..] = values;
        [first, second, third, fourth]
    }

    /// The demand that outputs make.
    pub fn demand(&self, outputs: &[f32; OUTPUT_COUNT], heading: &Heading) -> Demand {
        self.interface.demand(outputs, heading)
    }
}

/// A network that flies, with its last outputs and what it remembers.
///
/// It looks at every tick, whoever flies: what it remembers is of the flight as it was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NetworkPolicy<'a> {
    network: Network<'a>,
    last: [f32; OUTPUT_COUNT],
    memory: Memory,
}

impl<'a> NetworkPolicy<'a> {
    /// Before its first output.
    pub fn new(network: Network<'a>) -> Self {
        Self { network, last: [0.0; OUTPUT_COUNT], memory: network.fresh() }
    }

    /// What it remembers.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }
}

impl Policy for NetworkPolicy<'_> {
    fn begin(&mut self) {
        *self = Self::new(self.network);
    }

    fn act(&mut self, observation: &Observation) -> Option<Demand> {
        let inputs = self.network.interface.inputs(observation, &self.last);
        let outputs = self.network.outputs(&inputs, &mut self.memory);
        // A NaN would stay in its inputs, and in what it remembers, for ever.
        let finite = outputs.iter().chain(&self.memory.values).all(|value| value.is_finite());
        if finite {
            self.last = outputs;
        } else {
            self.begin();
        }
        Some(self.network.demand(&outputs, &observation.heading))
    }
}

#[cfg(test)]
mod tests;
