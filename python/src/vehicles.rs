//! Rows of simulated vehicles under given wrenches, for environments.
//!
//! Each row is the vehicle that a flight of the scenario simulates, with its own clock, and its own sensors or
//! estimator where the scenario has any. A row whose motion is no longer finite, or whose estimator has no state to fly
//! on, goes no further until it is put somewhere.
//!
//! Where nothing stands between wrench and body, the bodies of a stretch of rows move together in the processor's
//! vector registers ([`host_sim::vehicle::plant::rows`]), to the bits that each has alone.

use crate::errors::{in_flight, refused, refused_field};
use crate::laws::{ROWS_MAX, numbers};
use crate::rows::{STATE_COLUMNS, array, body, of_body, of_measured, of_reference, rows, wrench_rows};
use crate::scenarios::Scenario;
use crate::threads::shared;
use crate::whole_number::Whole;
use controller_core::state::Wrench;
use host_sim::flight::estimation::NoEstimate;
use host_sim::flight::sensed_vehicle::{Known, SensedVehicle};
use host_sim::vehicle::actuators::ActuatorDemand;
use host_sim::vehicle::plant::body::Body;
use host_sim::vehicle::plant::rows::Rows;
use numpy::{PyArray1, PyArray2};
use pulp::Arch;
use pyo3::prelude::*;
use rayon::prelude::*;
use scenario::body::{BodyState, ROTATION_PER_STEP_MAX_RAD};

/// Rows of a stretch.
const ROWS_PER_TASK: usize = 16;

/// One vehicle.
#[derive(Clone)]
struct Row {
    vehicle: SensedVehicle,
    /// The measured or estimated state now.
    measured: [f64; STATE_COLUMNS],
    /// v' since the last tick, m/s^2, world; NaN without an accelerometer.
    acceleration: [f64; 3],
    /// Whether the estimate has jumped since the last tick.
    jumped: bool,
    tick: u64,
    lost: bool,
}

impl Row {
    fn new(scenario: &scenario::Scenario) -> Result<Self, NoEstimate> {
        let vehicle = SensedVehicle::new(scenario, &scenario.configuration);
        let (measured, acceleration) = ([0.0; STATE_COLUMNS], [f64::NAN; 3]);
        let mut row = Self { vehicle, measured, acceleration, jumped: false, tick: 0, lost: false };
        row.measure()?;
        Ok(row)
    }

    fn state(&self) -> &BodyState {
        self.vehicle.vehicle().state()
    }

    fn measure(&mut self) -> Result<(), NoEstimate> {
        (self.measured, self.acceleration, self.jumped) = match self.vehicle.known()? {
            Some(Known { state, acceleration, jumped }) => {
                let felt = acceleration.map_or([f64::NAN; 3], |felt| felt.cast().into());
                (of_measured(&state), felt, jumped)
            }
            None => (of_body(self.state()), [f64::NAN; 3], false),
        };
        Ok(())
    }

    /// Whether anything was clipped.
    fn hold(&mut self, wrench: &Wrench) -> bool {
        if self.lost {
            return false;
        }
        let held = self.vehicle.hold(&ActuatorDemand::Wrench(*wrench));
        self.end(held.ok().map(|(clipped, _)| clipped))
    }

    /// The same for a body that was moved to `state`.
    fn arrive(&mut self, state: BodyState, clipped: bool) -> bool {
        if self.lost {
            return false;
        }
        self.vehicle.vehicle_mut().place(state);
        self.end(state.is_finite().then_some(clipped))
    }

    /// Ends a period: whether anything was clipped, or nothing where the motion is no longer finite.
    fn end(&mut self, clipped: Option<bool>) -> bool {
        self.tick += 1;
        self.lost = clipped.is_none() || self.measure().is_err();
        clipped.unwrap_or(false)
    }
}

/// Neighbouring rows.
struct Stretch {
    rows: Vec<Row>,
    /// Their bodies, where nothing else of them moves.
    bodies: Option<(Body, Rows)>,
}

impl Stretch {
    fn new(rows: Vec<Row>) -> Self {
        let bare = rows.first().and_then(|row| row.vehicle.bare());
        let mut bodies = bare.map(|plant| (plant.body().clone(), Rows::new(Arch::new(), rows.len())));
        if let Some((_, bodies)) = &mut bodies {
            rows.iter().enumerate().for_each(|(number, row)| bodies.place(number, row.state()));
        }
        Self { rows, bodies }
    }

    fn place(&mut self, number: usize, row: Row) {
        if let Some((_, bodies)) = &mut self.bodies {
            bodies.place(number, row.state());
        }
        self.rows[number] = row;
    }

