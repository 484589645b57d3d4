//! A closed-loop flight: plant, reference and controller, one control tick at a time.
//!
//! At each tick the law sees the plant's state rounded to single precision and the reference of that instant; its wrench is
//! held until the next tick. Time is integer microseconds.

use crate::actuators::{ActuationError, Actuators};
use crate::plant::{BodyState, Clipping, Plant};
use crate::scenario::Scenario;
use controller_core::allocation::Thrusts;
use controller_core::controller::{Controller, Diagnostics};
use controller_core::error::{InputError, ParameterError};
use controller_core::reference::{Reference, Trajectory};
use controller_core::state::Wrench;
use std::fmt;
use std::sync::Arc;

/// A flight under way.
#[derive(Clone)]
pub struct Flight {
    plant: Plant,
    actuators: Actuators,
    controller: Controller,
    trajectory: Arc<dyn Trajectory + Send + Sync>,
    period_us: u64,
    steps_per_tick: u32,
    tick: u64,
}

/// What happened at one control tick.
#[derive(Debug, Clone)]
pub struct Tick {
    /// Time since the start, us.
    pub time_us: u64,
    /// The plant's state before the tick's steps.
    pub state: BodyState,
    /// What was asked for.
    pub reference: Reference,
    /// What the law commanded, before the plant clipped it.
    pub wrench: Wrench,
    /// What the law went through.
    pub diagnostics: Diagnostics,
    /// What the limits or the rotors cut.
    pub clipping: Clipping,
    /// Thrust commanded of each rotor, N; empty without rotors.
    pub rotor_thrusts: Thrusts,
}

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
    /// The wrench could not be applied, or the motion is no longer finite.
    Actuation(ActuationError),
}

impl fmt::Display for FlightError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "at {} s: ", self.time_us as f64 / 1e6)?;
        match &self.cause {
            Cause::Law(error) => write!(f, "the law refused its input: {error}"),
            Cause::Actuation(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for FlightError {}

/// The law for the scenario's vehicle and gains, reset. A simulation may fly what no certificate covers.
///
/// # Errors
/// If the controller refuses the scenario's period; a [`Scenario`] that was read from a file has a good one.
pub fn controller(scenario: &Scenario) -> Result<Controller, ParameterError> {
    let configuration = &scenario.configuration;
    let period = scenario.timing.period() as f32;
    Controller::uncertified(*configuration.vehicle(), *configuration.gains(), configuration.thrust_floor(), period)
}

impl Flight {
    /// A flight of `scenario`, at its start, the controller reset.
    ///
    /// # Errors
    /// As [`controller`]'s.
    pub fn new(scenario: &Scenario) -> Result<Self, ParameterError> {
        let (timing, configuration) = (&scenario.timing, &scenario.configuration);
        let vehicle = configuration.vehicle();
        let hover = vehicle.mass * vehicle.gravity;
        Ok(Self {
            actuators: Actuators::new(scenario.rotors.as_ref(), scenario.delay_steps, hover, timing.step()),
            plant: Plant::new(configuration.vehicle(), configuration.limits(), timing.step(), scenario.initial),
            controller: controller(scenario)?,
            trajectory: Arc::clone(&scenario.trajectory),
            period_us: timing.period_us,
            steps_per_tick: timing.steps_per_tick,
            tick: 0,
        })
    }

    /// One control tick and the plant's motion until the next.
    ///
    /// # Errors
    /// [`FlightError`] with the time; the flight cannot go on after it.
    pub fn tick(&mut self) -> Result<Tick, FlightError> {
        let time_us = self.tick * self.period_us;
        let fail = |cause| FlightError { time_us, cause };
        let state = *self.plant.state();
        let reference = self.trajectory.at(time_us);
        let (wrench, diagnostics) =
            self.controller.step(&state.measured(), &reference).map_err(|error| fail(Cause::Law(error)))?;
        let (clipping, rotor_thrusts) = self
            .actuators
            .hold(&mut self.plant, &wrench, self.steps_per_tick)
            .map_err(|error| fail(Cause::Actuation(error)))?;
        self.tick += 1;
        Ok(Tick { time_us, state, reference, wrench, diagnostics, clipping, rotor_thrusts })
    }
}
