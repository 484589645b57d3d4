//! The law that flies: the paper's or the extended one, by its configuration.

use crate::allocation::Thrusts;
use crate::allocation::remaining::LostRotor;
use crate::configuration::{Configuration, LawParameters};
use crate::controller::{self, Diagnostics};
use crate::error::{InputError, ParameterError};
use crate::extended;
use crate::extended::measured::Measured;
use crate::extended::memory::Estimates;
use crate::extended::rotor_loss::spinning::RotorLossLaw;
use crate::reference::Reference;
use crate::state::{State, Wrench};
use nalgebra::Vector3;

/// What a flight needs of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    /// T and tau.
    pub wrench: Wrench,
    /// theta~.
    pub mrp: Vector3<f32>,
}

/// A law, as after a reset.
#[allow(clippy::large_enum_variant)] // without an allocator there is nowhere else to put either
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// The paper's.
    Paper(controller::Controller),
    /// The extended one.
    Extended(extended::controller::Controller),
}

impl Law {
    /// The law of a configuration that nothing is proven about: for simulation, never for flight.
    ///
    /// # Errors
    /// As [`Self::new`].
    #[cfg(any(test, feature = "uncertified"))]
    pub fn uncertified(configuration: &Configuration, period: f32) -> Result<Self, ParameterError> {
        Self::build(configuration, period)
    }

    pub(crate) fn build(configuration: &Configuration, period: f32) -> Result<Self, ParameterError> {
        let vehicle = configuration.vehicle();
        Ok(match configuration.law() {
            LawParameters::Paper(law) => {
                Self::Paper(controller::Controller::build(*vehicle, law.gains, law.thrust_floor, period)?)
            }
            LawParameters::Extended(law) => {
                let (limits, rotors) = (configuration.limits(), configuration.rotors());
                Self::Extended(extended::controller::Controller::build(vehicle, limits, law, rotors, period)?)
            }
        })
    }

    /// Everything forgotten: how a flight begins.
    pub fn reset(&mut self) {
        match self {
            Self::Paper(law) => law.reset(),
            Self::Extended(law) => law.reset(),
        }
    }

    /// Filters and lift as after a reset, what is known of the vehicle kept: how a flight goes on without a pose.
    pub fn restart(&mut self) {
        match self {
            Self::Paper(law) => law.reset(),
            Self::Extended(law) => law.restart(),
        }
    }

    /// For every tick in which nothing can be learnt from the motion: see
    /// [`extended::controller::Controller::hold_estimates`].
    pub fn hold_estimates(&mut self) {
        if let Self::Extended(law) = self {
            law.hold_estimates();
        }
    }

    /// For every tick whose velocity is not the vehicle's: see
    /// [`extended::controller::Controller::hold_without_velocity`].
    pub fn hold_without_velocity(&mut self) {
        if let Self::Extended(law) = self {
            law.hold_without_velocity();
        }
    }

    /// What was measured beside the state since the last step, for the next one alone: see
    /// [`extended::controller::Controller::measured`].
    pub fn measured(&mut self, measured: &Measured) {
        if let Self::Extended(law) = self {
            law.measured(measured);
        }
    }

    /// The delivered thrust over the commanded thrust, by the law's estimate: divide a wrench by it before it is
    /// allocated to rotors.
    pub fn thrust_scale(&self) -> f32 {
        match self {
            Self::Paper(_) => 1.0,
            Self::Extended(law) => law.thrust_scale(),
        }
    }

    /// What has been estimated, if the law estimates anything.
    pub fn estimates(&self) -> Option<Estimates> {
        match self {
            Self::Paper(_) => None,
            Self::Extended(law) => Some(law.estimates()),
        }
    }

    /// The law without a rotor, once one is lost; the paper's law looks for none.
    fn spinning(&self) -> Option<&RotorLossLaw> {
        match self {
            Self::Paper(_) => None,
            Self::Extended(law) => law.spinning(),
        }
    }

    /// The rotor that the law has found to fail, and flies without.
    pub fn lost(&self) -> Option<LostRotor> {
        self.spinning().map(|law| *law.lost())
    }

    /// The wrench of rotors that turn at these speeds, rad/s, where the law can use it: see
    /// [`Measured::wrench`](crate::extended::measured::Measured::wrench).
    pub fn wrench_at(&self, speeds: &[Option<f32>]) -> Option<Wrench> {
        match self {
            Self::Paper(_) => None,
            Self::Extended(law) => law.rotors()?.wrench_at(speeds),
        }
    }

    /// What the law has commanded of each rotor, N, in place of a wrench to allocate: once a rotor is lost.
    pub fn commands(&self) -> Option<&Thrusts> {
        self.spinning().map(RotorLossLaw::commands)
    }

    /// What these commands deliver, N and N m, by the law's estimates.
    pub fn delivered(&self) -> Option<&Wrench> {
        self.spinning().map(RotorLossLaw::delivered)
    }

    /// How often the [fallback](crate::extended::fallback) came since the reset; the paper's law has none.
    pub fn fallback_times(&self) -> u32 {
        match self {
            Self::Paper(_) => 0,
            Self::Extended(law) => law.memory().fallback.times(),
        }
    }

    /// The extended law, if it is that one.
    pub fn extended(&mut self) -> Option<&mut extended::controller::Controller> {
        match self {
            Self::Paper(_) => None,
            Self::Extended(law) => Some(law),
        }
    }

    /// Changes the time between steps, s.
    ///
    /// # Errors
    /// As [`Self::new`]; the period then stays what it was.
    pub fn set_period(&mut self, period: f32) -> Result<(), ParameterError> {
        match self {
            Self::Paper(law) => law.set_period(period),
            Self::Extended(law) => law.set_period(period),
        }
    }

    /// [`Self::step`] as it is flown: compiled once, in this crate, however small its callers are compiled, and without
    /// what they do not read. The extended law's takes 3,078 instructions so.
    ///
    /// # Errors
    /// As [`Self::step`].
    #[inline(never)]
    pub fn command(&mut self, state: &State, reference: &Reference) -> Result<Command, InputError> {
        let (wrench, Diagnostics { mrp, .. }) = self.step(state, reference)?;
        Ok(Command { wrench, mrp })
    }

    /// One tick of the law, with what it went through.
    ///
    /// # Errors
    /// Names the field of `state` or `reference` that cannot be used; the memory is then unchanged.
    #[inline(always)] // for the command, above
    pub fn step(&mut self, state: &State, reference: &Reference) -> Result<(Wrench, Diagnostics), InputError> {
        match self {
            Self::Paper(law) => law.step(state, reference),
            Self::Extended(law) => law.step(state, reference),
        }
    }
}