    /// Which of them had anything clipped.
    fn hold(&mut self, wrench: &[Wrench], steps: u32) -> Vec<bool> {
        let Some((body, bodies)) = &mut self.bodies else {
            return self.rows.iter_mut().zip(wrench).map(|(row, wrench)| row.hold(wrench)).collect();
        };
        let command = |(number, wrench): (usize, &Wrench)| {
            let (thrust, torque, clipped) = body.clipped(wrench);
            bodies.command(number, thrust, &torque);
            clipped
        };
        let clipped: Vec<bool> = wrench.iter().enumerate().map(command).collect();
        bodies.advance(body, steps);
        let arrive = |(number, (row, clipped)): (usize, (&mut Row, bool))| row.arrive(bodies.state(number), clipped);
        self.rows.iter_mut().zip(clipped).enumerate().map(arrive).collect()
    }
}

/// Rows of the vehicle that a flight of the scenario simulates, under given wrenches.
#[pyclass(module = "saturated_hybrid")]
pub struct VehicleRows {
    scenario: Py<Scenario>,
    count: usize,
    stretches: Vec<Stretch>,
    /// Where each row was put last, and with which seed; none where it began as the scenario does.
    starts: Vec<Start>,
}

/// A state and a seed.
type Start = Option<([f64; STATE_COLUMNS], u64)>;

impl VehicleRows {
    fn read(&self) -> &scenario::Scenario {
        &self.scenario.get().read
    }

    /// A row that starts anew.
    fn begun(&self, state: &[f64; STATE_COLUMNS], seed: u64) -> Result<Row, NoEstimate> {
        let mut scenario = self.read().clone();
        scenario.initial = body(state);
        if let Some(sensors) = &mut scenario.reality.sensors {
            sensors.seed = seed;
        }
        if let Some(estimator) = &mut scenario.reality.estimator {
            estimator.seed = seed;
        }
        if let Some(turbulence) = scenario.reality.wind.as_mut().and_then(|wind| wind.turbulence.as_mut()) {
            turbulence.seed = seed;
        }
        Row::new(&scenario)
    }

    /// Starts rows anew, each at a state with a seed, on all cores. If one has no estimate, no row has changed.
    fn put(&mut self, py: Python<'_>, starts: &[(usize, [f64; STATE_COLUMNS], u64)]) -> PyResult<()> {
        let begun: PyResult<Vec<Result<Row, NoEstimate>>> = py.detach(|| {
            let one = |(_, state, seed): &(usize, [f64; STATE_COLUMNS], u64)| self.begun(state, *seed);
            // An estimator is aligned for longer than it takes to wake another core.
            if starts.len() < ROWS_PER_TASK || self.read().reality.estimator.is_none() {
                return Ok(starts.iter().map(one).collect());
            }
            shared(|| starts.par_iter().map(one).collect())
        });
        let begun = begun?
            .into_iter()
            .zip(starts)
            .map(|(row, (number, ..))| row.map_err(|problem| refused(format!("row {number}: estimator: {problem}"))));
        let begun = begun.collect::<PyResult<Vec<Row>>>()?;
        for (row, (number, state, seed)) in begun.into_iter().zip(starts) {
            self.stretches[number / ROWS_PER_TASK].place(number % ROWS_PER_TASK, row);
            self.starts[*number] = Some((*state, *seed));
        }
        Ok(())
    }

    fn rows(&self) -> impl Iterator<Item = &Row> {
        self.stretches.iter().flat_map(|stretch| &stretch.rows)
    }
}

#[pymethods]
impl VehicleRows {
    #[new]
    fn new(scenario: &Bound<'_, Scenario>, rows: Whole) -> PyResult<Self> {
        let rows = rows.within("rows", 0..=ROWS_MAX)? as usize;
        let Scenario { read, file, .. } = scenario.get();
        let row = Row::new(read).map_err(|problem| refused_field(file, format!("estimator: {problem}")))?;
        let stretch = |first| Stretch::new(vec![row.clone(); ROWS_PER_TASK.min(rows - first)]);
        let stretches = (0..rows).step_by(ROWS_PER_TASK).map(stretch).collect();
        Ok(Self { scenario: scenario.clone().unbind(), count: rows, stretches, starts: vec![None; rows] })
    }

