//! The true vehicle in moving air: it replaces [`crate::vehicle::plant`] and [`crate::vehicle::actuators`] where the
//! scenario has more than its model ([`scenario::reality`]).
//!
//! ```text
//! wrench -> (delay) -> allocation -> motors (battery, failure) -> rotor speeds -> thrusts, drag -> body -> ground
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | `body` | the rigid body, by the classical Runge-Kutta method of fourth order |
//! | `propulsion` | from the rotors' commanded thrusts to their speeds |
//! | [`battery`] | the voltage the motors have |
//! | `air` | forces and moments of rotors and frame in moving air |
//! | [`wind`], `dryden` | how the air moves |
//!
//! A disturbance adds a constant force at the centre of mass, world frame, and a constant torque, body frame.
//!
//! Forces are evaluated at every stage of the method: the rotors' speeds and gusts at the stage's time, drag at its
//! velocity and attitude. So where these are smooth, the whole has the method's order. The exceptions: a command that
//! arrives, a step gust, a disturbance, a rotor that fails and the ground act from the beginning of a plant step on;
//! voltage and turbulence are held over it. Each costs an error of the order of the step at that instant and leaves the
//! order of the rest alone.
//!
//! A vehicle on the ground stands while the forces on it do not lift it; the ground is `crate::vehicle::ground`'s.

pub(crate) mod air;
pub mod battery;
pub(crate) mod body;
pub(crate) mod dryden;
pub(crate) mod propulsion;
pub mod wind;

use crate::vehicle::actuators::{ActuationError, ActuatorDemand, Delayed};
use crate::vehicle::ground::{Ground, Touchdown};
use crate::vehicle::plant::Diverged;
use crate::vehicle::sensed::Acted;
use air::{Air, Flow, ground_effect};
use body::{RigidBody, STAGE_TIMES};
use controller_core::allocation::geometry::ROTORS_MAX;
use controller_core::allocation::{Mixer, Thrusts};
use controller_core::configuration::Configuration;
use nalgebra::{UnitQuaternion, Vector3};
use propulsion::Propulsion;
use scenario::Scenario;
use scenario::body::BodyState;
use scenario::reality::disturbance::Disturbance;
use scenario::reality::truth::Truth;
use wind::{MovingAir, first_step};

/// Wind and battery at an instant.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Surroundings {
    /// Velocity of the air, m/s, world; none where the scenario has no wind.
    pub wind: Option<Vector3<f64>>,
    /// Voltage, V, and current, A, of the battery; none without one.
    pub battery: Option<(f64, f64)>,
    /// Whether it stands on the ground.
    pub standing: bool,
}

/// A vehicle as it really is.
#[derive(Debug, Clone)]
pub struct RealVehicle {
    body: RigidBody,
    air: Air,
    wind: Option<MovingAir>,
    /// With the plant step at which it begins, and its force, N, world.
    disturbance: Option<(Disturbance, u64, Vector3<f64>)>,
    mixer: Option<Box<Mixer>>,
    propulsion: Propulsion,
    ground: Option<Ground>,
    /// Rotors' radius, m, zero without ground effect, and where the vehicle stands, m.
    rotors_above: (f64, f64),
    /// The last one.
    touchdown: Option<Touchdown>,
    /// Plant step, s.
    step: f64,
    /// Plant steps since the start.
    now: u64,
    demand: Delayed,
    /// What acted since it was last taken, by the model's coefficients.
    pub(crate) acted: Acted,
    /// Its origin, where the controller takes the centre of mass to be.
    state: BodyState,
}

impl RealVehicle {
    /// The scenario's vehicle at its start. The model is the `configuration`'s. Its rotors turn as the model hovers.
    pub fn new(scenario: &Scenario, configuration: &Configuration) -> Self {
        let (reality, step) = (&scenario.reality, scenario.timing.step());
        let model = configuration.vehicle();
        let truth = reality.truth.clone().unwrap_or_else(|| Truth::model(model));
        let lag = truth.lag.unwrap_or(scenario.rotor_lag);
        let propulsion = Propulsion::new(configuration, scenario.motor(), lag, reality, step);
        let gravity = f64::from(model.gravity);
        let (ground, start) = match reality.ground {
            Some(ground) => {
                let (ground, start) = Ground::at(ground.height, &truth, gravity, &scenario.initial, step);
                (Some(ground), start)
            }
            None => (None, scenario.initial),
        };
        Self {
            air: Air::new(configuration.rotors(), &truth, &reality.drag.unwrap_or_default()),
            wind: reality.wind.map(|wind| MovingAir::new(&wind, step)),
            disturbance: reality.disturbance.map(|disturbance| {
                let force = disturbance.acceleration * f64::from(model.mass);
                (disturbance, first_step(disturbance.start, step), force)
            }),
            mixer: configuration.rotors().map(|rotors| Box::new(Mixer::new(rotors))),
            propulsion,
            ground,
            rotors_above: reality.ground.map_or((0.0, 0.0), |ground| (truth.rotor_radius, ground.height)),
            touchdown: None,
            step,
            now: 0,
            demand: Delayed::new(scenario.delay_steps, model.mass * model.gravity),
            acted: Acted::default(),
            body: RigidBody::new(&truth, gravity, &start),
            state: start,
        }
    }

    /// The same vehicle before the first command: no rotor turns.
    pub fn switched_off(mut self) -> Self {
        self.propulsion.stop();
        self
    }

