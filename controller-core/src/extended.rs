//! The extended law: the paper's structure for vehicles with weak yaw, lagging rotors, a sagging battery and wind.
//!
//! What it keeps: a saturated position feedback behind two filters makes a bounded thrust vector; a desired attitude follows
//! from it in closed form; a saturated attitude law tracks it through the path lifting; every limit is proven before take-off.
//! What it changes, and where:
//!
//! | module | what | derived in `docs/extended-law.md` |
//! |---|---|---|
//! | [`position`] | gains, filters and levels axis by axis, a radial level across, a capped approach speed | 1 |
//! | [`force`] | an estimate of the force the model does not know, as a bounded, twice differentiable part of u | 2 |
//! | [`heading`] | the desired frame may lag in heading, so that yaw is asked for no more than it has | 3 |
//! | [`saturation`] | the saturation that all feedback passes | 1 |
//! | [`attitude`] | separate levels for tilt and yaw | 4 |
//! | [`torque_bias`] | an estimate of a constant torque | 5 |
//! | [`thrust_floor`] | a least thrust that follows the torque, so that no rotor is asked for less than it can give | 6 |
//! | [`thrust_scale`] | an estimate of what the rotors deliver of what is commanded | 7 |
//! | [`actuators`] | what the rotors were commanded, through their lag and delay: what the estimates compare with | 8 |
//! | [`memory`] | what it remembers from one tick to the next | |
//! | [`controller`] | one step, state and reference in, wrench out | |
//! | [`parameters`] | all of its constants, validated | |
//!
//! Each estimate has a level; a level of zero turns it off.

pub mod actuators;
pub mod attitude;
pub mod controller;
pub mod force;
pub mod heading;
pub mod memory;
pub mod parameters;
pub mod position;
pub mod saturation;
pub mod thrust_floor;
pub mod thrust_scale;
pub mod torque_bias;

#[cfg(test)]
pub(crate) mod example;
#[cfg(test)]
mod tests;
