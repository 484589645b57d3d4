//! A small network as a policy: the bits that boards fly.

use crate::errors::{refused, refused_field};
use crate::rows::{STATE_COLUMNS, array, measured, rows, wide_rows};
use crate::whole_number::Whole;
use controller_core::heading::Heading;
use controller_core::shield::network::{INPUT_COUNT, Interface, MEMORY_MAX, Memory, OUTPUT_COUNT};
use controller_core::shield::{Demand, Observation};
use nalgebra::{Vector2, Vector3};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use scenario::policy::PolicyFile;
use std::path::PathBuf;

/// The inputs and outputs of hover.toml and its like; the scale does not count for inputs.
const ACCELERATION: Interface = Interface::Acceleration { scale: [1.0; OUTPUT_COUNT] };

/// The rows of a network: its outputs, and what it remembers afterwards.
type Advanced = (Vec<[f32; OUTPUT_COUNT]>, Vec<f32>);

/// A network that decides on an acceleration and a yaw rate, or on the speeds of an X's rotors, from a file as
/// docs/shield.md has it.
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

    /// (4,): what multiplies the outputs, m/s^2 three times and rad/s; None where they are speeds of rotors.
    #[getter]
    fn scale<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f32>>> {
        match &self.0.interface {
            Interface::Acceleration { scale } => Some(PyArray1::from_slice(py, scale)),
            Interface::Rotors { .. } => None,
        }
    }

    /// What it demands: "acceleration" or "rotors".
    #[getter]
    fn demanded(&self) -> &'static str {
        match self.0.interface {
            Interface::Acceleration { .. } => "acceleration",
            Interface::Rotors { .. } => "rotors",
        }
    }

    /// The time between two of its steps, s; None if any will do.
    #[getter]
    fn period(&self) -> Option<f32> {
        self.0.period
    }

    /// (rows, m) float32: what a network of recurrent layers remembers at first; m is zero for the others.
    fn memory<'py>(&self, py: Python<'py>, rows: Whole) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let rows = rows.within("rows", 0..=crate::laws::ROWS_MAX)? as usize;
        self.0.with(|network| {
            let network = network.map_err(refused)?;
            let count = network.remembered();
            let one: Vec<f32> = network.fresh().values.into_iter().take(count).collect();
            PyArray1::from_vec(py, one.repeat(rows)).reshape([rows, count])
        })
    }

    /// The inputs (n, 22), float32, of this network for states (n, 13), goals (n, 3), m, world, headings (n, 2), unit
    /// vectors, and what came last (n, 4): its outputs, zeros at first; or, where it demands speeds of rotors, the ones
    /// that flew, `ShieldRows.rotors`.
    fn inputs<'py>(
        &self,
        py: Python<'py>,
        states: &Bound<'py, PyAny>,
        goals: &Bound<'py, PyAny>,
        headings: &Bound<'py, PyAny>,
        last: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        observed(py, &self.0.interface, states, goals, headings, (last, "last"))
    }

    /// The outputs (n, 4) and memories (n, m), float32, for inputs (n, 22) and memories (n, m): of a network with
    /// recurrent layers, or of any other with m zero. Outputs that demand speeds may be beyond -1 and 1.
    #[allow(clippy::type_complexity)] // a tuple is what Python unpacks
    fn advance<'py>(
        &self,
        py: Python<'py>,
        observations: &Bound<'py, PyAny>,
        memories: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyArray2<f32>>, Bound<'py, PyArray2<f32>>)> {
        let rows = rows::<INPUT_COUNT>(observations, length(observations, "observations")?, "observations")?;
        let remembered = self.remembered()?;
        let given = wide_rows(memories, rows.len(), remembered, "memories")?;
        let (outputs, memories) = self.advanced(&rows, &given, remembered)?;
        let count = rows.len();
        Ok((array(py, outputs)?, PyArray1::from_vec(py, memories).reshape([count, remembered])?))
    }

    /// The inputs (n, 22), float32, for states (n, 13), goals (n, 3), m, world, headings (n, 2), unit vectors, and the
    /// last outputs (n, 4), zeros at first, of a network that demands accelerations. `ShieldRows.references[:, 15:17]`
    /// are the headings of a flight.
    #[staticmethod]
    fn observe<'py>(
        py: Python<'py>,
        states: &Bound<'py, PyAny>,
        goals: &Bound<'py, PyAny>,
        headings: &Bound<'py, PyAny>,
        outputs: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        observed(py, &ACCELERATION, states, goals, headings, (outputs, "outputs"))
    }

    /// The outputs (n, 4), float32, for inputs (n, 22). A network with recurrent layers wants `advance`.
    fn act<'py>(&self, py: Python<'py>, observations: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let observations = rows::<INPUT_COUNT>(observations, length(observations, "observations")?, "observations")?;
        if self.remembered()? > 0 {
            return Err(refused_field("network", "has recurrent layers: `advance` takes what they remember"));
        }
        array(py, self.advanced(&observations, &[], 0)?.0)
    }

    /// The demands (n, 4), float32, for outputs (n, 4) and headings (n, 2): accelerations in the world and yaw rates;
    /// or speeds, for `ShieldRows.step(…, rotors=…)`.
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
                match demand {
                    Demand::Acceleration { acceleration: a, yaw_rate } => [a.x, a.y, a.z, yaw_rate],
                    Demand::Rotors { speeds } => speeds,
                    // No network demands one.
                    Demand::Attitude { .. } => [f32::NAN; OUTPUT_COUNT],
                }
            };
            Ok::<_, PyErr>(outputs.iter().zip(&headings).map(of).collect())
        });
        array(py, demands?)
    }
}