    /// Asks each rotor for a thrust, N, and moves the vehicle for one plant step. For a flight controller that
    /// allocates by itself: without the scenario's delay.
    pub fn drive(&mut self, thrusts: &[f32]) -> Result<(), Diverged> {
        self.propulsion.command(thrusts);
        self.advance();
        if self.state.is_finite() { Ok(()) } else { Err(Diverged) }
    }

    /// The present state of its origin.
    pub fn state(&self) -> &BodyState {
        &self.state
    }

    /// The rotors' speeds at this moment, rad/s; zero where there is no rotor.
    pub fn rotor_speeds(&self) -> [f64; ROTORS_MAX] {
        self.propulsion.speeds()
    }

    /// The rotors' thrusts at this moment in still air, N; none without rotors.
    pub fn thrusts(&self) -> Vec<f64> {
        self.air.thrusts(&self.propulsion.speeds())
    }

    /// Wind and battery at this moment.
    pub fn surroundings(&self) -> Surroundings {
        Surroundings {
            wind: self.wind.as_ref().map(|wind| wind.velocity(self.now, 0.0)),
            battery: self.propulsion.battery(),
            standing: self.stands(),
        }
    }

    /// Whether it stands on the ground.
    pub fn stands(&self) -> bool {
        self.ground.as_ref().is_some_and(Ground::stands)
    }

    /// Pushes it from now on with a force, N, world, and turns it with a torque, N m, body, in place of the scenario's
    /// disturbance.
    pub fn push(&mut self, force: Vector3<f64>, torque: Vector3<f64>) {
        let turning = Disturbance { acceleration: Vector3::zeros(), torque, start: 0.0 };
        self.disturbance = Some((turning, 0, force));
    }

    /// Lets a rotor, counted from 0, deliver from now on this share of the thrust that it would without this.
    pub fn weaken(&mut self, rotor: usize, thrust_left: f64) {
        self.propulsion.weaken(rotor, thrust_left);
    }

    /// Moves its origin by an outside force.
    pub fn place(&mut self, state: &BodyState) {
        if let Some(ground) = &mut self.ground {
            ground.take_off_foot();
        }
        self.put(state);
    }

    fn put(&mut self, state: &BodyState) {
        self.body.place(state);
        self.state = *state;
    }

    /// The last touch of the ground since the last call; a vehicle that hops touches it more than once.
    pub fn take_touchdown(&mut self) -> Option<Touchdown> {
        self.touchdown.take()
    }

    /// Takes what a tick asks for and moves the vehicle for `steps` plant steps. Returns whether anything was cut, and
    /// the commanded rotor thrusts, N, as they stand at the end (none without rotors).
    pub fn hold(&mut self, demand: &ActuatorDemand, steps: u32) -> Result<(bool, Thrusts), ActuationError> {
        self.demand.ask(demand, self.now);
        let mut clipped = false;
        let mut thrusts = Thrusts::new();
        for _ in 0..steps {
            let arrives = self.demand.arrives(self.now);
            match &self.mixer {
                Some(mixer) if arrives => {
                    let (allocated, cut) = self.demand.acting.allocated(mixer)?;
                    clipped |= cut;
                    thrusts = allocated;
                    self.propulsion.command(&thrusts);
                }
                Some(_) => {}
                None => clipped |= self.propulsion.command_directly(&self.demand.acting.wrench()),
            }
            self.advance();
        }
        if self.state.is_finite() { Ok((clipped, thrusts)) } else { Err(Diverged.into()) }
    }

    /// One plant step.
    fn advance(&mut self) {
        let stages = self.propulsion.advance(self.now);
        let (thrust, torque) = self.propulsion.as_modelled(&stages[1]);
        self.acted.add(thrust, &torque);
        let (air, wind, now, propulsion) = (&self.air, &self.wind, self.now, &self.propulsion);
        let (radius, level) = self.rotors_above;
        let disturbance = self.disturbance.filter(|(_, first, _)| now >= *first);
        let forces = |stage: usize, state: &BodyState| {
            let moving = wind.as_ref().map_or_else(Vector3::zeros, |wind| wind.velocity(now, STAGE_TIMES[stage]));
            let attitude = UnitQuaternion::new_unchecked(state.attitude);
            let airspeed = attitude.inverse_transform_vector(&(state.velocity - moving));
            let ground_effect = ground_effect(radius, state.position.z - level);
            let flow = Flow { airspeed, angular_velocity: state.angular_velocity, ground_effect };
            let (force, torque) = air.act(&flow, &stages[stage]);
            let torque = torque + propulsion.spin(&stages[stage], &state.angular_velocity);
            match &disturbance {
                Some((disturbance, _, push)) => {
                    (force + attitude.inverse_transform_vector(push), torque + disturbance.torque)
                }
                None => (force, torque),
            }
        };
        let held = self.ground.as_mut().and_then(|ground| {
            let body = self.body.state();
            let (force, torque) = forces(0, body);
            ground.hold(&self.state, &(UnitQuaternion::new_unchecked(body.attitude) * force), &torque)
        });
        let grounded = held.or_else(|| {
            self.body.advance(self.step, forces);
            self.state = self.body.origin();
            let (landed, touchdown) = self.ground.as_mut()?.touch(&self.state)?;
            self.touchdown = Some(touchdown);
            Some(landed)
        });
        if let Some(state) = grounded {
            self.put(&state);
        }
        if let Some(wind) = &mut self.wind {
            wind.advance();
        }
        self.now += 1;
    }
}

#[cfg(test)]
mod tests;
