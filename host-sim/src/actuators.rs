//! What stands between the law's wrench and the body.
//!
//! Without `[rotors]` and `[sampling]` nothing does: the wrench acts at once, clipped to the limits. With them,
//!
//! ```text
//! wrench -> (delay) -> allocation -> rotor speeds, first-order lag, limits -> thrusts f_i = k_eta speed_i^2 -> B f
//! ```
//!
//! - *delay*: the wrench of a tick takes effect a whole number of plant steps after it; until then the one before it acts;
//! - *allocation*: the core's own [`Mixer`], with its order of giving up what the rotors do not have;
//! - *lag*: of the rotors' speeds ([`rotors`]).
//!
//! A rotor counts as saturated at a tick whose wrench the allocation could not deliver in full.
//! Rotors start at the speeds that hover.

pub mod rotors;

use crate::plant::{Clipping, Diverged, Plant};
use controller_core::allocation::{Mixer, Thrusts};
use controller_core::error::InputError;
use controller_core::state::Wrench;
use nalgebra::Vector3;
use rotors::SpinningRotors;
pub use scenario::actuation::RotorSetup;
use std::collections::VecDeque;
use std::fmt;

/// Why a wrench could not be applied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ActuationError {
    /// The allocation refused it.
    Wrench(InputError),
    /// The body's state is not finite afterwards.
    Diverged(Diverged),
}

impl fmt::Display for ActuationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Wrench(error) => write!(f, "the allocation refused the wrench: {error}"),
            Self::Diverged(error) => write!(f, "{error}"),
        }
    }
}

impl From<Diverged> for ActuationError {
    fn from(error: Diverged) -> Self {
        Self::Diverged(error)
    }
}

/// Rotors behind their allocation.
#[derive(Debug, Clone)]
struct Allocated {
    mixer: Mixer,
    rotors: SpinningRotors,
}

impl Allocated {
    /// Sends a wrench to the rotors; returns their commanded thrusts and whether they could deliver it.
    fn command(&mut self, wrench: &Wrench) -> Result<(Thrusts, Clipping), InputError> {
        let allocation = self.mixer.allocate(wrench)?;
        self.rotors.command(&allocation.thrusts);
        let clipping = Clipping {
            thrust: allocation.thrust_limited,
            torque: allocation.roll_pitch_limited || allocation.yaw_limited,
        };
        Ok((allocation.thrusts, clipping))
    }
}

/// Delay and rotors between the law and the body.
#[derive(Debug, Clone)]
pub struct Actuators {
    rotors: Option<Allocated>,
    delay_steps: u64,
    /// Plant steps since the start.
    now: u64,
    /// Wrenches on their way, with the step at which they act.
    waiting: VecDeque<(u64, Wrench)>,
    /// Wrench that acts now.
    acting: Wrench,
}

impl Actuators {
    /// Actuators that hold the hover thrust, N, until the first wrench arrives. `step` is the plant's, s.
    #[must_use]
    pub fn new(setup: Option<&RotorSetup>, delay_steps: u64, hover: f32, step: f64) -> Self {
        Self {
            rotors: setup.map(|setup| Allocated {
                mixer: Mixer::new(&setup.rotors),
                rotors: SpinningRotors::hovering(setup, hover, step),
            }),
            delay_steps,
            now: 0,
            waiting: VecDeque::new(),
            acting: Wrench { thrust: hover, torque: Vector3::zeros() },
        }
    }

    /// Takes the wrench of a tick and moves the body for `steps` plant steps. Returns what was cut, and the commanded
    /// rotor thrusts, N, as they stand at the end (none without rotors).
    ///
    /// # Errors
    /// [`ActuationError`].
    pub fn hold(
        &mut self,
        plant: &mut Plant,
        wrench: &Wrench,
        steps: u32,
    ) -> Result<(Clipping, Thrusts), ActuationError> {
        if self.rotors.is_none() && self.delay_steps == 0 {
            return Ok((plant.hold(wrench, steps)?, Thrusts::new()));
        }
        self.waiting.push_back((self.now + self.delay_steps, *wrench));
        let mut clipping = Clipping::default();
        let mut thrusts = Thrusts::new();
        for _ in 0..steps {
            let mut arrived = false;
            while let Some((_, due)) = self.waiting.pop_front_if(|(due, _)| *due <= self.now) {
                self.acting = due;
                arrived = true;
            }
            match &mut self.rotors {
                None => clipping = clipping.or(plant.hold(&self.acting, 1)?),
                Some(rotors) => {
                    if arrived {
                        let (commanded, cut) = rotors.command(&self.acting).map_err(ActuationError::Wrench)?;
                        clipping = clipping.or(cut);
                        thrusts = commanded;
                    }
                    let (thrust, torque) = rotors.rotors.advance();
                    plant.act(thrust, &torque);
                }
            }
            self.now += 1;
        }
        plant.check()?;
        Ok((clipping, thrusts))
    }
}

#[cfg(test)]
mod tests;
