//! The shield: the extended law flies what a policy demands, within its own limits, and takes over while it must.
//!
//! ```text
//! policy -> Demand -> Shield { Monitor } -+- step_on_demand -> Wrench     while the policy may fly
//!                                         +- step_on_rotors -> Wrench     the same, where it demands rotor speeds
//!                                         '- step_within    -> Wrench     at rest at a refuge, otherwise
//! ```
//!
//! A policy is anything that decides on an acceleration, or on an attitude and a thrust: a learned one, a planner, a
//! law under study. Its demand takes the place of the law's feedback ubar ([`crate::extended::demand`]). So the limits
//! on thrust, torque and rotors hold whatever it demands, and a hand-over changes ubar alone: nothing jumps, and the
//! law's theorem holds from there on. A policy may demand speeds of the rotors as well, past the law's attitude
//! control: these are cut to ranges and limits ([`crate::extended::rotor_speeds`]), the law keeps beside them a memory
//! from which it can take over, and the wrench jumps when it does.
//!
//! - [`monitor`]: when the law has to take over: a table of rules, each with its number and its reason;
//! - [`network`]: a small network as a policy;
//! - [`reason`]: those reasons in words;
//! - [`room`]: a box to stay in;
//! - [`settings`]: the rooms, and the numbers of the rules;
//! - `heading`: a heading that turns within the certified bounds.
//!
//! A policy flies while some room holds the whole prospect: the way to a stop is then inside that room. Where two rooms
//! overlap, a vehicle goes from one to the other. The refuge is a place near z_1 at the hand-over, at rest, in the room
//! that held the prospect last: the law brakes there with all that the envelope has. The policy gets the vehicle back
//! once it has been near the refuge for a while, and again after longer each time, up to a number of hand-overs.
//! `docs/shield.md` says what is proven of it.

mod heading;
pub mod monitor;
pub mod network;
pub mod reason;
pub mod room;
pub mod settings;

pub use crate::extended::demand::Demand;
pub use reason::Reason;
pub use room::Room;
pub use settings::Settings;

use crate::configuration::{Configuration, LawParameters};
use crate::controller::Diagnostics;
use crate::error::{InputError, ParameterError, Reason as Refused};
use crate::extended::controller::{Controller, FlownBy, StoppingForecast};
use crate::extended::position::FeedbackLimits;
use crate::extended::rotor_speeds::RotorSpeeds;
use crate::heading::Heading;
use crate::reference::Reference;
use crate::state::{State, Wrench};
use heading::HeadingGenerator;
use monitor::Monitor;
use nalgebra::Vector3;

/// What a policy sees besides what its maker gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// The state.
    pub state: State,
    /// Where it is to go, m, world.
    pub goal: Vector3<f32>,
    /// Where the heading generator points.
    pub heading: Heading,
    /// The speeds that the rotors were told last, whoever flew, as [`Demand::Rotors`] has them; zeros where the vehicle
    /// is no X.
    pub rotors: [f32; 4],
}

/// Anything that decides what to do.
pub trait Policy {
    /// A flight begins: nothing is left of the one before.
    fn begin(&mut self) {}

    /// What to do now; none to say nothing.
    fn act(&mut self, observation: &Observation) -> Option<Demand>;
}

/// One tick of a shield.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShieldStep {
    /// T and tau.
    pub wrench: Wrench,
    /// The law's, with errors from [`Self::reference`].
    pub diagnostics: Diagnostics,
    /// Why the law flies; none while the policy does.
    pub reason: Option<Reason>,
    /// At rest at the refuge: where the law flies to, or would if it took over now.
    pub reference: Reference,
}

/// Who flies, and since when.
#[derive(Debug, Clone, Copy, PartialEq)]
enum InControl {
    Policy,
    Law {
        reason: Reason,
        refuge: Vector3<f32>,
        /// For how many ticks the vehicle has been near its refuge.
        near: u32,
    },
}

/// The greatest levels of feedback while the law flies in place of a policy, under `gravity`, m/s^2: 0.4 g down and 0.8
/// g across. With all of the envelope the law may brake a climb with a third of the weight as thrust, and while it is
/// tilted such a thrust turns the vehicle too slowly to follow: a Hummingbird in wind then went two metres astray. Up
/// there is no such limit.
fn stopping(gravity: f32) -> FeedbackLimits {
    FeedbackLimits { up: f32::MAX, down: 0.4 * gravity, across: 0.8 * gravity }
}

