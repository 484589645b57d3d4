//! The true vehicle and the air around it, where they differ from the controller's model.
//!
//! | section | what it holds | needs |
//! |---|---|---|
//! | [`[truth]`](truth) | mass, inertia, centre of mass, thrust scale | |
//! | [`[drag]`](drag) | drag of frame and rotors | |
//! | [`[wind]`](wind) | how the air moves | `[drag]` |
//! | [`[disturbance]`](disturbance) | an unmodelled force and torque | |
//! | [`[battery]`](battery) | a voltage that sags and runs down | `[rotors]` |
//! | [`[failure]`](failure) | a rotor that fails | `[rotors]` |
//! | [`[ground]`](ground) | level ground | |
//! | [`[sensors]`](sensors) | noise, bias and delay of the measured state | |
//! | [`[estimator]`](estimator) | an IMU and late poses, from which the core's estimator makes the state | no `[sensors]` |
//!
//! All may be left out. The certificate, the controller and the boards know nothing of them: they are what a flight is
//! flown *in*. `[sensors] delay` and the delay of the estimator's body rates alone are part of the sampled loops.

pub mod battery;
pub mod disturbance;
pub mod drag;
pub mod estimator;
pub mod failure;
pub mod ground;
pub mod sensors;
pub mod truth;
pub mod wind;

use crate::body::BodyState;
use crate::section::{FieldError, Section};
use battery::Battery;
use controller_core::configuration::Configuration;
use disturbance::Disturbance;
use drag::Drag;
use estimator::Estimator;
use failure::Failure;
use ground::Ground;
use sensors::Sensors;
use truth::Truth;
use wind::Wind;

/// The names of the sections.
pub const SECTION_NAMES: [&str; 9] =
    ["truth", "drag", "wind", "disturbance", "battery", "failure", "ground", "sensors", "estimator"];

/// The file's reality beyond the model. By default none: the vehicle is the model, in still vacuum, its state known.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Reality {
    /// `[truth]`.
    pub truth: Option<Truth>,
    /// `[drag]`.
    pub drag: Option<Drag>,
    /// `[wind]`.
    pub wind: Option<Wind>,
    /// `[disturbance]`.
    pub disturbance: Option<Disturbance>,
    /// `[battery]`.
    pub battery: Option<Battery>,
    /// `[failure]`.
    pub failure: Option<Failure>,
    /// `[ground]`.
    pub ground: Option<Ground>,
    /// `[sensors]`.
    pub sensors: Option<Sensors>,
    /// `[estimator]`.
    pub estimator: Option<Estimator>,
}

impl Reality {
    /// Reads all sections but those of `measured`, `[sensors]` and `[estimator]`, for a flight of `configuration` from
    /// `initial`.
    ///
    /// # Errors
    /// Names the field that is refused, or the section that lacks another.
    pub fn read(
        root: &Section,
        configuration: &Configuration,
        measured: (Option<Sensors>, Option<Estimator>),
        initial: &BodyState,
    ) -> Result<Self, FieldError> {
        let rotors = configuration.rotors().map(|rotors| rotors.len());
        let needs = |section: &str, other: &str, why: &str| {
            let problem = format!("needs [{other}]: {why}; add that section or leave this one out");
            if root.has(section) && !root.has(other) { Err(FieldError::new(section, problem)) } else { Ok(()) }
        };
        needs("wind", "drag", "without it air that moves does nothing to the vehicle")?;
        needs("battery", "rotors", "nothing else draws a current")?;
        needs("failure", "rotors", "there is no rotor that could fail")?;
        Ok(Self {
            truth: truth::read(root, configuration.vehicle(), rotors)?,
            drag: drag::read(root, rotors.is_some())?,
            wind: wind::read(root)?,
            disturbance: disturbance::read(root)?,
            battery: battery::read(root)?,
            failure: failure::read(root, rotors.unwrap_or(0))?,
            ground: ground::read(root, initial)?,
            sensors: measured.0,
            estimator: measured.1,
        })
    }

    /// The sections that the file has.
    #[must_use]
    pub fn sections(&self) -> Vec<&'static str> {
        let there = [
            self.truth.is_some(),
            self.drag.is_some(),
            self.wind.is_some(),
            self.disturbance.is_some(),
            self.battery.is_some(),
            self.failure.is_some(),
            self.ground.is_some(),
            self.sensors.is_some(),
            self.estimator.is_some(),
        ];
        SECTION_NAMES.into_iter().zip(there).filter_map(|(section, there)| there.then_some(section)).collect()
    }

    /// Whether the vehicle and the air are the model's, whatever the sensors say of them.
    #[must_use]
    pub fn is_model(&self) -> bool {
        Self { sensors: None, estimator: None, ..self.clone() } == Self::default()
    }
}

#[cfg(test)]
mod tests;
