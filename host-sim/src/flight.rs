//! A closed-loop flight: plant, reference and controller, one control tick at a time.
//!
//! At each tick the law gets the vehicle's state in single precision, true, measured or estimated, and the reference;
//! its wrench is held until the next tick. Time is integer microseconds.
//!
//! | module | what it holds |
//! |---|---|
//! | [`controller`] | our law or a rival, in the loop |
//! | [`estimation`] | the core's estimator on the simulated instruments |
//! | [`sensed_vehicle`] | the vehicle with its sensors or that estimator |
//! | [`law_on_vehicle`] | a law on a vehicle, ready for any number of flights |
//! | [`course`] | a flight's figures: height lost, overshoot, settling time |
//! | [`tasks`] | tasks that every study flies |
//! | [`least_command`] | the least command of any rotor in it |
//! | [`extremes`], [`claims`] | a flight's extremes; its claims and verdicts |

pub mod claims;
pub mod controller;
pub mod course;
pub mod estimation;
pub mod extremes;
pub mod law_on_vehicle;
pub mod least_command;
pub mod sensed_vehicle;
pub mod tasks;

use crate::flight::controller::Controller;
use crate::flight::estimation::NoEstimate;
use crate::flight::sensed_vehicle::{Known, SensedVehicle};
use crate::rivals::pilot::RivalPilot;
use crate::rivals::rival::Rival;
use crate::vehicle::actuators::ActuationError;
use crate::vehicle::ground::Touchdown;
use crate::vehicle::reality::Surroundings;
use crate::vehicle::sensed::{Sensed, specific_force};
use controller_core::allocation::Thrusts;
use controller_core::allocation::remaining::LostRotor;
use controller_core::certificate::certified::Certified;
use controller_core::configuration::Configuration;
use controller_core::controller::Diagnostics;
use controller_core::error::{InputError, ParameterError};
use controller_core::extended::measured::Measured;
use controller_core::extended::memory::Estimates;
use controller_core::law::{Command, Law};
use controller_core::reference::{Reference, Trajectory};
use controller_core::state::{State, Wrench};
use nalgebra::{Vector3, Vector4};
use scenario::Scenario;
use scenario::body::BodyState;
use std::fmt;
use std::sync::Arc;

/// A flight under way.
#[derive(Clone)]
pub struct Flight {
    vehicle: SensedVehicle,
    controller: Controller,
    /// The state at the last tick.
    before: BodyState,
    /// m/s^2.
    gravity: f64,
    /// Thrust and torque that are taken to act before the first step: N, N m.
    hover: Vector4<f64>,
    trajectory: Arc<dyn Trajectory + Send + Sync>,
    period_us: u64,
    tick: u64,
}

/// One control tick.
#[derive(Debug, Clone)]
pub struct Tick {
    /// Time since the start, us.
    pub time_us: u64,
    /// The vehicle's true state before the tick's steps.
    pub state: BodyState,
    /// The measured or estimated state that the law got, where there are sensors or an estimator.
    pub measured: Option<Box<State>>,
    /// Wind and battery at that moment.
    pub surroundings: Surroundings,
    /// The reference.
    pub reference: Reference,
    /// The law's command before clipping. The rotors get it divided by the estimated thrust scale.
    pub wrench: Wrench,
    /// The law's intermediate values.
    pub diagnostics: Diagnostics,
    /// The law's estimates, if it has any.
    pub estimates: Option<Estimates>,
    /// Whether the limits or the rotors cut something of it.
    pub clipped: bool,
    /// Each rotor's thrust at the tick, N, after lag; empty without rotors.
    pub rotors: Vec<f64>,
    /// Thrust commanded of each rotor, N; empty without rotors.
    pub rotor_thrusts: Thrusts,
    /// The rotor that the law has found to fail, if it has.
    pub lost: Option<LostRotor>,
}

