//! The shield of a scenario, one vehicle or rows of them: demands in, wrenches out.
//!
//! A step that is refused changes nothing, of rows none of them. No demand is refused that has the right shape: one
//! that cannot be used hands over to the law.

use crate::errors::{in_flight, refused};
use crate::laws::{ROWS_MAX, for_rotors, named, numbers, step_rows};
use crate::rows::{
    REFERENCE_COLUMNS, STATE_COLUMNS, WRENCH_COLUMNS, array, demand_row, demand_rows, measured, of_reference,
    of_rotors, of_wrench, row, rows, wrench, wrench_rows,
};
use crate::scenarios::Scenario;
use crate::shield_arguments::ShieldArguments;
use crate::shield_row::{ShieldRow, both};
use crate::whole_number::Whole;
use controller_core::controller::Diagnostics;
use host_sim::flight::estimation::velocity_late;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The extended law flying what a policy demands, within its limits, and taking over while it must.
///
/// docs/shield.md has the rules. It starts as before a flight; nothing that a policy demands is an error.
///
/// Args:
///     scenario: of the extended law.
///     low, high: corners (3,) of the box to stay in, m, world; or (n, 3) of up to four boxes: it stays in one or
///         another of them, and goes over where they overlap.
///     margin: how far inside its boxes it is kept, m: as far as an estimated place may be from the true one.
///     late: how late the velocity of states is where the acceleration has just changed, s; left out: 0.012 of a
///         scenario with `[estimator]`, zero of any other.
///     speed: the greatest speed of the policy, m/s.
///     silence: for how long the last demand is flown if none comes, s.
///     patience: how long the vehicle rests at its refuge before the policy gets it back, s; twice as long each time.
///     patience_greatest: the longest such time, s.
///     hand_overs: after so many the law keeps the vehicle, until `ask_again` or `reset`.
#[pyclass(module = "saturated_hybrid")]
pub struct Shield {
    scenario: Py<Scenario>,
    arguments: ShieldArguments,
    start: ShieldRow,
    one: ShieldRow,
    diagnostics: Option<Diagnostics>,
}

