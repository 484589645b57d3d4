//! A policy aboard: a controller of somebody else's, behind a [shield](controller_core::shield).
//!
//! An image without one has no code for it: [`NoPolicy`] is empty, and every request for it is refused. With one,
//! `FlyPolicy` lets it fly in the air, in the mode in which setpoints are flown, as long as every rule of that mode is
//! kept. The goal is the newest setpoint's place; at first where the reference was. The box is inside the fence.

use super::refusal::Refusal;
use controller_core::configuration::Configuration;
use controller_core::error::InputError;
use controller_core::heading::Heading;
use controller_core::law::{Command, Law};
use controller_core::reference::Reference;
use controller_core::shield::{Policy, Reason, Settings, Shield};
use controller_core::state::State;
use core::fmt;
use estimation::estimator::VELOCITY_LATE_S;
use nalgebra::Vector3;

/// How far inside the fence the box is, and how high its floor is above the place of arming.
const FENCE_MARGIN_M: f32 = 0.4;

/// Who flies from now on, where a policy was let fly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Handover {
    /// The policy.
    ToPolicy,
    /// The law, and why.
    ToLaw(Reason),
    /// The same, until a person asks for the policy again.
    ToLawForGood(Reason),
}

impl fmt::Display for Handover {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ToPolicy => f.write_str("Policy flies"),
            Self::ToLaw(reason) => write!(f, "Law flies: {reason}"),
            Self::ToLawForGood(reason) => write!(f, "Law flies on: {reason}"),
        }
    }
}

/// What a policy aboard does in a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shielded {
    /// The law's command.
    pub command: Command,
    /// Where the law flies to, or would.
    pub reference: Reference,
    /// Who flies from now on, if that is new.
    pub handover: Option<Handover>,
}

/// What may be aboard; by default, no policy.
pub trait Aboard {
    /// Whether there is a policy at all: without one the code for it falls away.
    const EXISTS: bool;

    /// Prepares for a configuration, with ticks `period` seconds apart.
    fn fit(&mut self, _configuration: &Configuration, _period: f32) {}

    /// Lets it fly, with the box from `low` to `high`, to a goal, from a heading.
    ///
    /// # Errors
    /// Why it cannot.
    fn begin(&mut self, _corners: [Vector3<f32>; 2], _goal: &Vector3<f32>, _heading: &Heading) -> Result<(), Refusal> {
        Err(Refusal::NoPolicy)
    }

    /// A person asks for it again while it is let fly.
    fn ask_again(&mut self) {}

    /// Gives it another goal.
    fn go_to(&mut self, _goal: &Vector3<f32>) {}

    /// One tick.
    ///
    /// # Errors
    /// As the law's.
    fn fly(&mut self, _law: &mut Law, _state: &State) -> Result<Shielded, InputError> {
        Err(InputError::OutOfRange { field: "policy" })
    }
}

/// No policy.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NoPolicy;

impl Aboard for NoPolicy {
    const EXISTS: bool = false;
}

/// A policy and its shield.
#[derive(Debug, Clone, PartialEq)]
pub struct Guarded<P> {
    policy: P,
    /// None for a law that carries no policy.
    shield: Option<Shield>,
    goal: Vector3<f32>,
    /// Who flew last; none before the first tick.
    last: Option<Option<Reason>>,
}

impl<P> Guarded<P> {
    /// For `policy`, before anything is known of the vehicle.
    #[must_use]
    pub const fn new(policy: P) -> Self {
        Self { policy, shield: None, goal: Vector3::new(0.0, 0.0, 0.0), last: None }
    }
}

impl<P: Policy> Aboard for Guarded<P> {
    const EXISTS: bool = true;

    fn fit(&mut self, configuration: &Configuration, period: f32) {
        // Any box will do until there is a fence.
        let settings = Settings::new(Vector3::repeat(-1.0), Vector3::repeat(1.0));
        self.shield = Shield::new(configuration, &settings, period).ok();
    }

    fn begin(&mut self, [low, high]: [Vector3<f32>; 2], goal: &Vector3<f32>, heading: &Heading) -> Result<(), Refusal> {
        let shield = self.shield.as_mut().ok_or(Refusal::NoPolicyUnderLaw)?;
        let settings = Settings { late: VELOCITY_LATE_S, ..Settings::new(low, high) };
        shield.set_settings(&settings).map_err(|_| Refusal::OutsideFence)?;
        shield.reset(heading);
        self.policy.begin();
        (self.goal, self.last) = (*goal, None);
        Ok(())
    }

    fn ask_again(&mut self) {
        if let Some(shield) = &mut self.shield {
            shield.request_again();
        }
    }

    fn go_to(&mut self, goal: &Vector3<f32>) {
        self.goal = *goal;
    }

    fn fly(&mut self, law: &mut Law, state: &State) -> Result<Shielded, InputError> {
        let (Some(shield), Some(law)) = (&mut self.shield, law.extended()) else {
            return Err(InputError::OutOfRange { field: "policy" });
        };
        let observation = shield.observation(law, state, &self.goal);
        let offers = self.policy.act(&observation);
        let flown = shield.step(law, state, offers.as_ref())?;
        let is_new = self.last != Some(flown.reason);
        self.last = Some(flown.reason);
        let handover = match flown.reason {
            None => Handover::ToPolicy,
            Some(reason) if shield.is_latched() => Handover::ToLawForGood(reason),
            Some(reason) => Handover::ToLaw(reason),
        };
        Ok(Shielded {
            command: Command { wrench: flown.wrench, mrp: flown.diagnostics.mrp },
            reference: flown.reference,
            handover: is_new.then_some(handover),
        })
    }
}

/// A policy that a build may have found no use for.
impl<A: Aboard> Aboard for Option<A> {
    const EXISTS: bool = A::EXISTS;

    fn fit(&mut self, configuration: &Configuration, period: f32) {
        if let Some(aboard) = self {
            aboard.fit(configuration, period);
        }
    }

    fn begin(&mut self, corners: [Vector3<f32>; 2], goal: &Vector3<f32>, heading: &Heading) -> Result<(), Refusal> {
        self.as_mut().ok_or(Refusal::NoPolicy)?.begin(corners, goal, heading)
    }

    fn ask_again(&mut self) {
        if let Some(aboard) = self {
            aboard.ask_again();
        }
    }

    fn go_to(&mut self, goal: &Vector3<f32>) {
        if let Some(aboard) = self {
            aboard.go_to(goal);
        }
    }

    fn fly(&mut self, law: &mut Law, state: &State) -> Result<Shielded, InputError> {
        self.as_mut().ok_or(InputError::OutOfRange { field: "policy" })?.fly(law, state)
    }
}

/// The corners of the box in a fence about `home`, m: a square in its circle.
pub(super) fn corners(home: &Vector3<f32>, radius: f32, height: f32) -> [Vector3<f32>; 2] {
    let half = radius * core::f32::consts::FRAC_1_SQRT_2 - FENCE_MARGIN_M;
    [home + Vector3::new(-half, -half, FENCE_MARGIN_M), home + Vector3::new(half, half, height - FENCE_MARGIN_M)]
}
