//! A small network as a policy: the bits that boards fly.

use crate::errors::{refused, refused_field};
use crate::rows::{STATE_COLUMNS, array, measured, rows};
use controller_core::heading::Heading;
use controller_core::shield::network::{self, INPUT_COUNT, OUTPUT_COUNT};
use controller_core::shield::{Demand, Observation};
use nalgebra::{Vector2, Vector3};
use numpy::{PyArray1, PyArray2, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use scenario::policy::PolicyFile;
use std::path::PathBuf;

/// A network that decides on an acceleration and a yaw rate, from a file as docs/shield.md has it.
#[pyclass(module = "saturated_hybrid", frozen)]
pub struct Network(PolicyFile);

#[pymethods]
impl Network {
    /// Reads a TOML file. `ValueError` names the file, the field and the reason.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        let file = path.display().to_string();
        let text = scenario::text::read(&path).map_err(|error| refused_field(&file, error))?;
        Self::parse(&text, &file)
    }

    /// Reads TOML text, which errors call `file`.
    #[staticmethod]
    #[pyo3(signature = (text, file="policy"))]
    fn parse(text: &str, file: &str) -> PyResult<Self> {
        PolicyFile::parse(text, file).map(Self).map_err(refused)
    }

    /// (4,): what the outputs are multiplied by, m/s^2 three times and rad/s.
    #[getter]
    fn scale<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, &self.0.scale)
    }

    /// The inputs (n, 22), float32, for states (n, 13), goals (n, 3), m, world, headings (n, 2), unit vectors, and the
    /// last outputs (n, 4), zeros at first. `ShieldRows.references[:, 15:17]` are the headings of a flight.
    #[staticmethod]
    fn observe<'py>(
        py: Python<'py>,
        states: &Bound<'py, PyAny>,
        goals: &Bound<'py, PyAny>,
        headings: &Bound<'py, PyAny>,
        outputs: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let count = length(states, "states")?;
        let states = rows::<STATE_COLUMNS>(states, count, "states")?;
        let goals = rows::<3>(goals, count, "goals")?;
        let headings = directions(headings, count)?;
        let last = rows::<OUTPUT_COUNT>(outputs, count, "outputs")?;
        let observed = states.iter().zip(&goals).zip(&headings).zip(&last).map(|(((state, goal), heading), last)| {
            let goal = Vector3::from(*goal).map(|place| place as f32);
            let observation = Observation { state: measured(state), goal, heading: *heading };
            network::inputs(&observation, &last.map(|output| output as f32))
        });
        array(py, observed.collect())
    }

    /// The outputs (n, 4), float32, from -1 to 1, for inputs (n, 22).
    fn act<'py>(&self, py: Python<'py>, observations: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let observations = rows::<INPUT_COUNT>(observations, length(observations, "observations")?, "observations")?;
        let outputs = self.0.with(|network| {
            let network = network.map_err(refused)?;
            let of = |inputs: &[f64; INPUT_COUNT]| network.outputs(&inputs.map(|input| input as f32));
            Ok::<_, PyErr>(observations.iter().map(of).collect())
        });
        array(py, outputs?)
    }

    /// The demands (n, 4), float32, for outputs (n, 4) and headings (n, 2): accelerations in the world and yaw rates.
    fn demands<'py>(
        &self,
        py: Python<'py>,
        outputs: &Bound<'py, PyAny>,
        headings: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let count = length(outputs, "outputs")?;
        let outputs = rows::<OUTPUT_COUNT>(outputs, count, "outputs")?;
        let headings = directions(headings, count)?;
        let demands = self.0.with(|network| {
            let network = network.map_err(refused)?;
            let of = |(outputs, heading): (&[f64; OUTPUT_COUNT], &Heading)| {
                let demand = network.demand(&outputs.map(|output| output as f32), heading);
                let Demand::Acceleration { acceleration: a, yaw_rate } = demand else {
                    return [f32::NAN; OUTPUT_COUNT];
                };
                [a.x, a.y, a.z, yaw_rate]
            };
            Ok::<_, PyErr>(outputs.iter().zip(&headings).map(of).collect())
        });
        array(py, demands?)
    }
}

/// The number of rows of an array.
fn length(given: &Bound<'_, PyAny>, field: &str) -> PyResult<usize> {
    match given.cast::<PyUntypedArray>() {
        Ok(array) => Ok(array.shape().first().copied().unwrap_or(0)),
        Err(_) => given.len().map_err(|_| refused_field(field, "must be an array of rows")),
    }
}

fn directions(given: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<Heading>> {
    let heading = |(number, [x, y]): (usize, &[f64; 2])| {
        let direction = Vector2::new(*x as f32, *y as f32);
        let heading = Heading::restored(direction, 0.0, 0.0).or_else(|_| Heading::new(direction, 0.0, 0.0));
        heading.map_err(|error| refused(format!("row {number}: headings: {}", error.reason)))
    };
    rows::<2>(given, count, "headings")?.iter().enumerate().map(heading).collect()
}