    fn __copy__(&self, py: Python<'_>) -> Self {
        Self {
            scenario: self.scenario.clone_ref(py),
            stretches: self.stretches.iter().map(|stretch| Stretch::new(stretch.rows.clone())).collect(),
            starts: self.starts.clone(),
            ..*self
        }
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> Self {
        self.__copy__(py)
    }

    fn __getnewargs__(&self, py: Python<'_>) -> PyResult<(Py<Scenario>, usize)> {
        let stand = self.rows().all(|row| row.tick == 0);
        if stand { Ok((self.scenario.clone_ref(py), self.count)) } else { Err(in_flight("VehicleRows")) }
    }

    fn __getstate__(&self) -> Vec<Start> {
        self.starts.clone()
    }

    fn __setstate__(&mut self, py: Python<'_>, starts: Vec<Start>) -> PyResult<()> {
        if starts.len() != self.count {
            return Err(refused_field("starts", format!("must be {}, found {}", self.count, starts.len())));
        }
        let begun = |(number, begun): (usize, Start)| begun.map(|(state, seed)| (number, state, seed));
        let starts: Vec<_> = starts.into_iter().enumerate().filter_map(begun).collect();
        for (_, state, _) in &starts {
            start(state, self.read().timing.step()).map_err(refused)?;
        }
        self.put(py, &starts)
    }

    fn __len__(&self) -> usize {
        self.count
    }

    /// Starts the rows that are chosen anew at their rows of `states` (rows, 13); `seeds` (rows,) are their noise's and
    /// turbulence's. An estimator is aligned, in motion, for the three seconds before. If a row is refused, the error
    /// names it and no row has changed.
    #[pyo3(signature = (states, chosen=None, seeds=None))]
    fn place(
        &mut self,
        py: Python<'_>,
        states: &Bound<'_, PyAny>,
        chosen: Option<Vec<bool>>,
        seeds: Option<Vec<Whole>>,
    ) -> PyResult<()> {
        let states = rows::<STATE_COLUMNS>(states, self.count, "states")?;
        let seeds: Vec<u64> = match seeds {
            Some(seeds) => seeds.iter().map(|seed| seed.within("seeds", 0..=u64::MAX)).collect::<PyResult<_>>()?,
            None => (0..self.count as u64).collect(),
        };
        if seeds.len() != self.count {
            let count = self.count;
            return Err(refused_field("seeds", format!("must have shape ({count},), found ({},)", seeds.len())));
        }
        let chosen = numbers(chosen, self.count)?;
        let step = self.read().timing.step();
        for number in &chosen {
            let start = start(&states[*number], step);
            start.map_err(|problem| refused(format!("row {number}: {problem}")))?;
        }
        let starts: Vec<_> = chosen.into_iter().map(|number| (number, states[number], seeds[number])).collect();
        self.put(py, &starts)
    }

    /// Holds wrenches (rows, 4), N and N m, for one control period. Returns which were clipped by limits or rotors, and
    /// which rows go no further, each (rows,): their motion is no longer finite, or their estimator has no state.
    #[allow(clippy::type_complexity)] // a tuple is what Python unpacks
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        wrenches: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyArray1<bool>>, Bound<'py, PyArray1<bool>>)> {
        let wrenches = wrench_rows(wrenches, self.count)?;
        let steps = self.read().timing.steps_per_tick;
        let stretches = &mut self.stretches;
        let clipped: PyResult<Vec<Vec<bool>>> = py.detach(|| {
            let brief = stretches.len() < 2;
            let given = stretches.par_iter_mut().zip(wrenches.par_chunks(ROWS_PER_TASK));
            let all = || given.map(|(stretch, wrench)| stretch.hold(wrench, steps)).collect();
            // Each core works on its own rows.
            if brief { Ok(all()) } else { shared(all) }
        });
        let (clipped, lost) = (clipped?.concat(), self.rows().map(|row| row.lost).collect());
        Ok((PyArray1::from_vec(py, clipped), PyArray1::from_vec(py, lost)))
    }

    /// (rows, 13): the true ones.
    #[getter]
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        array(py, self.rows().map(|row| of_body(row.state())).collect())
    }

    /// (rows, 13): the states that a controller gets: measured, by the scenario's `[sensors]`, or estimated, by its
    /// `[estimator]`; without either section the true ones.
    #[getter]
    fn measured<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        array(py, self.rows().map(|row| row.measured).collect())
    }

    /// (rows, 3): the acceleration since the last period by an accelerometer, m/s^2, world; NaN without one.
    #[getter]
    fn accelerations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        array(py, self.rows().map(|row| row.acceleration).collect())
    }

    /// (rows,) bool: whether the estimated state has jumped since the last period, by a pose and not by motion.
    #[getter]
    fn jumped<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_vec(py, self.rows().map(|row| row.jumped).collect())
    }

    /// (rows, 19): the scenario's, each at its row's own time.
    #[getter]
    fn references<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let period = self.read().timing.period_us;
        let at = |row: &Row| of_reference(&self.read().trajectory.at(row.tick * period));
        array(py, self.rows().map(at).collect())
    }

    /// (rows,): periods since each was placed.
    #[getter]
    fn ticks<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        PyArray1::from_vec(py, self.rows().map(|row| row.tick).collect())
    }
}

/// Where a vehicle may be put: finite, a rotation, and no faster than its integration step can follow.
fn start(row: &[f64; STATE_COLUMNS], step: f64) -> Result<BodyState, String> {
    let state = body(row);
    if !state.is_finite() {
        return Err("state: must be finite".to_owned());
    }
    let length = state.attitude.norm();
    if (length - 1.0).abs() > 1e-3 {
        return Err(format!("state.attitude: quaternion must have unit length within 1e-3, found length {length}"));
    }
    let greatest = ROTATION_PER_STEP_MAX_RAD / step;
    let rate = state.angular_velocity.norm();
    if rate > greatest {
        return Err(format!(
            "state.angular_velocity: must be at most {greatest:.4} rad/s for this plant step, found {rate}"
        ));
    }
    Ok(state)
}
