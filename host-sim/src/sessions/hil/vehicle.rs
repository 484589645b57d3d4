//! The vehicle of a session: delay, rotors, body and ground, moved by motor commands one control period at a time.
//!
//! It starts on the ground, below where the scenario starts, level, with its rotors standing still. A command u of a
//! rotor means u^2 of its greatest thrust, as the firmware's thrust curve has it; less of that from when it fails.
//! The air is left out.

use crate::sessions::messages::{Controls, MOTOR_COUNT};
use crate::vehicle::actuators::rotors::SpinningRotors;
use crate::vehicle::ground::{Ground, Touchdown};
use crate::vehicle::plant::Plant;
use crate::vehicle::reality::wind::first_step;
use controller_core::allocation::{Rotor, ThrustCurve};
use nalgebra::{UnitQuaternion, Vector3};
use scenario::Scenario;
use scenario::body::BodyState;
use scenario::reality::failure::Failure;
use std::collections::VecDeque;

const GROUND_HEIGHT_M: f64 = 0.0;

/// The motion under a command.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// Where the vehicle is a period later.
    pub state: BodyState,
    /// Where it was on the way, at evenly spaced instants; the last is the period's end.
    pub path: Vec<BodyState>,
    /// What an accelerometer shows, m/s^2, body frame of then: the mean over the way, impacts with it.
    pub specific_force: Vector3<f64>,
    /// The rotors' thrust then, N.
    pub thrust: f64,
    /// How fast the rotors turn then, rad/s.
    pub speeds: Vec<f64>,
    /// The last touchdown on the way there.
    pub touchdown: Option<Touchdown>,
}

/// A vehicle that a flight controller elsewhere flies.
#[derive(Debug, Clone)]
pub struct HilVehicle {
    plant: Plant,
    ground: Ground,
    rotors: SpinningRotors,
    curves: Vec<ThrustCurve>,
    steps: u64,
    /// s.
    period: f64,
    /// m/s^2.
    gravity: f64,
    delay: u64,
    /// Plant steps since the start.
    now: u64,
    /// Thrusts on their way, N, with the step at which they act.
    waiting: VecDeque<(u64, Vec<f32>)>,
    /// What fails, from that plant step on.
    failure: Option<(Failure, u64)>,
}

impl HilVehicle {
    /// The scenario's, standing on the ground.
    ///
    /// # Errors
    /// In words, if the scenario has not as many rotors as there are motor commands.
    pub fn new(scenario: &Scenario) -> Result<Self, String> {
        let configuration = &scenario.configuration;
        let Some(rotors) = configuration.rotors().filter(|rotors| rotors.len() == MOTOR_COUNT) else {
            let found = configuration.rotors().map_or(0, |rotors| rotors.len());
            return Err(format!("rotors: a flight controller commands {MOTOR_COUNT}, found {found}"));
        };
        let step = scenario.timing.step();
        let (ground, state) = Ground::under(configuration.vehicle(), GROUND_HEIGHT_M, &scenario.initial, step);
        let curve = |rotor: &Rotor| ThrustCurve::new(rotor.thrust_max, scenario.motor());
        let curves = rotors.iter().map(curve).collect::<Result<_, _>>().map_err(|error| error.to_string())?;
        Ok(Self {
            plant: Plant::new(configuration.vehicle(), configuration.limits(), step, state),
            ground,
            rotors: SpinningRotors::stopped(rotors, scenario.rotor_lag, step),
            curves,
            steps: scenario.timing.steps_per_tick.into(),
            period: scenario.timing.period(),
            gravity: configuration.vehicle().gravity.into(),
            delay: scenario.delay_steps,
            now: 0,
            waiting: VecDeque::new(),
            failure: scenario.reality.failure.map(|failure| (failure, first_step(failure.time, step))),
        })
    }

    /// The present state.
    pub fn state(&self) -> &BodyState {
        self.plant.state()
    }

    /// Takes one command and moves on by one control period, noting where the vehicle is at `instants` of it: that
    /// number divides the period's plant steps.
    ///
    /// # Errors
    /// In words, if a command is not from 0 to 1, or the motion is not finite afterwards.
    pub fn advance(&mut self, controls: &Controls, instants: u64) -> Result<Moved, String> {
        if let Some(bad) = controls.commands.iter().find(|command| !(0.0..=1.0).contains(*command)) {
            return Err(format!("a motor command is not from 0 to 1: {bad}"));
        }
        let thrust = |(curve, command): (&ThrustCurve, f32)| curve.thrust(curve.held(command), 1.0);
        let thrusts = self.curves.iter().zip(controls.commands).map(thrust).collect();
        self.waiting.push_back((self.now + self.delay, thrusts));
        let before = self.plant.state().velocity;
        let (mut thrust, mut touchdown, mut path) = (0.0, None, Vec::new());
        for step in 1..=self.steps {
            while let Some((_, mut thrusts)) = self.waiting.pop_front_if(|(due, _)| *due <= self.now) {
                if let Some((failed, _)) = self.failure.filter(|(_, first)| self.now >= *first)
                    && let Some(thrust) = thrusts.get_mut(failed.rotor)
                {
                    *thrust *= failed.thrust_left as f32;
                }
                self.rotors.command(&thrusts);
            }
            let torque;
            (thrust, torque) = self.rotors.advance();
            touchdown = self.ground.act(&mut self.plant, thrust, &torque).or(touchdown);
            self.now += 1;
            if (step * instants).is_multiple_of(self.steps) {
                path.push(*self.plant.state());
            }
        }
        self.plant.check().map_err(|error| error.to_string())?;
        let state = *self.plant.state();
        let held = (state.velocity - before) / self.period + Vector3::z() * self.gravity;
        let specific_force = UnitQuaternion::new_normalize(state.attitude).inverse_transform_vector(&held);
        Ok(Moved { state, path, specific_force, thrust, speeds: self.rotors.speeds().collect(), touchdown })
    }
}

#[cfg(test)]
mod tests;
