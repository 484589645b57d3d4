//! The control law of a scenario: one vehicle, or rows of them.
//!
//! A step that is refused changes nothing, of rows none of them.

use crate::errors::{in_flight, refused, refused_field};
use crate::rows::{
    REFERENCE_COLUMNS, STATE_COLUMNS, WRENCH_COLUMNS, array, felt, measured, of_wrench, reference_of, row, rows,
    wrench, wrench_rows,
};
use crate::scenarios::Scenario;
use crate::threads::shared;
use crate::whole_number::Whole;
use controller_core::certificate::certified::Certified;
use controller_core::controller::Diagnostics;
use controller_core::law;
use controller_core::state::Wrench;
use host_sim::flight;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use scenario::timing::check_period;

/// Rows that one core takes at a time: fewer are not worth waking another for.
pub const ROWS_PER_TASK: usize = 256;
/// Rows of laws, or of vehicles: of these some 10 GB.
pub const ROWS_MAX: u64 = 1_000_000;

/// The control law of a scenario, as after a reset: the bits that boards fly.
///
/// What nothing certifies may be simulated too; `certified` says which it is.
#[pyclass(module = "saturated_hybrid")]
pub struct Law {
    scenario: Py<Scenario>,
    law: law::Law,
    certified: bool,
    diagnostics: Option<Diagnostics>,
}

#[pymethods]
impl Law {
    #[new]
    fn new(scenario: &Bound<'_, Scenario>) -> PyResult<Self> {
        let read = &scenario.get().read;
        let (configuration, period) = (&read.configuration, read.timing.period() as f32);
        let (law, certified) = match Certified::new(configuration.clone()) {
            Ok(certified) => (law::Law::new(&certified, period), true),
            Err(_) => (law::Law::uncertified(configuration, period), false),
        };
        Ok(Self { scenario: scenario.clone().unbind(), law: law.map_err(refused)?, certified, diagnostics: None })
    }

    /// Whether its commands are proven to stay within the limits.
    #[getter]
    fn certified(&self) -> bool {
        self.certified
    }

    /// Another law that remembers the same.
    fn copy(&self, py: Python<'_>) -> Self {
        Self { scenario: self.scenario.clone_ref(py), law: self.law.clone(), ..*self }
    }

    fn __copy__(&self, py: Python<'_>) -> Self {
        self.copy(py)
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> Self {
        self.copy(py)
    }

    fn __getnewargs__(&self, py: Python<'_>) -> PyResult<(Py<Scenario>,)> {
        let fresh = Self::new(self.scenario.bind(py))?;
        if self.law == fresh.law { Ok((self.scenario.clone_ref(py),)) } else { Err(in_flight("Law")) }
    }

    /// Everything forgotten: how a flight begins.
    fn reset(&mut self) {
        self.law.reset();
        self.diagnostics = None;
    }

    /// One control tick.
    ///
    /// Args:
    ///     state: (13,).
    ///     reference: (19,).
    ///     acceleration: (3,), since the last tick, by an accelerometer, m/s^2, world: the law's estimates then rest on
    ///         it. NaN, or left out: no accelerometer.
    ///
    /// Returns:
    ///     The wrench (4,), N and N m, not clipped to any limit. `for_rotors` says what to ask the rotors for.
    ///
    /// Raises:
    ///     ValueError: names the field that cannot be used; nothing has changed then.
    #[pyo3(signature = (state, reference, acceleration=None))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        state: &Bound<'py, PyAny>,
        reference: &Bound<'py, PyAny>,
        acceleration: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let (state, reference) =
            (row::<STATE_COLUMNS>(state, "state")?, row::<REFERENCE_COLUMNS>(reference, "reference")?);
        let acceleration = acceleration.map(|given| row::<3>(given, "acceleration")).transpose()?;
        let (wrench, diagnostics) = step(&mut self.law, &state, &reference, acceleration.as_ref()).map_err(refused)?;
        self.diagnostics = Some(diagnostics);
        Ok(PyArray1::from_slice(py, &of_wrench(&wrench)))
    }

