//! The controller of a simulated vehicle: our law, or a rival to compare it with.

use crate::rivals::pilot::RivalPilot;
use crate::vehicle::actuators::ActuatorDemand;
use crate::vehicle::sensed::Sensed;
use controller_core::allocation::remaining::LostRotor;
use controller_core::controller::Diagnostics;
use controller_core::error::InputError;
use controller_core::extended::measured::Measured;
use controller_core::extended::memory::Estimates;
use controller_core::law::{Command, Law};
use controller_core::reference::Reference;
use controller_core::state::{State, Wrench};

/// A controller in a flight.
#[allow(clippy::large_enum_variant)] // ours flies by the million: nothing stands between it and the flight
#[derive(Debug, Clone)]
pub enum Controller {
    /// The law of this project.
    Ours(Law),
    /// Another one.
    Rival(Box<RivalPilot>),
}

impl Controller {
    /// One tick, with what it went through; of that, a rival knows errors and desired attitude only.
    ///
    /// # Errors
    /// Names the field of `state` or `reference` that cannot be used.
    #[inline(always)]
    pub fn step(
        &mut self,
        state: &State,
        sensed: &Sensed,
        reference: &Reference,
    ) -> Result<(Command, Diagnostics), InputError> {
        let (wrench, diagnostics) = match self {
            Self::Ours(law) => law.step(state, reference),
            Self::Rival(rival) => rival.step(state, sensed, reference),
        }?;
        Ok((Command { wrench, mrp: diagnostics.mrp }, diagnostics))
    }

    /// One tick, with the command alone.
    ///
    /// # Errors
    /// As [`Self::step`].
    #[inline]
    pub fn command(
        &mut self,
        state: &State,
        sensed: &Sensed,
        reference: &Reference,
    ) -> Result<(Command, ()), InputError> {
        match self {
            Self::Ours(law) => law.command(state, reference).map(|command| (command, ())),
            Self::Rival(_) => self.step(state, sensed, reference).map(|(command, _)| (command, ())),
        }
    }

    /// Whether the file's limits cut the last command before it was sent. Ours keeps them by itself.
    #[must_use]
    pub fn is_cut(&self) -> bool {
        match self {
            Self::Ours(_) => false,
            Self::Rival(rival) => rival.is_cut(),
        }
    }

    /// What the last command asks of the actuators: its wrench over the thrust scale, or the thrusts that the law has
    /// allocated by itself.
    #[must_use]
    #[inline]
    pub fn demand(&self, wrench: &Wrench) -> ActuatorDemand {
        match self {
            Self::Ours(law) if let Some(thrusts) = law.commands() => ActuatorDemand::Thrusts(thrusts.clone()),
            _ => ActuatorDemand::Wrench(wrench.scaled(1.0 / self.thrust_scale())),
        }
    }

    /// The rotor that our law has found to fail.
    #[must_use]
    pub fn lost(&self) -> Option<LostRotor> {
        match self {
            Self::Ours(law) => law.lost(),
            Self::Rival(_) => None,
        }
    }

    /// The estimated thrust scale.
    #[must_use]
    pub fn thrust_scale(&self) -> f32 {
        match self {
            Self::Ours(law) => law.thrust_scale(),
            Self::Rival(_) => 1.0,
        }
    }

    /// For every tick in which nothing can be learnt from the motion. A rival knows by itself what its rotors cannot
    /// deliver.
    pub fn hold_estimates(&mut self) {
        match self {
            Self::Ours(law) => law.hold_estimates(),
            Self::Rival(_) => {}
        }
    }

    /// What was measured beside the state, for our law's next step; a rival gets what is [`Sensed`].
    pub fn measured(&mut self, measured: &Measured) {
        match self {
            Self::Ours(law) => law.measured(measured),
            Self::Rival(_) => {}
        }
    }

    /// How often the extended law's fallback came.
    #[must_use]
    pub fn fallback_times(&self) -> u32 {
        match self {
            Self::Ours(law) => law.fallback_times(),
            Self::Rival(_) => 0,
        }
    }

    /// The law's estimates, if it has any.
    #[must_use]
    pub fn estimates(&self) -> Option<Estimates> {
        match self {
            Self::Ours(law) => law.estimates(),
            Self::Rival(_) => None,
        }
    }
}