impl Network {
    /// The number of values that it remembers.
    fn remembered(&self) -> PyResult<usize> {
        self.0.with(|network| Ok(network.map_err(refused)?.remembered()))
    }

    /// Outputs and memories of rows of inputs, with so many values of memory each.
    fn advanced(&self, rows: &[[f64; INPUT_COUNT]], memories: &[f64], remembered: usize) -> PyResult<Advanced> {
        self.0.with(|network| {
            let network = network.map_err(refused)?;
            let mut left = Vec::with_capacity(memories.len());
            let outputs = rows.iter().enumerate().map(|(number, inputs)| {
                let mut memory = Memory { values: [0.0; MEMORY_MAX] };
                let given = memories.iter().skip(number * remembered).take(remembered);
                memory.values.iter_mut().zip(given).for_each(|(value, given)| *value = *given as f32);
                let outputs = network.outputs(&inputs.map(|input| input as f32), &mut memory);
                left.extend_from_slice(&memory.values[..remembered]);
                outputs
            });
            Ok((outputs.collect(), left))
        })
    }
}

/// The inputs of a layout, for states, goals, headings and what came last, with its name.
fn observed<'py>(
    py: Python<'py>,
    interface: &Interface,
    states: &Bound<'py, PyAny>,
    goals: &Bound<'py, PyAny>,
    headings: &Bound<'py, PyAny>,
    (last, name): (&Bound<'py, PyAny>, &str),
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let count = length(states, "states")?;
    let states = rows::<STATE_COLUMNS>(states, count, "states")?;
    let goals = rows::<3>(goals, count, "goals")?;
    let headings = directions(headings, count)?;
    let last = rows::<OUTPUT_COUNT>(last, count, name)?;
    let observed = states.iter().zip(&goals).zip(&headings).zip(&last).map(|(((state, goal), heading), last)| {
        let goal = Vector3::from(*goal).map(|place| place as f32);
        let last = last.map(|value| value as f32);
        let observation = Observation { state: measured(state), goal, heading: *heading, rotors: last };
        interface.inputs(&observation, &last)
    });
    array(py, observed.collect())
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