    /// The rotors' command for a wrench (4,): the wrench over `thrust_scale`.
    fn for_rotors<'py>(&self, py: Python<'py>, asked: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let asked = wrench(&row::<WRENCH_COLUMNS>(asked, "wrench")?).map_err(refused)?;
        Ok(PyArray1::from_slice(py, &of_wrench(&for_rotors(&self.law, &asked))))
    }

    /// The time by which the next steps advance the filters, s, from 0.00025 to 0.1. It begins as the scenario's.
    fn set_period(&mut self, period: f64) -> PyResult<()> {
        check_period(period).map_err(|problem| refused_field("control.period", problem))?;
        self.law.set_period(period as f32).map_err(refused)
    }

    /// After a step whose wrench was clipped: nothing can be learnt from that motion.
    fn hold_estimates(&mut self) {
        self.law.hold_estimates();
    }

    /// What the rotors deliver of what is commanded, as far as the law knows; 1 under the paper's.
    #[getter]
    fn thrust_scale(&self) -> f32 {
        self.law.thrust_scale()
    }

    /// `force` (3,) m/s^2 world, `torque` (3,) N m body, `thrust_scale`; None under the paper's law.
    #[getter]
    fn estimates<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(estimates) = self.law.estimates() else { return Ok(None) };
        let named = PyDict::new(py);
        named.set_item("force", PyArray1::from_slice(py, estimates.force.as_slice()))?;
        named.set_item("torque", PyArray1::from_slice(py, estimates.torque.as_slice()))?;
        named.set_item("thrust_scale", estimates.scale)?;
        Ok(Some(named))
    }

    /// What the last step went through, float32: errors, filters and desired motion, each (3,), `desired_attitude` and
    /// `attitude_error` (4,), `lift_sign`. None after a reset.
    #[getter]
    fn diagnostics<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        self.diagnostics.as_ref().map(|diagnostics| named(py, diagnostics)).transpose()
    }
}

/// Diagnostics by their names.
pub fn named<'py>(py: Python<'py>, d: &Diagnostics) -> PyResult<Bound<'py, PyDict>> {
    let named = PyDict::new(py);
    for (name, vector) in [
        ("position_error", &d.position_error),
        ("velocity_error", &d.velocity_error),
        ("z_1", &d.z_1),
        ("z_2", &d.z_2),
        ("feedback", &d.feedback),
        ("filtered", &d.filtered),
        ("intermediate", &d.intermediate),
        ("acceleration_command", &d.acceleration_command),
        ("desired_angular_velocity", &d.desired_angular_velocity),
        ("desired_angular_acceleration", &d.desired_angular_acceleration),
        ("mrp", &d.mrp),
        ("angular_velocity_error", &d.angular_velocity_error),
        ("attitude_feedback", &d.attitude_feedback),
        ("rate_feedback", &d.rate_feedback),
    ] {
        named.set_item(name, PyArray1::from_slice(py, vector.as_slice()))?;
    }
    for (name, q) in [("desired_attitude", &d.desired_attitude), ("attitude_error", &d.attitude_error)] {
        named.set_item(name, PyArray1::from_slice(py, &[q.w, q.i, q.j, q.k]))?;
    }
    named.set_item("lift_sign", d.lift_sign)?;
    Ok(named)
}

/// The law of rows of vehicles, each with its own memory. Rows are shared out to all cores.
#[pyclass(module = "saturated_hybrid")]
pub struct LawRows {
    scenario: Py<Scenario>,
    reset: law::Law,
    laws: Vec<law::Law>,
}

#[pymethods]
impl LawRows {
    #[new]
    fn new(scenario: &Bound<'_, Scenario>, rows: Whole) -> PyResult<Self> {
        let rows = rows.within("rows", 0..=ROWS_MAX)? as usize;
        let reset = flight::law(&scenario.get().read).map_err(refused)?;
        Ok(Self { scenario: scenario.clone().unbind(), laws: vec![reset.clone(); rows], reset })
    }

