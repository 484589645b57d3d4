//! Robust global position and heading tracking on SE(3) by saturated hybrid feedback.
//!
//! Every decision a quadrotor makes in flight, and no input or output at all: the control law of the paper *Robust
//! Global Position and Heading Tracking on SE(3) via Saturated Hybrid Feedback* (Martins, Cardeira, Oliveira; below:
//! the paper), the references it tracks, the certificate that proves its thrust and torque limits before take-off, and
//! the allocation to rotors. `no_std`, no allocation, no panics; the law runs in single precision.
//!
//! # The way of the data
//!
//! Once per control tick, from left to right:
//!
//! ```text
//! IMU ─> imu ─┐
//! poses ──────┴─> estimator ─────── State ─┐
//! setpoints ─> governor ─┐                 ├─> position ─> attitude_reference ─> path_lifting ─> attitude ─> Wrench
//! hover, harmonic, … ────┴─> Reference ────┘                                                                   │
//!                                                                  rotor commands <─ allocation <──────────────┘
//! ```
//!
//! and once, before flight:
//!
//! ```text
//! Vehicle, Limits, Gains, ReferenceBounds (, Rotors, thrust floor) ─> Configuration ─> Certificate ─> Certified ─> Controller
//! ```
//!
//! [`flight`] decides which of this reaches the motors: [`flight::Pilot`] takes measurements and requests, and gives
//! thrusts or a stop, by a table of [rules](flight::rules). [`controller`] composes the four steps of the law, with an
//! example. A [`Controller`](controller::Controller) for flight is made from a
//! [`Certified`](certificate::certified::Certified) configuration and from nothing else.
//!
//! # Conventions
//!
//! - World frame: z up, gravity is -g e3. Body frame: x forward, y left, z up, thrust along +z.
//! - Rotations and quaternions are body to world; quaternions are Hamilton's, unit, scalar first (nalgebra stores the
//!   scalar last, its constructor takes it first). A quaternion's sign carries no meaning, going in.
//! - SI units; angles in radians. A heading is a point on the circle with two derivatives ([`heading::Heading`]).
//! - Time is integer microseconds where it grows without limit, seconds as `f32` where it is a period.
//! - Gains keep the paper's symbols. A trailing `~` in comments is the paper's tilde, `'` a derivative in time, e3 =
//!   (0, 0, 1).
//! - Configuration is checked once, in constructors whose errors name the field ([`error::ParameterError`]). A tick
//!   fails only on an input it cannot use ([`error::InputError`]) and leaves the controller's memory as it was.
//! - Elementary functions come from [`math`] alone and nothing is fused: the same bits on every machine.
//!
//! # Features
//!
//! - `defmt`: errors can be written to defmt logs. Such a build checks on a desktop but links only for targets with a
//!   defmt logger.
//! - `uncertified`: [`controller::Controller`] can also be made from gains that nothing proves, and started from any
//!   memory. For simulations; no flight build turns it on.
//!
#![doc = include_str!("../../docs/map.md")]
#![no_std]
#![deny(unsafe_code)]
#![warn(missing_docs)]
// A tick has no way to panic; nor has configuration.
#![cfg_attr(
    not(test),
    deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable)
)]

// The tests' Hummingbird is written for other crates, too.
#[cfg(test)]
extern crate self as controller_core;
#[cfg(test)]
#[path = "../../tests/support/hummingbird.rs"]
mod hummingbird;

pub mod allocation;
pub mod attitude;
pub mod attitude_reference;
pub mod certificate;
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
pub mod state;
pub mod tuning;
pub mod vehicle;

/// What most users need in scope.
pub mod prelude {
    pub use crate::certificate::Certificate;
    pub use crate::certificate::certified::{Certified, Refused};
    pub use crate::certificate::configuration::{Configuration, ExtendedLaw, LawParameters, PaperLaw};
    pub use crate::controller::{Controller, Diagnostics, Memory};
    pub use crate::error::{InputError, ParameterError};
    pub use crate::gains::{GainParameters, Gains};
    pub use crate::heading::Heading;
    pub use crate::law::Law;
    pub use crate::reference::hover::Hover;
    pub use crate::reference::{Reference, ReferenceBounds, Trajectory};
    pub use crate::state::{State, Wrench};
    pub use crate::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
    pub use nalgebra::{Quaternion, Vector2, Vector3};
}