#[pymethods]
impl Shield {
    #[new]
    #[pyo3(signature = (scenario, *, low, high, margin=0.0, late=None, speed=10.0, silence=0.1, patience=1.0,
        patience_greatest=16.0, hand_overs=Whole::new(10)),
        text_signature = "(scenario, *, low, high, margin=0.0, late=None, speed=10.0, silence=0.1, patience=1.0, \
patience_greatest=16.0, hand_overs=10)")]
    #[allow(clippy::too_many_arguments)] // its user names them
    fn new(
        scenario: &Bound<'_, Scenario>,
        low: &Bound<'_, PyAny>,
        high: &Bound<'_, PyAny>,
        margin: f64,
        late: Option<f64>,
        speed: f64,
        silence: f64,
        patience: f64,
        patience_greatest: f64,
        hand_overs: Whole,
    ) -> PyResult<Self> {
        let late = late.unwrap_or_else(|| velocity_late(&scenario.get().read).into());
        let numbers = [margin, late, speed, silence, patience, patience_greatest];
        let arguments = ShieldArguments::new(low, high, numbers, hand_overs)?;
        let start = ShieldRow::new(scenario.get(), &arguments.settings())?;
        Ok(Self { scenario: scenario.clone().unbind(), arguments, one: start.clone(), start, diagnostics: None })
    }

    /// Another shield that remembers the same.
    fn copy(&self, py: Python<'_>) -> Self {
        Self {
            scenario: self.scenario.clone_ref(py),
            arguments: self.arguments.clone(),
            start: self.start.clone(),
            one: self.one.clone(),
            diagnostics: self.diagnostics,
        }
    }

    fn __copy__(&self, py: Python<'_>) -> Self {
        self.copy(py)
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> Self {
        self.copy(py)
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((Py<Scenario>,), Bound<'py, PyDict>)> {
        let fresh = self.one.is_as(&self.start);
        if fresh { Ok(((self.scenario.clone_ref(py),), self.arguments.named(py)?)) } else { Err(in_flight("Shield")) }
    }

    /// As before a flight, law included.
    fn reset(&mut self) {
        self.one = self.start.clone();
        self.diagnostics = None;
    }

    /// Counts hand-overs anew: the policy may fly again.
    fn ask_again(&mut self) {
        self.one.shield.request_again();
    }

    /// One control tick.
    ///
    /// Args:
    ///     state: (13,).
    ///     demand: (4,) or (5,), or None where the policy says nothing.
    ///     acceleration: (3,), as of `Law.step`.
    ///     rotors: (4,) in place of a demand: speeds of the rotors of an X, from -1, the least, to 1, the greatest.
    ///
    /// Returns:
    ///     The wrench (4,), as of `Law.step`.
    ///
    /// Raises:
    ///     ValueError: names the field of the state that cannot be used; nothing has changed then.
    #[pyo3(signature = (state, demand=None, acceleration=None, *, rotors=None))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        state: &Bound<'py, PyAny>,
        demand: Option<&Bound<'py, PyAny>>,
        acceleration: Option<&Bound<'py, PyAny>>,
        rotors: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let state = measured(&row::<STATE_COLUMNS>(state, "state")?);
        let demand = match (demand, rotors) {
            (Some(_), Some(_)) => return Err(both()),
            (None, Some(rotors)) => Some(of_rotors(&self.one.of_an_x(row::<4>(rotors, "rotors")?)?)),
            (demand, None) => demand.map(|demand| demand_row(demand, "demand")).transpose()?,
        };
        let acceleration = acceleration.map(|given| row::<3>(given, "acceleration")).transpose()?;
        let mut next = self.one.clone();
        let (wrench, diagnostics) = next.step(&state, demand.as_ref(), acceleration.as_ref()).map_err(refused)?;
        (self.one, self.diagnostics) = (next, Some(diagnostics));
        Ok(PyArray1::from_slice(py, &wrench))
    }

    /// Whether the policy flew the last step.
    #[getter]
    fn by_policy(&self) -> bool {
        self.one.by_policy()
    }

    /// Why the law flew it: "silent", "demand", "stop", "speed", "tilt", "rate" or "estimate"; "" where it did not.
    #[getter]
    fn reason(&self) -> &'static str {
        self.one.reason()
    }

    /// How often the law took over since the reset, or since `ask_again`.
    #[getter]
    fn hand_overs(&self) -> u32 {
        self.one.shield.hand_overs()
    }

    /// (4,): the speeds that the rotors were told last, whoever flew, as `step` takes them; zeros for a vehicle that is
    /// no X.
    #[getter]
    fn rotors<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, &self.one.rotors())
    }

    /// The reference (19,), at rest: where the law flies to, or would if it took over now.
    #[getter]
    fn reference<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, &of_reference(&self.one.reference))
    }

    /// As `Law.for_rotors`.
    fn for_rotors<'py>(&self, py: Python<'py>, asked: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let asked = wrench(&row::<WRENCH_COLUMNS>(asked, "wrench")?).map_err(refused)?;
        Ok(PyArray1::from_slice(py, &of_wrench(&for_rotors(&self.one.law, &asked))))
    }

    /// As `Law.hold_estimates`.
    fn hold_estimates(&mut self) {
        self.one.law.hold_estimates();
    }

    /// As `Law.thrust_scale`.
    #[getter]
    fn thrust_scale(&self) -> f32 {
        self.one.law.thrust_scale()
    }

    /// As `Law.diagnostics`, with errors from `reference`.
    #[getter]
    fn diagnostics<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        self.diagnostics.as_ref().map(|diagnostics| named(py, diagnostics)).transpose()
    }
}

/// The shields of rows of vehicles, each with its own memory. Rows are shared out to all cores.
///
/// Arguments as of `Shield`.
#[pyclass(module = "saturated_hybrid")]
pub struct ShieldRows {
    scenario: Py<Scenario>,
    arguments: ShieldArguments,
    start: ShieldRow,
    ones: Vec<ShieldRow>,
}

