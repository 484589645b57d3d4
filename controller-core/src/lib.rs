#![doc = include_str!("../README.md")]
//!
//! The constants follow from the vehicle's numbers. [`Certified`](certificate::certified::Certified) proves the limits,
//! or names the inequality that fails. A [`Law`](law::Law) for flight is made of nothing else.
//!
//! - Law: [`law`]; the paper's in [`controller`], step by step in [`position`], [`attitude_reference`],
//!   [`path_lifting`], [`attitude`]; the other in [`extended`]. Each module opens with its equations and their numbers.
//! - Proof: [`certificate`] of a [`configuration`]. Rotors: [`allocation`].
//! - References: [`mod@reference`] with their own bounds; [`governor`] makes them of any stream of setpoints.
//! - Other people's controllers, within the same limits: [`shield`].
//! - Parameters on board: [`tuning`].
//!
//! # Conventions
//!
//! - World frame: z up, gravity is -g e3. Body frame: x forward, y left, z up, thrust along +z.
//! - Rotations and quaternions are body to world; quaternions are Hamilton's, unit, scalar first (nalgebra stores the
//!   scalar last, its constructor takes it first). A quaternion's sign carries no meaning, going in.
//! - SI units; angles in radians. Time is integer microseconds where it grows, seconds where it is a period.
//! - Gains keep the paper's symbols. A trailing `~` in comments is the paper's tilde, `'` a derivative in time, e3 =
//!   (0, 0, 1).
//! - Constructors check configuration once; their errors name the field. A tick fails only on an input it cannot use
//!   ([`error::InputError`]) and then leaves the law's memory as it was.
//! - Elementary functions come from [`math`] alone and nothing is fused.
//!
//! # Features
//!
//! - `defmt`: errors can be written to defmt logs. Such a build links only for targets with a defmt logger.
//! - `uncertified`: laws can also be made from gains that nothing proves, and started from any memory. For simulations;
//!   no flight build turns it on.

#![no_std]
#![deny(unsafe_code)]
// A tick has no way to panic; nor has configuration.
#![cfg_attr(
    not(test),
    deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable)
)]

// The tests' Hummingbird is written for other crates, too.
#[cfg(test)]
extern crate self as controller_core;
#[cfg(test)]
#[path = "../tests/support/hummingbird.rs"]
mod hummingbird;

pub mod allocation;
pub mod attitude;
pub mod attitude_reference;
pub mod certificate;
pub mod configuration;
pub mod constants;
pub mod controller;
pub mod error;
pub mod extended;
pub mod gains;
pub mod governor;
pub mod heading;
pub mod law;
pub mod math;
pub mod mrp;
pub mod path_lifting;
pub mod position;
pub mod projection;
pub mod reference;
pub mod rotation;
pub mod shield;
pub mod state;
pub mod tuning;
pub mod vehicle;

/// What most users need in scope.
pub mod prelude {
    pub use crate::allocation::{Mixer, QuadX, Rotors};
    pub use crate::certificate::Certificate;
    pub use crate::certificate::certified::{Certified, Refused};
    pub use crate::configuration::{Configuration, ExtendedLaw, LawParameters, PaperLaw};
    pub use crate::controller::{Controller, Diagnostics, Memory};
    pub use crate::error::{InputError, ParameterError};
    pub use crate::extended::actuators::ActuatorParameters;
    pub use crate::extended::defaults::Airframe;
    pub use crate::gains::{GainParameters, Gains};
    pub use crate::heading::Heading;
    pub use crate::law::Law;
    pub use crate::reference::hover::Hover;
    pub use crate::reference::{Reference, ReferenceBounds, Trajectory};
    pub use crate::state::{State, Wrench};
    pub use crate::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
    pub use nalgebra::{Quaternion, Vector2, Vector3};
}
