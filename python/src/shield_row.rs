//! A law behind its shield, step by step.

use crate::errors::{refused, refused_field};
use crate::rows::{WRENCH_COLUMNS, felt, of_wrench};
use crate::scenarios::Scenario;
use controller_core::controller::Diagnostics;
use controller_core::heading::Heading;
use controller_core::law::Law;
use controller_core::reference::Reference;
use controller_core::shield::{Demand, Reason, Settings, Shield};
use controller_core::state::State;
use host_sim::flight;
use nalgebra::Vector3;
use pyo3::prelude::*;

/// A law, its shield, and what became of the last step.
#[derive(Clone)]
pub struct ShieldRow {
    pub law: Law,
    pub shield: Shield,
    /// Before the first step.
    fresh: bool,
    reason: Option<Reason>,
    pub reference: Reference,
}

impl ShieldRow {
    pub fn new(scenario: &Scenario, settings: &Settings) -> PyResult<Self> {
        let (configuration, period) = (&scenario.read.configuration, scenario.read.timing.period() as f32);
        let shield = Shield::new(configuration, settings, period).map_err(refused)?;
        let law = flight::law(&scenario.read).map_err(refused)?;
        let origin = Vector3::zeros();
        let refuge = settings.nearest_room(&origin).map_or(origin, |room| room.refuge(&origin));
        let reference = Reference::resting(refuge, Heading::FORWARD);
        Ok(Self { law, shield, fresh: true, reason: None, reference })
    }

    /// Whether it is as before a flight, as `start` is.
    pub fn is_as(&self, start: &Self) -> bool {
        self.fresh && self.law == start.law
    }

    pub fn by_policy(&self) -> bool {
        !self.fresh && self.reason.is_none()
    }

    pub fn reason(&self) -> &'static str {
        self.reason.map_or("", Reason::word)
    }

    /// The speeds last commanded of the rotors.
    pub fn rotors(&mut self) -> [f32; 4] {
        self.law.extended().map_or([0.0; 4], |law| self.shield.rotors(law))
    }

    pub fn step(
        &mut self,
        state: &State,
        demand: Option<&Demand>,
        acceleration: Option<&[f64; 3]>,
    ) -> Result<([f32; WRENCH_COLUMNS], Diagnostics), String> {
        if let Some(acceleration) = acceleration {
            self.law.measured(&felt(acceleration));
        }
        if self.fresh {
            self.shield.reset(&Heading::from_attitude(&state.attitude));
        }
        // There is no shield of another law.
        let law = self.law.extended().ok_or("control.law: must be \"extended\"")?;
        let flown = self.shield.step(law, state, demand).map_err(|error| error.to_string())?;
        (self.fresh, self.reason, self.reference) = (false, flown.reason, flown.reference);
        Ok((of_wrench(&flown.wrench), flown.diagnostics))
    }

    /// What was given, if the vehicle's rotors are an X.
    pub fn of_an_x<T>(&self, given: T) -> PyResult<T> {
        if self.shield.flies_rotors() {
            return Ok(given);
        }
        let problem = "this vehicle flies none: it takes an X of four like rotors, front right counter-clockwise";
        Err(refused_field("rotors", problem))
    }
}

/// The refusal of two demands at once.
pub fn both() -> PyErr {
    refused_field("rotors", "a demand is given already; leave one of them out")
}
