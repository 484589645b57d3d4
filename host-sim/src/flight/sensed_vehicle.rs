//! A simulated vehicle with its sensors, or with its instruments and the boards' estimator: what a controller knows of
//! it at each tick, and what a tick's command does to it.

use crate::flight::estimation::{Estimation, NoEstimate};
use crate::vehicle::SimulatedVehicle;
use crate::vehicle::actuators::{ActuationError, ActuatorDemand};
use crate::vehicle::plant::Plant;
use crate::vehicle::sensed::Sensed;
use crate::vehicle::sensors::Sensors;
use controller_core::allocation::Thrusts;
use controller_core::configuration::Configuration;
use controller_core::state::State;
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::timing::Timing;

/// What a controller knows at a tick, where that is not the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// The measured or estimated state.
    pub state: State,
    /// v' since the last tick, m/s^2, world; none without an accelerometer.
    pub acceleration: Option<Vector3<f32>>,
    /// Whether the estimate has jumped since the last tick: no motion made that difference.
    pub jumped: bool,
}

/// A vehicle, and what senses it.
#[derive(Debug, Clone)]
pub struct SensedVehicle {
    vehicle: SimulatedVehicle,
    sensors: Option<Sensors>,
    estimation: Option<Box<Estimation>>,
    timing: Timing,
}

impl SensedVehicle {
    /// The scenario's, at its start. The model is the `configuration`'s. An estimator is aligned.
    pub fn new(scenario: &Scenario, configuration: &Configuration) -> Self {
        Self {
            vehicle: SimulatedVehicle::new(scenario, configuration),
            sensors: Sensors::new(scenario),
            estimation: Estimation::new(scenario).map(Box::new),
            timing: scenario.timing,
        }
    }

    /// The vehicle itself.
    pub fn vehicle(&self) -> &SimulatedVehicle {
        &self.vehicle
    }

    /// The same, to be changed from outside.
    pub fn vehicle_mut(&mut self) -> &mut SimulatedVehicle {
        &mut self.vehicle
    }

    /// Its body, where it is the model's, the wrench acts on it at once and no instrument samples its motion between
    /// ticks.
    pub fn bare(&self) -> Option<&Plant> {
        if self.estimation.is_some() { None } else { self.vehicle.bare() }
    }

    /// What is known at this tick: once a tick. None where that is the truth.
    ///
    /// # Errors
    /// If the estimator has no state to fly on.
    #[inline]
    pub fn known(&mut self) -> Result<Option<Known>, NoEstimate> {
        if let Some(estimation) = &mut self.estimation {
            let (state, jumped) = estimation.state()?;
            return Ok(Some(Known { state, acceleration: estimation.sensed_force(), jumped }));
        }
        Ok(self.sensors.as_mut().map(|sensors| {
            let state = sensors.measure(self.vehicle.state());
            Known { state, acceleration: sensors.sensed_force(), jumped: false }
        }))
    }

    /// What is sensed at this tick beside what is known, after that, while `truth` is what happens.
    #[inline]
    pub fn sense(&mut self, truth: Sensed) -> Sensed {
        match (&mut self.estimation, &mut self.sensors) {
            (Some(estimation), _) => estimation.sense(&truth),
            (None, Some(sensors)) => sensors.sense(&truth),
            (None, None) => truth,
        }
    }

    /// The vehicle's motion until the next tick, under this `demand` on its actuators. Returns whether anything was
    /// cut, and the commanded rotor thrusts, N, as they stand at the end (none without rotors).
    ///
    /// # Errors
    /// If the demand cannot be applied, or the motion is no longer finite.
    #[inline]
    pub fn hold(&mut self, demand: &ActuatorDemand) -> Result<(bool, Thrusts), ActuationError> {
        let Timing { steps_per_tick, period_us, .. } = self.timing;
        let Some(estimation) = &mut self.estimation else {
            return self.vehicle.hold(demand, steps_per_tick);
        };
        let (samples, mut clipped, mut thrusts) = (estimation.samples(period_us), false, Thrusts::new());
        for _ in 0..samples {
            let (cut, arrived) = self.vehicle.hold(demand, steps_per_tick / samples)?;
            clipped |= cut;
            if !arrived.is_empty() {
                thrusts = arrived;
            }
            estimation.sample(self.vehicle.state());
        }
        Ok((clipped, thrusts))
    }
}
