//! The vehicle that a flight simulates: the scenario's model, or what it says the vehicle really is.
//!
//! | module | what it holds |
//! |---|---|
//! | [`plant`] | the paper's rigid body, eq. (2) |
//! | [`actuators`] | delay, allocation and rotors that lag |
//! | [`reality`] | the vehicle as it really is: drag, wind, wrong mass, sagging battery, failing rotor |
//! | [`ground`] | level ground, for flights that start and end there |
//! | [`sensors`], [`sensed`] | the measured state; what an IMU and motor controllers say beside it |
//! | [`instruments`] | an IMU at 1 kHz and late poses, for an estimator |
//!
//! The model's body and actuators fly wherever the file leaves reality out, bit for bit as if there were nothing else.

pub mod actuators;
pub mod ground;
pub mod instruments;
pub mod plant;
pub mod reality;
pub mod sensed;
pub mod sensors;

use crate::vehicle::actuators::rotors::SpinningRotors;
use crate::vehicle::actuators::{ActuationError, ActuatorDemand, Actuators};
use crate::vehicle::ground::Touchdown;
use crate::vehicle::plant::Plant;
use crate::vehicle::reality::{RealVehicle, Surroundings};
use controller_core::allocation::{Mixer, Thrusts};
use controller_core::configuration::Configuration;
use nalgebra::Vector4;
use scenario::Scenario;
use scenario::body::BodyState;

/// A vehicle in flight.
#[derive(Debug, Clone)]
pub enum SimulatedVehicle {
    /// As the model has it.
    Model(Box<Plant>, Box<Actuators>),
    /// As the scenario says that it is.
    Real(Box<RealVehicle>),
}

impl SimulatedVehicle {
    /// The scenario's vehicle at its start. The model is the `configuration`'s.
    pub fn new(scenario: &Scenario, configuration: &Configuration) -> Self {
        if !scenario.reality.is_model() {
            return Self::Real(Box::new(RealVehicle::new(scenario, configuration)));
        }
        let (vehicle, step) = (configuration.vehicle(), scenario.timing.step());
        let hover = vehicle.mass * vehicle.gravity;
        let rotors = configuration.rotors().map(|rotors| {
            let spinning = SpinningRotors::hovering(rotors, scenario.rotor_lag, hover, step);
            (Box::new(Mixer::new(rotors)), spinning)
        });
        let plant = Plant::new(vehicle, configuration.limits(), step, scenario.initial);
        Self::Model(Box::new(plant), Box::new(Actuators::new(rotors, scenario.delay_steps, hover)))
    }

    /// The present state of its origin.
    pub fn state(&self) -> &BodyState {
        match self {
            Self::Model(plant, _) => plant.state(),
            Self::Real(vehicle) => vehicle.state(),
        }
    }

    /// The rotors' thrusts at this moment, N, after lag; none without rotors.
    pub fn thrusts(&self) -> Vec<f64> {
        match self {
            Self::Model(_, actuators) => actuators.thrusts(),
            Self::Real(vehicle) => vehicle.thrusts(),
        }
    }

    /// Wind and battery at this moment.
    pub fn surroundings(&self) -> Surroundings {
        match self {
            Self::Model(..) => Surroundings::default(),
            Self::Real(vehicle) => vehicle.surroundings(),
        }
    }

    /// Its body, where it is the model's and the wrench acts on it at once.
    pub fn bare(&self) -> Option<&Plant> {
        match self {
            Self::Model(plant, actuators) if actuators.are_ideal() => Some(plant),
            _ => None,
        }
    }

    /// Puts that body where it has moved; any other stays.
    pub fn place(&mut self, state: BodyState) {
        if let Self::Model(plant, _) = self {
            plant.place(state);
        }
    }

    /// Whether it stands on the ground.
    pub fn stands(&self) -> bool {
        match self {
            Self::Model(..) => false,
            Self::Real(vehicle) => vehicle.stands(),
        }
    }

    /// The last touch of the ground since the last call.
    pub fn take_touchdown(&mut self) -> Option<Touchdown> {
        match self {
            Self::Model(..) => None,
            Self::Real(vehicle) => vehicle.take_touchdown(),
        }
    }

    /// The mean thrust, N, and torque, N m, since the last call, of rotors that turn as measured and give what the
    /// model says; none before the vehicle moves.
    pub fn take_acted(&mut self) -> Option<Vector4<f64>> {
        match self {
            Self::Model(_, actuators) => actuators.acted.take(),
            Self::Real(vehicle) => vehicle.acted.take(),
        }
    }

    /// Takes what a tick asks for and moves the vehicle for `steps` plant steps. Returns whether anything was cut, and
    /// the commanded rotor thrusts, N, as they stand at the end (none without rotors).
    pub fn hold(&mut self, demand: &ActuatorDemand, steps: u32) -> Result<(bool, Thrusts), ActuationError> {
        match self {
            Self::Model(plant, actuators) => actuators.hold(plant, demand, steps),
            Self::Real(vehicle) => vehicle.hold(demand, steps),
        }
    }
}