/// How near its refuge a vehicle is to be before a policy gets it back: |z_1|, m, and |z_2|, m/s. A quarter of it is
/// too little where states are noisy and air is rough.
const REFUGE_RADIUS: f32 = 0.2;

/// A shield, as before a flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shield {
    settings: Settings,
    /// The room that held the prospect last, without its margin; none before the first tick.
    room: Option<Room>,
    monitor: Monitor,
    heading: HeadingGenerator,
    /// For demands of speeds; none for a vehicle that is no X.
    rotors: Option<RotorSpeeds>,
    /// The greatest levels of feedback while the law flies.
    limits: FeedbackLimits,
    period: f32,
    pilot: InControl,
    /// The last demand that could be used, and how many ticks ago it came.
    demand: Option<Demand>,
    silent: u32,
    /// How many ticks in a row an estimate could not be trusted.
    doubtful: u32,
    hand_overs: u32,
}

impl Shield {
    /// A shield for the law of `configuration`, with ticks `period` seconds apart.
    ///
    /// # Errors
    /// For the paper's law; for a setting that makes no sense, by its name.
    pub fn new(configuration: &Configuration, settings: &Settings, period: f32) -> Result<Self, ParameterError> {
        let LawParameters::Extended(law) = configuration.law() else {
            return Err(ParameterError { field: "control.law", reason: Refused::CarriesNoPolicy });
        };
        settings.check()?;
        Ok(Self {
            settings: *settings,
            room: None,
            monitor: Monitor::new(settings, &law.parameters, configuration.vehicle()),
            heading: HeadingGenerator::new(configuration.bounds(), period),
            rotors: configuration.rotors().and_then(|rotors| RotorSpeeds::new(rotors, configuration.limits())),
            limits: stopping(configuration.vehicle().gravity),
            period,
            pilot: InControl::Policy,
            demand: None,
            silent: 0,
            doubtful: 0,
            hand_overs: 0,
        })
    }

    /// Other settings from now on.
    ///
    /// # Errors
    /// For one that makes no sense, by its name; nothing has changed then.
    pub fn set_settings(&mut self, settings: &Settings) -> Result<(), ParameterError> {
        settings.check()?;
        (self.settings, self.room) = (*settings, None);
        self.monitor.set_settings(settings);
        Ok(())
    }

    /// As before a flight, pointing along `heading`.
    pub fn reset(&mut self, heading: &Heading) {
        self.heading.start(heading);
        (self.pilot, self.demand, self.room) = (InControl::Policy, None, None);
        (self.silent, self.doubtful) = (0, 0);
        self.hand_overs = 0;
    }

    /// A person asks for the policy again: hand-overs are counted anew. The vehicle still has to come near its refuge.
    pub fn request_again(&mut self) {
        self.hand_overs = 0;
    }

    /// How often the law took over since the reset, or since a person asked again.
    pub fn hand_overs(&self) -> u32 {
        self.hand_overs
    }

    /// Whether the law keeps the vehicle until a person asks again.
    pub fn is_latched(&self) -> bool {
        self.hand_overs >= self.settings.hand_overs
    }

    /// Where the heading generator points.
    pub fn heading(&self) -> &Heading {
        self.heading.heading()
    }

    /// Whether the vehicle flies demands of rotor speeds.
    pub fn flies_rotors(&self) -> bool {
        self.rotors.is_some()
    }

    /// The speeds that the rotors were told last, as [`Observation::rotors`].
    pub fn rotors(&self, law: &Controller) -> [f32; 4] {
        self.rotors.as_ref().map_or([0.0; 4], |rotors| rotors.speeds(&law.commanded()))
    }

    /// What a policy is to see in this tick.
    pub fn observation(&self, law: &Controller, state: &State, goal: &Vector3<f32>) -> Observation {
        Observation { state: *state, goal: *goal, heading: *self.heading(), rotors: self.rotors(law) }
    }

    /// One tick of `law`, on what the policy `offers`; none if it says nothing.
    ///
    /// # Errors
    /// As the law's step; law and shield remember nothing of the tick then. Whatever the policy offers is no error.
    pub fn step(
        &mut self,
        law: &mut Controller,
        state: &State,
        offers: Option<&Demand>,
    ) -> Result<ShieldStep, InputError> {
        let mut next = *self;
        let flown = next.advance(law, state, offers)?;
        *self = next;
        Ok(flown)
    }

