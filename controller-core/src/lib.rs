//! Robust global position and heading tracking on SE(3) by saturated hybrid feedback.
#![no_std]
#![deny(unsafe_code)]
// A tick has no way to panic; nor has configuration.
#![cfg_attr(
    not(test),
    deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable)
)]

pub mod allocation;
pub mod attitude;
pub mod attitude_reference;
pub mod certificate;
pub mod controller;
pub mod error;
pub mod gains;
pub mod governor;
pub mod heading;
pub mod math;
pub mod mrp;
pub mod path_lifting;
pub mod position;
pub mod projection;
pub mod reference;
pub mod state;
pub mod vehicle;

/// What most users need in scope.
pub mod prelude {
    pub use crate::certificate::Certificate;
    pub use crate::certificate::configuration::{Certified, Configuration, Refused};
    pub use crate::controller::{Controller, Diagnostics, Memory};
    pub use crate::error::{InputError, ParameterError};
    pub use crate::gains::{GainParameters, Gains};
    pub use crate::heading::Heading;
    pub use crate::reference::hover::Hover;
    pub use crate::reference::{Reference, ReferenceBounds, Trajectory};
    pub use crate::state::{State, Wrench};
    pub use crate::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
    pub use nalgebra::{Quaternion, Vector2, Vector3};
}
