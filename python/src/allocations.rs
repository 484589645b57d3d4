//! From a wrench to the rotors: the core's mixer, as boards fly it.

use crate::errors::{refused, refused_field};
use crate::rows::{WRENCH_COLUMNS, row, wrench};
use crate::scenarios::Scenario;
use controller_core::allocation::{Mixer, Rotors};
use numpy::PyArray1;
use pyo3::prelude::*;

/// From a wrench to the rotors' thrusts: what cannot be had is given up, yaw first, then thrust, roll and pitch last.
#[pyclass(frozen, module = "saturated_hybrid")]
pub struct Allocation {
    rotors: Rotors,
    mixer: Box<Mixer>,
}

#[pymethods]
impl Allocation {
    #[new]
    fn new(scenario: &Scenario) -> PyResult<Self> {
        let lacking = || refused_field(&scenario.file, "rotors: the scenario has no such section; add one");
        let rotors = scenario.read.configuration.rotors().ok_or_else(lacking)?;
        Ok(Self { rotors: rotors.clone(), mixer: Box::new(Mixer::new(rotors)) })
    }

    fn __len__(&self) -> usize {
        self.rotors.len()
    }

    /// Thrusts (n,), N, each within its rotor's range, for a wrench (4,); and whether anything of it was given up.
    #[allow(clippy::type_complexity)] // a tuple is what Python unpacks
    fn thrusts<'py>(&self, py: Python<'py>, asked: &Bound<'py, PyAny>) -> PyResult<(Bound<'py, PyArray1<f32>>, bool)> {
        let asked = wrench(&row::<WRENCH_COLUMNS>(asked, "wrench")?).map_err(refused)?;
        let allocation = self.mixer.allocate(&asked).map_err(refused)?;
        Ok((PyArray1::from_slice(py, &allocation.thrusts), !allocation.is_exact()))
    }

    /// Rotor speeds (n,), rad/s, for thrusts (n,), N.
    fn speeds<'py>(&self, py: Python<'py>, thrusts: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let thrusts = crate::rows::vector(thrusts, "thrusts")?;
        if thrusts.len() != self.rotors.len() {
            let count = self.rotors.len();
            return Err(refused_field("thrusts", format!("must have shape ({count},), found ({},)", thrusts.len())));
        }
        if let Some(thrust) = thrusts.iter().find(|thrust| !(**thrust >= 0.0 && (**thrust as f32).is_finite())) {
            return Err(refused_field("thrusts", format!("must be finite and not below zero, found {thrust}")));
        }
        let speeds = self.rotors.iter().zip(&thrusts).map(|(rotor, thrust)| rotor.speed_at(*thrust as f32));
        Ok(PyArray1::from_vec(py, speeds.collect()))
    }
}
