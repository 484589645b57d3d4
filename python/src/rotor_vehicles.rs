//! One simulated vehicle under its rotors' commands, a plant step after another: for who emulates the flight controller
//! and its sensors, down to the pulses that motor controllers get.

use crate::errors::{failed, refused_field};
use crate::rows::{of_body, vector};
use crate::scenarios::Scenario;
use controller_core::allocation::Thrusts;
use host_sim::vehicle::SimulatedVehicle;
use host_sim::vehicle::actuators::ActuatorDemand;
use nalgebra::{UnitQuaternion, Vector3};
use numpy::PyArray1;
use pyo3::prelude::*;

/// The vehicle that a flight of the scenario simulates, under given thrusts of its rotors: their lag and limits, and
/// the ground where the scenario has any, are its own.
#[pyclass(module = "saturated_hybrid")]
pub struct RotorVehicle {
    scenario: Py<Scenario>,
    vehicle: SimulatedVehicle,
    rotors: usize,
    /// Mean of the last step, m/s^2, body.
    specific_force: Vector3<f64>,
}

#[pymethods]
impl RotorVehicle {
    #[new]
    fn new(scenario: &Bound<'_, Scenario>) -> PyResult<Self> {
        let Scenario { read, file, .. } = scenario.get();
        let Some(rotors) = read.configuration.rotors() else {
            return Err(refused_field(file, "rotors: must be there: their thrusts move this vehicle"));
        };
        let vehicle = SimulatedVehicle::new(read, &read.configuration);
        let gravity = Vector3::new(0.0, 0.0, f64::from(read.configuration.vehicle().gravity));
        let attitude = UnitQuaternion::new_normalize(vehicle.state().attitude);
        let specific_force = attitude.inverse_transform_vector(&gravity);
        Ok(Self { scenario: scenario.clone().unbind(), vehicle, rotors: rotors.len(), specific_force })
    }

    fn __copy__(&self, py: Python<'_>) -> Self {
        Self { scenario: self.scenario.clone_ref(py), vehicle: self.vehicle.clone(), ..*self }
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> Self {
        self.__copy__(py)
    }

    /// Holds the rotors' commanded thrusts (n,), N, for one plant step. `RuntimeError` where the motion is no longer
    /// finite.
    fn step(&mut self, py: Python<'_>, thrusts: &Bound<'_, PyAny>) -> PyResult<()> {
        let given = vector(thrusts, "thrusts")?;
        let count = self.rotors;
        if given.len() != count {
            return Err(refused_field("thrusts", format!("must have shape ({count},), found ({},)", given.len())));
        }
        if !given.iter().all(|thrust| (*thrust as f32).is_finite()) {
            return Err(refused_field("thrusts", "must be finite"));
        }
        let thrusts: Thrusts = given.iter().map(|thrust| *thrust as f32).collect();
        let (before, read) = (self.vehicle.state().velocity, &self.scenario.bind(py).get().read);
        self.vehicle.hold(&ActuatorDemand::Thrusts(thrusts), 1).map_err(failed)?;
        let state = self.vehicle.state();
        let gravity = Vector3::new(0.0, 0.0, f64::from(read.configuration.vehicle().gravity));
        let force = (state.velocity - before) / read.timing.step() + gravity;
        self.specific_force = UnitQuaternion::new_normalize(state.attitude).inverse_transform_vector(&force);
        Ok(())
    }

    /// (13,): the true one.
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, of_body(self.vehicle.state()).to_vec())
    }

    /// (n,): the rotors' thrusts at this moment, N, after their lag.
    #[getter]
    fn thrusts<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.vehicle.thrusts())
    }

    /// (3,): what an accelerometer in the origin feels, the mean of the last step, m/s^2, body.
    #[getter]
    fn specific_force<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.specific_force.iter().copied().collect())
    }

    /// Whether it stands on the ground.
    #[getter]
    fn stands(&self) -> bool {
        self.vehicle.stands()
    }
}