#[pymethods]
impl ShieldRows {
    #[new]
    #[pyo3(signature = (scenario, rows, *, low, high, margin=0.0, late=None, speed=10.0, silence=0.1, patience=1.0,
        patience_greatest=16.0, hand_overs=Whole::new(10)),
        text_signature = "(scenario, rows, *, low, high, margin=0.0, late=None, speed=10.0, silence=0.1, patience=1.0, \
patience_greatest=16.0, hand_overs=10)")]
    #[allow(clippy::too_many_arguments)] // its user names them
    fn new(
        scenario: &Bound<'_, Scenario>,
        rows: Whole,
        low: &Bound<'_, PyAny>,
        high: &Bound<'_, PyAny>,
        margin: f64,
        late: Option<f64>,
        speed: f64,
        silence: f64,
        patience: f64,
        patience_greatest: f64,
        hand_overs: Whole,
    ) -> PyResult<Self> {
        let rows = rows.within("rows", 0..=ROWS_MAX)? as usize;
        let Shield { scenario, arguments, start, .. } =
            Shield::new(scenario, low, high, margin, late, speed, silence, patience, patience_greatest, hand_overs)?;
        Ok(Self { scenario, arguments, ones: vec![start.clone(); rows], start })
    }

    fn __copy__(&self, py: Python<'_>) -> Self {
        Self {
            scenario: self.scenario.clone_ref(py),
            arguments: self.arguments.clone(),
            start: self.start.clone(),
            ones: self.ones.clone(),
        }
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> Self {
        self.__copy__(py)
    }

    #[allow(clippy::type_complexity)] // what pickle asks for
    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((Py<Scenario>, usize), Bound<'py, PyDict>)> {
        if !self.ones.iter().all(|one| one.is_as(&self.start)) {
            return Err(in_flight("ShieldRows"));
        }
        Ok(((self.scenario.clone_ref(py), self.ones.len()), self.arguments.named(py)?))
    }

    fn __len__(&self) -> usize {
        self.ones.len()
    }

    /// Resets the rows that are chosen, (rows,) bool; all of them if none are given.
    #[pyo3(signature = (chosen=None))]
    fn reset(&mut self, chosen: Option<Vec<bool>>) -> PyResult<()> {
        for number in numbers(chosen, self.ones.len())? {
            self.ones[number] = self.start.clone();
        }
        Ok(())
    }

    /// As `Shield.ask_again`, of the rows that are chosen.
    #[pyo3(signature = (chosen=None))]
    fn ask_again(&mut self, chosen: Option<Vec<bool>>) -> PyResult<()> {
        for number in numbers(chosen, self.ones.len())? {
            self.ones[number].shield.request_again();
        }
        Ok(())
    }

    /// One tick of every row: states (rows, 13), demands (rows, 4) or (rows, 5), or None where no policy says anything,
    /// and accelerations (rows, 3) as of `Law.step`, to wrenches (rows, 4). `rotors` (rows, 4) in place of demands are
    /// speeds of the rotors of an X, from -1, the least, to 1, the greatest.
    ///
    /// If a state is refused, the error names the row and no row has changed.
    #[pyo3(signature = (states, demands=None, accelerations=None, *, rotors=None))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        states: &Bound<'py, PyAny>,
        demands: Option<&Bound<'py, PyAny>>,
        accelerations: Option<&Bound<'py, PyAny>>,
        rotors: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let count = self.ones.len();
        let states = rows::<STATE_COLUMNS>(states, count, "states")?;
        let demands = match (demands, rotors) {
            (Some(_), Some(_)) => return Err(both()),
            (None, Some(given)) => {
                let given = self.start.of_an_x(rows::<4>(given, count, "rotors")?)?;
                Some(given.iter().map(of_rotors).collect())
            }
            (demands, None) => demands.map(|demands| demand_rows(demands, count, "demands")).transpose()?,
        };
        let accelerations = accelerations.map(|given| rows::<3>(given, count, "accelerations")).transpose()?;
        let (ones, wrenches) = step_rows(py, &self.ones, |one, number| {
            let demand = demands.as_ref().and_then(|demands| demands.get(number));
            let acceleration = accelerations.as_ref().and_then(|accelerations| accelerations.get(number));
            one.step(&measured(&states[number]), demand, acceleration).map(|(wrench, _)| wrench)
        })?;
        self.ones = ones;
        array(py, wrenches)
    }

    /// (rows,) bool: whether the policy flew the last step.
    #[getter]
    fn by_policy<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_vec(py, self.ones.iter().map(ShieldRow::by_policy).collect())
    }

    /// As `Shield.reason`, of every row.
    #[getter]
    fn reasons(&self) -> Vec<&'static str> {
        self.ones.iter().map(ShieldRow::reason).collect()
    }

    /// (rows,): as `Shield.hand_overs`.
    #[getter]
    fn hand_overs<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_vec(py, self.ones.iter().map(|one| one.shield.hand_overs()).collect())
    }

    /// (rows, 4): as `Shield.rotors`.
    #[getter]
    fn rotors<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        array(py, self.ones.iter_mut().map(ShieldRow::rotors).collect())
    }

    /// (rows, 19): as `Shield.reference`.
    #[getter]
    fn references<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let references: Vec<[f32; REFERENCE_COLUMNS]> =
            self.ones.iter().map(|one| of_reference(&one.reference)).collect();
        array(py, references)
    }

    /// As `Law.hold_estimates`, of the rows that are chosen.
    #[pyo3(signature = (chosen=None))]
    fn hold_estimates(&mut self, chosen: Option<Vec<bool>>) -> PyResult<()> {
        for number in numbers(chosen, self.ones.len())? {
            self.ones[number].law.hold_estimates();
        }
        Ok(())
    }

    /// As `Law.for_rotors`, of every row: (rows, 4).
    fn for_rotors<'py>(&self, py: Python<'py>, wrenches: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let wrenches = wrench_rows(wrenches, self.ones.len())?;
        let asked = self.ones.iter().zip(&wrenches).map(|(one, wrench)| of_wrench(&for_rotors(&one.law, wrench)));
        array(py, asked.collect())
    }

    /// (rows,).
    #[getter]
    fn thrust_scale<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_vec(py, self.ones.iter().map(|one| one.law.thrust_scale()).collect())
    }
}
