//! The actuators: delay, allocation and rotors between the law's wrench and the body.
//!
//! Without `[rotors]` and `[sampling]` the wrench acts at once, clipped to the limits. With them,
//!
//! ```text
//! wrench -> (delay) -> allocation -> rotor speeds, first-order lag, limits -> thrusts f_i = k_eta speed_i^2 -> B f
//! ```
//!
//! - *delay*: the wrench of a tick takes effect a whole number of plant steps after it; until then the one before it
//!   acts;
//! - *allocation*: the core's [`Mixer`], as on the boards;
//! - *lag*: of the rotors' speeds ([`rotors`]).
//!
//! A tick counts as clipped if its wrench could not be delivered in full. Rotors start at the speeds that hover.

pub mod rotors;

use crate::vehicle::plant::body::Body;
use crate::vehicle::plant::{Diverged, Plant};
use crate::vehicle::sensed::Acted;
use controller_core::allocation::{Mixer, Thrusts};
use controller_core::error::InputError;
use controller_core::state::Wrench;
use nalgebra::Vector3;
use rotors::SpinningRotors;
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

/// The demand on the actuators.
#[derive(Debug, Clone, PartialEq)]
pub enum ActuatorDemand {
    /// A wrench, to be allocated.
    Wrench(Wrench),
    /// Each rotor's thrust, N: the law has allocated by itself.
    Thrusts(Thrusts),
}

impl ActuatorDemand {
    /// Each rotor's thrust, N, and whether the wrench could not be delivered in full.
    ///
    /// # Errors
    /// [`ActuationError::Wrench`].
    pub fn allocated(&self, mixer: &Mixer) -> Result<(Thrusts, bool), ActuationError> {
        match self {
            Self::Wrench(wrench) => {
                let allocation = mixer.allocate(wrench).map_err(ActuationError::Wrench)?;
                let is_exact = allocation.is_exact();
                Ok((allocation.thrusts, !is_exact))
            }
            Self::Thrusts(thrusts) => Ok((thrusts.clone(), false)),
        }
    }

    /// As a wrench, for a vehicle without rotors.
    pub fn wrench(&self) -> Wrench {
        match self {
            Self::Wrench(wrench) => *wrench,
            Self::Thrusts(thrusts) => Wrench { thrust: thrusts.iter().sum(), torque: Vector3::zeros() },
        }
    }
}

/// What ticks ask for, on its way to the actuators.
#[derive(Debug, Clone)]
pub(crate) struct Delayed {
    steps: u64,
    /// With the plant step at which it acts.
    waiting: VecDeque<(u64, ActuatorDemand)>,
    /// What acts now.
    pub acting: ActuatorDemand,
}

impl Delayed {
    /// Acts so many plant steps after its tick; before the first, the hover thrust, N, does.
    pub fn new(steps: u64, hover: f32) -> Self {
        let acting = ActuatorDemand::Wrench(Wrench { thrust: hover, torque: Vector3::zeros() });
        Self { steps, waiting: VecDeque::new(), acting }
    }

    /// A tick asks for this at plant step `now`.
    pub fn ask(&mut self, demand: &ActuatorDemand, now: u64) {
        self.waiting.push_back((now + self.steps, demand.clone()));
    }

    /// Whether another demand acts from plant step `now` on.
    pub fn arrives(&mut self, now: u64) -> bool {
        let mut arrives = false;
        while let Some((_, due)) = self.waiting.pop_front_if(|(due, _)| *due <= now) {
            self.acting = due;
            arrives = true;
        }
        arrives
    }
}

/// Delay and rotors between the law and the body.
#[derive(Debug, Clone)]
pub struct Actuators {
    pub(crate) rotors: Option<(Box<Mixer>, SpinningRotors)>,
    /// Plant steps since the start.
    now: u64,
    demand: Delayed,
    /// What acted since it was last taken.
    pub(crate) acted: Acted,
}

impl Actuators {
    /// Actuators that hold the hover thrust, N, until the first wrench arrives, `delay_steps` plant steps after its
    /// tick. Without rotors wrenches act on the body directly.
    pub fn new(rotors: Option<(Box<Mixer>, SpinningRotors)>, delay_steps: u64, hover: f32) -> Self {
        Self { rotors, now: 0, demand: Delayed::new(delay_steps, hover), acted: Acted::default() }
    }

    /// The rotors' thrusts at this moment, N, after lag; none without rotors.
    pub fn thrusts(&self) -> Vec<f64> {
        self.rotors.as_ref().map_or_else(Vec::new, |(_, rotors)| rotors.thrusts())
    }

    /// Whether a wrench acts at once.
    pub fn are_ideal(&self) -> bool {
        self.rotors.is_none() && self.demand.steps == 0
    }

    fn act(&mut self, body: &Body) {
        let (thrust, torque, _) = body.clipped(&self.demand.acting.wrench());
        self.acted.add(thrust, &torque);
    }

    /// Takes what a tick asks for and moves the body for `steps` plant steps. Returns whether anything was cut, and the
    /// commanded rotor thrusts, N, as they stand at the end (none without rotors).
    pub fn hold(
        &mut self,
        plant: &mut Plant,
        demand: &ActuatorDemand,
        steps: u32,
    ) -> Result<(bool, Thrusts), ActuationError> {
        if self.are_ideal() {
            self.demand.acting = demand.clone();
            self.act(plant.body());
            return Ok((plant.hold(&demand.wrench(), steps)?, Thrusts::new()));
        }
        self.demand.ask(demand, self.now);
        let mut clipped = false;
        let mut thrusts = Thrusts::new();
        for _ in 0..steps {
            let arrives = self.demand.arrives(self.now);
            match &mut self.rotors {
                None => {
                    self.act(plant.body());
                    clipped |= plant.hold(&self.demand.acting.wrench(), 1)?;
                }
                Some((mixer, rotors)) => {
                    if arrives {
                        let (allocated, cut) = self.demand.acting.allocated(mixer)?;
                        clipped |= cut;
                        thrusts = allocated;
                        rotors.command(&thrusts);
                    }
                    let (thrust, torque) = rotors.advance();
                    self.acted.add(thrust, &torque);
                    plant.act(thrust, &torque);
                }
            }
            self.now += 1;
        }
        plant.check()?;
        Ok((clipped, thrusts))
    }
}

#[cfg(test)]
mod tests;