/// Of a control tick what a verdict on the flight needs. What the law went through is not even worked out.
#[derive(Debug, Clone)]
pub struct Brief {
    /// Time since the start, us.
    pub time_us: u64,
    /// The vehicle's true state before the tick's steps.
    pub state: BodyState,
    /// The reference.
    pub reference: Reference,
    /// The law's command, as in [`Tick::wrench`].
    pub wrench: Wrench,
    /// theta~, the error from the law's desired attitude.
    pub mrp: Vector3<f32>,
    /// Whether the limits or the rotors cut something of it.
    pub clipped: bool,
    /// Thrust commanded of each rotor, N; empty without rotors.
    pub rotor_thrusts: Thrusts,
    /// Whether it stood on the ground, as in [`Tick::surroundings`].
    pub standing: bool,
}

/// A law's command, and its diagnostics.
type Answer<D> = Result<(Command, D), InputError>;

/// A flight that could not go on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlightError {
    /// When, us after the start.
    pub time_us: u64,
    /// Why.
    pub cause: Cause,
}

/// Why a flight could not go on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cause {
    /// The law refused its input.
    Law(InputError),
    /// There is no state to fly on.
    Estimate(NoEstimate),
    /// The wrench could not be applied, or the motion is no longer finite.
    Actuation(ActuationError),
}