    fn advance(
        &mut self,
        law: &mut Controller,
        state: &State,
        offers: Option<&Demand>,
    ) -> Result<ShieldStep, InputError> {
        let usable = self.listen(offers);
        // A demand of speeds is judged by what it would do from now on.
        let by = match (&self.pilot, &self.demand, &self.rotors) {
            (InControl::Policy, Some(Demand::Rotors { speeds }), Some(rotors)) => {
                FlownBy::Rotors(rotors.wrench(speeds, law.thrust_scale()))
            }
            _ => FlownBy::Law,
        };
        let prospect = law.stopping_forecast(state, &self.limits, by, self.settings.late);
        let inside = self.settings.room_of(&prospect.places, self.room.as_ref());
        self.room = inside.or(self.room).or_else(|| self.settings.nearest_room(&prospect.z_1));
        let against = self.judge(state, &prospect, inside.is_some(), usable);
        self.decide(&prospect, against);
        match (&self.pilot, &self.demand) {
            (InControl::Policy, Some(demand)) => {
                self.heading.follow(demand);
                let reference = Reference::resting(self.refuge(&prospect), *self.heading.heading());
                let (wrench, diagnostics) = match (demand, &self.rotors) {
                    (Demand::Rotors { speeds }, Some(rotors)) => {
                        law.step_on_rotors(state, &reference, rotors, speeds)?
                    }
                    _ => law.step_on_demand(state, &reference, demand)?,
                };
                Ok(ShieldStep { wrench, diagnostics, reason: None, reference })
            }
            (pilot, _) => {
                // A policy that flies has made a demand, so the other case is never met.
                let (reason, refuge) = match pilot {
                    InControl::Law { reason, refuge, .. } => (*reason, *refuge),
                    InControl::Policy => (Reason::Silent, self.refuge(&prospect)),
                };
                self.heading.come_to_rest();
                let reference = Reference::resting(refuge, *self.heading.heading());
                let (wrench, diagnostics) = law.step_within(state, &reference, &self.limits)?;
                Ok(ShieldStep { wrench, diagnostics, reason: Some(reason), reference })
            }
        }
    }

    /// Takes up what the policy offers: whether it can be used; none where it says nothing.
    fn listen(&mut self, offers: Option<&Demand>) -> Option<bool> {
        let flies = |demand: &&Demand| self.rotors.is_some() || !matches!(demand, Demand::Rotors { .. });
        let usable = offers.filter(|demand| demand.check().is_ok()).filter(flies);
        match usable {
            Some(demand) => (self.demand, self.silent) = (Some(*demand), 0),
            None => self.silent = self.silent.saturating_add(1),
        }
        offers.map(|_| usable.is_some())
    }

    /// What speaks against the policy in this tick.
    fn judge(
        &mut self,
        state: &State,
        prospect: &StoppingForecast,
        inside: bool,
        usable: Option<bool>,
    ) -> Option<Reason> {
        self.doubtful = if prospect.doubtful { self.doubtful.saturating_add(1) } else { 0 };
        let seconds = |ticks: u32| ticks as f32 * self.period;
        if usable == Some(false) {
            return Some(Reason::Demand);
        }
        if self.demand.is_none() || seconds(self.silent) > self.settings.silence {
            return Some(Reason::Silent);
        }
        self.monitor.violation(state, prospect, inside, seconds(self.doubtful))
    }

    /// Hands over, either way.
    fn decide(&mut self, prospect: &StoppingForecast, against: Option<Reason>) {
        match (&mut self.pilot, against) {
            (InControl::Policy, None) => {}
            (InControl::Policy, Some(reason)) => {
                self.hand_overs = self.hand_overs.saturating_add(1);
                self.pilot = InControl::Law { reason, refuge: self.refuge(prospect), near: 0 };
            }
            (InControl::Law { refuge, near, .. }, against) => {
                let away = (prospect.z_1 - *refuge).norm_squared();
                let arrived =
                    away < REFUGE_RADIUS * REFUGE_RADIUS && prospect.z_2.norm_squared() < REFUGE_RADIUS * REFUGE_RADIUS;
                *near = if arrived && against.is_none() { near.saturating_add(1) } else { 0 };
                let waited = *near as f32 * self.period;
                let patience = self.settings.patience(self.hand_overs);
                if self.hand_overs < self.settings.hand_overs && waited >= patience {
                    self.pilot = InControl::Policy;
                }
            }
        }
    }

    /// Where the law would fly to if it took over now.
    fn refuge(&self, prospect: &StoppingForecast) -> Vector3<f32> {
        self.room.map_or(prospect.z_1, |room| room.refuge(&prospect.z_1))
    }
}

#[cfg(test)]
mod tests;
