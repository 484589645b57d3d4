//! The least command of any rotor in a flight, part of a full one: u = phi^-1(f / f_max) of the commanded thrust f,
//! with the model's curve at nominal voltage ([`controller_core::allocation::curve`]), and not raised to the motor's
//! idle.
//!
//! A thrust of zero stops a rotor, one that is lost. That is no command; whether it may be, the bounds on the rotors'
//! thrusts say.

use controller_core::allocation::{Motor, ThrustCurve};
use scenario::Scenario;

/// The least command so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeastCommand {
    curve: Option<ThrustCurve>,
    idle: f32,
    least: Option<f32>,
}

impl LeastCommand {
    /// Of a flight of `scenario`, before its first tick.
    pub fn before_flight(scenario: &Scenario) -> Self {
        let Motor { linear, idle } = scenario.motor();
        let first = scenario.configuration.rotors().and_then(|rotors| rotors.first());
        let curve = first.and_then(|rotor| ThrustCurve::new(rotor.thrust_max, Motor { linear, idle: 0.0 }).ok());
        Self { curve, idle, least: None }
    }

    /// Takes a tick's thrusts in, N.
    pub fn observe(&mut self, thrusts: &[f32]) {
        let Some(curve) = self.curve else { return };
        for command in thrusts.iter().filter(|thrust| **thrust != 0.0).map(|thrust| curve.command(*thrust, 1.0)) {
            self.least = Some(self.least.map_or(command, |least| least.min(command)));
        }
    }

    /// The least command; none without rotors.
    pub fn least(&self) -> Option<f64> {
        self.least.map(f64::from)
    }

    /// What motors idle at.
    pub fn idle(&self) -> f64 {
        self.idle.into()
    }
}

#[cfg(test)]
mod tests;