impl fmt::Display for FlightError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "at {} s: ", self.time_us as f64 / 1e6)?;
        match &self.cause {
            Cause::Law(error) => write!(f, "the law refused its input: {error}"),
            Cause::Estimate(error) => write!(f, "{error}"),
            Cause::Actuation(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for FlightError {}

/// The law of the scenario, reset: through the door that boards use where the scenario is certified. What no
/// certificate covers may be simulated.
///
/// # Errors
/// If the law refuses the scenario's period or delay.
pub fn law(scenario: &Scenario) -> Result<Law, ParameterError> {
    let configuration = &scenario.configuration;
    let period = scenario.timing.period() as f32;
    match Certified::new(configuration.clone()) {
        Ok(certified) => Law::new(&certified, period),
        Err(_) => Law::uncertified(configuration, period),
    }
}

impl Flight {
    /// A flight of `scenario`, at its start, the controller reset: certified if it can be. That takes about a
    /// millisecond; to fly one scenario many times, clone the start.
    pub fn new(scenario: &Scenario) -> Result<Self, ParameterError> {
        match Certified::new(scenario.configuration.clone()) {
            Ok(certified) => Self::certified(scenario, &certified),
            Err(_) => Self::uncertified(scenario),
        }
    }

    /// A flight of a certified configuration, with the law and the allocation that boards fly, in the circumstances of
    /// `scenario`: its timing, delay, lag, start and reference.
    pub fn certified(scenario: &Scenario, certified: &Certified) -> Result<Self, ParameterError> {
        let law = Law::new(certified, scenario.timing.period() as f32)?;
        Ok(Self::start(scenario, certified.configuration(), Controller::Ours(law)))
    }

    /// An uncertified flight.
    pub fn uncertified(scenario: &Scenario) -> Result<Self, ParameterError> {
        let configuration = &scenario.configuration;
        let law = Law::uncertified(configuration, scenario.timing.period() as f32)?;
        Ok(Self::start(scenario, configuration, Controller::Ours(law)))
    }

    /// A flight of another law, on the vehicle, sensors and rotors of `scenario`.
    pub fn of_rival(scenario: &Scenario, rival: Box<dyn Rival>) -> Self {
        let pilot = Box::new(RivalPilot::new(scenario, rival));
        Self::start(scenario, &scenario.configuration, Controller::Rival(pilot))
    }

    fn start(scenario: &Scenario, configuration: &Configuration, controller: Controller) -> Self {
        let vehicle = SensedVehicle::new(scenario, configuration);
        let gravity = f64::from(configuration.vehicle().gravity);
        Self {
            controller,
            before: *vehicle.vehicle().state(),
            gravity,
            hover: Sensed::hovering(configuration.vehicle()).wrench,
            vehicle,
            trajectory: Arc::clone(&scenario.trajectory),
            period_us: scenario.timing.period_us,
            tick: 0,
        }
    }

    /// How often the extended law's fallback came so far.
    pub fn fallback_times(&self) -> u32 {
        self.controller.fallback_times()
    }

    /// The rotor that the law has found to fail; rivals look for none.
    pub fn lost(&self) -> Option<LostRotor> {
        self.controller.lost()
    }

    /// The last touch of the ground since the last call.
    pub fn take_touchdown(&mut self) -> Option<Touchdown> {
        self.vehicle.vehicle_mut().take_touchdown()
    }

    /// One control tick and the plant's motion until the next.
    ///
    /// # Errors
    /// [`FlightError`] with the time; the flight cannot go on after it.
    pub fn tick(&mut self) -> Result<Tick, FlightError> {
        let vehicle = self.vehicle.vehicle();
        let (rotors, surroundings) = (vehicle.thrusts(), vehicle.surroundings());
        let (measured, Brief { time_us, state, reference, wrench, clipped, rotor_thrusts, .. }, diagnostics) =
            self.advance(Controller::step)?;
        let (estimates, lost) = (self.controller.estimates(), self.controller.lost());
        Ok(Tick {
            time_us,
            state,
            measured: measured.map(Box::new),
            surroundings,
            reference,
            wrench,
            diagnostics,
            estimates,
            clipped,
            rotors,
            rotor_thrusts,
            lost,
        })
    }

    /// The same tick, to the bit, in brief: as campaigns fly.
    #[inline]
    pub fn brief_tick(&mut self) -> Result<Brief, FlightError> {
        let (_, brief, ()) = self.advance(Controller::command)?;
        Ok(brief)
    }

    /// A control tick with the law called by `step`: the measured state where that is not the true one, the tick, and
    /// what `step` returns besides.
    #[inline(always)]
    fn advance<D>(
        &mut self,
        step: impl FnOnce(&mut Controller, &State, &Sensed, &Reference) -> Answer<D>,
    ) -> Result<(Option<State>, Brief, D), FlightError> {
        let vehicle = self.vehicle.vehicle();
        let (time_us, state, standing) = (self.time_us(), *vehicle.state(), vehicle.stands());
        let reference = self.trajectory.at(time_us);
        let measured = self.measure().map_err(|error| self.error(Cause::Estimate(error)))?;
        let sensed = self.sense(&state);
        let answer = step(&mut self.controller, &measured.unwrap_or_else(|| state.measured()), &sensed, &reference);
        let (Command { wrench, mrp }, more) = answer.map_err(|error| self.error(Cause::Law(error)))?;
        let held = self.vehicle.hold(&self.controller.demand(&wrench));
        let (clipped, rotor_thrusts) = held.map_err(|error| self.error(Cause::Actuation(error)))?;
        let clipped = clipped || self.controller.is_cut();
        // The motion was then another than the wrench alone would have made it.
        if clipped || standing {
            self.controller.hold_estimates();
        }
        self.tick += 1;
        Ok((measured, Brief { time_us, state, reference, wrench, mrp, clipped, rotor_thrusts, standing }, more))
    }

    #[inline]
    fn time_us(&self) -> u64 {
        self.tick * self.period_us
    }

    #[cold]
    fn error(&self, cause: Cause) -> FlightError {
        FlightError { time_us: self.time_us(), cause }
    }

    /// The measured state, where that is not the true one.
    #[inline]
    fn measure(&mut self) -> Result<Option<State>, NoEstimate> {
        let Some(Known { state, acceleration, jumped }) = self.vehicle.known()? else { return Ok(None) };
        self.controller.measured(&Measured { acceleration, wrench: None, lost: None });
        if jumped {
            self.controller.hold_estimates();
        }
        Ok(Some(state))
    }

    /// What is sensed beside the measured state.
    #[inline]
    fn sense(&mut self, state: &BodyState) -> Sensed {
        let before = std::mem::replace(&mut self.before, *state);
        let period = self.period_us as f64 * 1e-6;
        let truth = Sensed {
            specific_force: specific_force(&before, state, period, self.gravity),
            wrench: self.vehicle.vehicle_mut().take_acted().unwrap_or(self.hover),
        };
        self.vehicle.sense(truth)
    }
}

#[cfg(test)]
mod tests;
