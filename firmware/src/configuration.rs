//! The configuration this build flies: chosen with `SCENARIO=file.toml` at build time, certified again at boot.

use crate::hardware::MOTOR_COUNT;
use controller_core::allocation::{Motor, Rotor, Rotors, Spin};
use controller_core::configuration::Configuration;
use controller_core::error::{ParameterError, Reason};
use controller_core::reference::ReferenceBounds;
use controller_core::tuning::judged::JudgedLoops;
use controller_core::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
use nalgebra::Vector3;

include!(concat!(env!("OUT_DIR"), "/configuration.rs"));

/// Vehicle, limits, law, rotors and reference bounds as the scenario file gave them.
/// Never fails: a file that the build accepted: the same checks have seen the same bits.
#[inline(never)] // building it takes a stack of its own
pub fn embedded() -> Result<Configuration, ParameterError> {
    built()
}

/// The pilot of this build: it carries the policy that is built in, or none.
pub type Pilot = flight::Pilot<'static, Policy>;

/// The error of an image that was built for no vehicle in particular: in the words of a refusal to arm.
pub const NO_VEHICLE: ParameterError =
    ParameterError { field: "no vehicle: build with SCENARIO", reason: Reason::NotPositive };

/// The error for a scenario without rotors.
pub const NO_ROTORS: ParameterError = ParameterError { field: "rotors", reason: Reason::TooFew(MOTOR_COUNT) };
