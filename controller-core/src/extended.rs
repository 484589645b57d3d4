//! The extended law: the paper's structure for vehicles with weak yaw, lagging rotors, a sagging battery and wind.
//!
//! What it keeps: a saturated position feedback behind filters makes a bounded thrust vector; a desired attitude
//! follows from it in closed form; a saturated attitude law tracks it through the path lifting; every limit is proven
//! before take-off. What it changes, and where:
//!
//! | module | what | derived in `docs/extended-law.md` |
//! |---|---|---|
//! | [`position`] | an envelope for u; feedback gets what force and vertical leave of it; thrust at once | 1 |
//! | [`approach`] | as fast towards the target as the vehicle can brake | 1 |
//! | `estimates` | unmodelled force, constant torque, thrust scale | 2, 7, 9 |
//! | [`direction_limiter`] | the thrust direction turns as fast as the torque at hand turns the vehicle | 3 |
//! | [`budget`] | a tick's torque about the tilt's axes, spent part by part | 4 |
//! | [`heading`] | yaw takes what tilt and thrust leave, and brakes a spin before thrust | 5 |
//! | [`attitude`] | the tilt alone, whatever the heading does; errors projected over the rotors' lag | 6 |
//! | [`thrust_range`] | a least and a greatest thrust that follow the torque, and the yaw torque that is left | 8 |
//! | [`actuators`] | the past commands through the rotors' lag and delay: the wrench that the estimates compare with | 10 |
//! | [`fallback`] | the same law, slowed down, if a flight makes no progress | 13 |
//! | [`rotor_loss`] | a rotor that fails: found, and flown without | 16 |
//! | [`rotor_speeds`] | the speeds of an X's rotors as a wrench within limits and ranges, in place of the law's | |
//! | [`saturation`] | the saturation that feedback passes | 1 |
//! | [`measured`] | an accelerometer's acceleration and the rotors' speeds, where there are any | 2, 10 |
//! | [`demand`] | an acceleration, or an attitude and a thrust, in place of the feedback | |
//! | [`memory`] | the law's memory from one tick to the next | |
//! | [`controller`] | one step, state and reference in, wrench out | |
//! | [`crate::constants`], [`parameters`] | all of its constants, declared once, validated | |
//! | [`quantities`], [`defaults`] | every constant from a vehicle's numbers | 14 |
//!
//! Each estimate has a level; a level of zero turns it off.

pub mod actuators;
pub mod approach;
pub mod attitude;
pub mod budget;
pub mod controller;
pub mod defaults;
pub mod demand;
pub mod direction_limiter;
pub(crate) mod estimates;
pub mod fallback;
pub mod heading;
pub mod measured;
pub mod memory;
pub mod parameters;
pub mod position;
pub mod quantities;
pub mod rotor_loss;
pub mod rotor_speeds;
pub mod saturation;
pub mod thrust_range;

#[cfg(test)]
pub(crate) mod tests;