    fn __copy__(&self, py: Python<'_>) -> Self {
        Self { scenario: self.scenario.clone_ref(py), reset: self.reset.clone(), laws: self.laws.clone() }
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> Self {
        self.__copy__(py)
    }

    fn __getnewargs__(&self, py: Python<'_>) -> PyResult<(Py<Scenario>, usize)> {
        let fresh = self.laws.iter().all(|law| *law == self.reset);
        if fresh { Ok((self.scenario.clone_ref(py), self.laws.len())) } else { Err(in_flight("LawRows")) }
    }

    fn __len__(&self) -> usize {
        self.laws.len()
    }

    /// Resets the rows that are chosen, (rows,) bool; all of them if none are given.
    #[pyo3(signature = (chosen=None))]
    fn reset(&mut self, chosen: Option<Vec<bool>>) -> PyResult<()> {
        for number in numbers(chosen, self.laws.len())? {
            self.laws[number] = self.reset.clone();
        }
        Ok(())
    }

    /// One tick of every row: states (rows, 13), references (rows, 19), and accelerations (rows, 3) as of `Law.step`,
    /// to wrenches (rows, 4).
    ///
    /// If one is refused, the error names the row and no row has changed.
    #[pyo3(signature = (states, references, accelerations=None))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        states: &Bound<'py, PyAny>,
        references: &Bound<'py, PyAny>,
        accelerations: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let count = self.laws.len();
        let states = rows::<STATE_COLUMNS>(states, count, "states")?;
        let references = rows::<REFERENCE_COLUMNS>(references, count, "references")?;
        let accelerations = accelerations.map(|given| rows::<3>(given, count, "accelerations")).transpose()?;
        let (laws, wrenches) = step_rows(py, &self.laws, |law, number| {
            let acceleration = accelerations.as_ref().and_then(|accelerations| accelerations.get(number));
            step(law, &states[number], &references[number], acceleration).map(|(wrench, _)| of_wrench(&wrench))
        })?;
        self.laws = laws;
        array(py, wrenches)
    }

    /// As `Law.hold_estimates`, of the rows that are chosen.
    #[pyo3(signature = (chosen=None))]
    fn hold_estimates(&mut self, chosen: Option<Vec<bool>>) -> PyResult<()> {
        for number in numbers(chosen, self.laws.len())? {
            self.laws[number].hold_estimates();
        }
        Ok(())
    }

    /// As `Law.for_rotors`, of every row: (rows, 4).
    fn for_rotors<'py>(&self, py: Python<'py>, wrenches: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let wrenches = wrench_rows(wrenches, self.laws.len())?;
        let asked = self.laws.iter().zip(&wrenches).map(|(law, wrench)| of_wrench(&for_rotors(law, wrench)));
        array(py, asked.collect())
    }

    /// (rows,).
    #[getter]
    fn thrust_scale<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_vec(py, self.laws.iter().map(law::Law::thrust_scale).collect())
    }
}

/// Steps every row, on all cores: the rows after it, and their wrenches.
///
/// # Errors
/// Names a row whose step is refused.
pub fn step_rows<R: Clone + Send + Sync>(
    py: Python<'_>,
    rows: &[R],
    step: impl Fn(&mut R, usize) -> Result<[f32; WRENCH_COLUMNS], String> + Send + Sync,
) -> PyResult<(Vec<R>, Vec<[f32; WRENCH_COLUMNS]>)> {
    let one = |(number, row): (usize, &R)| {
        let mut row = row.clone();
        let wrench = step(&mut row, number).map_err(|error| format!("row {number}: {error}"))?;
        Ok((row, wrench))
    };
    let stepped: PyResult<Result<Vec<_>, String>> = py.detach(|| {
        let all = || rows.par_iter().enumerate().with_min_len(ROWS_PER_TASK).map(one).collect();
        if rows.len() > ROWS_PER_TASK { shared(all) } else { Ok(all()) }
    });
    Ok(stepped?.map_err(refused)?.into_iter().unzip())
}

/// The rotors' command, as in flights and on boards.
pub fn for_rotors(law: &law::Law, wrench: &Wrench) -> Wrench {
    wrench.scaled(1.0 / law.thrust_scale())
}

/// The numbers of the rows that are chosen: all of them, where none are.
///
/// # Errors
/// If there are more or fewer rows.
pub fn numbers(chosen: Option<Vec<bool>>, count: usize) -> PyResult<Vec<usize>> {
    let chosen = chosen.unwrap_or_else(|| vec![true; count]);
    if chosen.len() == count {
        Ok((0..count).filter(|number| chosen[*number]).collect())
    } else {
        Err(refused_field("chosen", format!("must have shape ({count},), found ({},)", chosen.len())))
    }
}

fn step(
    law: &mut law::Law,
    state: &[f64; STATE_COLUMNS],
    reference: &[f64; REFERENCE_COLUMNS],
    acceleration: Option<&[f64; 3]>,
) -> Result<(Wrench, Diagnostics), String> {
    let reference = reference_of(reference).map_err(|error| format!("reference.{error}"))?;
    if let Some(acceleration) = acceleration {
        law.measured(&felt(acceleration));
    }
    law.step(&measured(state), &reference).map_err(|error| error.to_string())
}
