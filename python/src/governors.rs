//! The governor of a scenario: setpoints in, references inside its bounds out.

use crate::errors::{in_flight, refused, refused_field};
use crate::rows::{array, of_reference, row};
use crate::scenarios::Scenario;
use crate::whole_number::Whole;
use controller_core::governor::{self, GovernorLimits, HeadingSetpoint, Memory, Motion, Setpoint};
use controller_core::heading::Heading;
use nalgebra::{Vector2, Vector3};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Any stream of setpoints in, a reference within the scenario's reference bounds out, once per control period.
///
/// Args:
///     scenario: bounds and period.
///     horizontal_speed, vertical_speed: greatest commanded speeds, m/s.
///     snap_ramp, heading_ramp: how long snap and psi'' take from one end of their bound to the other, s.
///     timeout: how long velocities and rates are valid without renewal, s.
#[pyclass(module = "saturated_hybrid")]
pub struct Governor {
    scenario: Py<Scenario>,
    limits: GovernorLimits,
    governor: Box<governor::Governor>,
    /// K_v12 of the scenario, m/s.
    greatest_speed: f32,
}

#[pymethods]
impl Governor {
    #[new]
    #[pyo3(signature = (scenario, *, horizontal_speed=5.0, vertical_speed=2.0, snap_ramp=0.1, heading_ramp=0.2, timeout=0.5))]
    fn new(
        scenario: &Bound<'_, Scenario>,
        horizontal_speed: f32,
        vertical_speed: f32,
        snap_ramp: f32,
        heading_ramp: f32,
        timeout: f32,
    ) -> PyResult<Self> {
        let limits = GovernorLimits { horizontal_speed, vertical_speed, snap_ramp, heading_ramp, timeout };
        let read = &scenario.get().read;
        Ok(Self {
            scenario: scenario.clone().unbind(),
            limits,
            governor: made(read, &limits)?,
            greatest_speed: read.configuration.bounds().horizontal_speed,
        })
    }

    fn __copy__(&self, py: Python<'_>) -> Self {
        Self { scenario: self.scenario.clone_ref(py), governor: self.governor.clone(), ..*self }
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> Self {
        self.__copy__(py)
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((Py<Scenario>,), Bound<'py, PyDict>)> {
        if self.governor != made(&self.scenario.get().read, &self.limits)? {
            return Err(in_flight("Governor"));
        }
        let GovernorLimits { horizontal_speed, vertical_speed, snap_ramp, heading_ramp, timeout } = self.limits;
        let named = PyDict::new(py);
        named.set_item("horizontal_speed", horizontal_speed)?;
        named.set_item("vertical_speed", vertical_speed)?;
        named.set_item("snap_ramp", snap_ramp)?;
        named.set_item("heading_ramp", heading_ramp)?;
        named.set_item("timeout", timeout)?;
        Ok(((self.scenario.clone_ref(py),), named))
    }

    /// Starts anew at a steady motion: (3,) m, (3,) m/s, world, across at most the scenario's
    /// `reference_bounds.horizontal_speed`; rad.
    #[pyo3(signature = (position, velocity=None, yaw=0.0))]
    fn start(&mut self, position: &Bound<'_, PyAny>, velocity: Option<&Bound<'_, PyAny>>, yaw: f64) -> PyResult<()> {
        let velocity = velocity.map_or(Ok(Vector3::zeros()), |velocity| single(velocity, "velocity"))?;
        let (across, greatest) = (velocity.xy().norm(), self.greatest_speed);
        // Rounding does not concern the caller.
        if across > greatest * (1.0 + 2.0 * f32::EPSILON) {
            let allowed = "must be at most the scenario's reference_bounds.horizontal_speed across";
            return Err(refused_field("velocity", format!("{allowed}, {greatest} m/s, found {across}")));
        }
        let heading = Heading::new(Vector2::new(yaw.cos() as f32, yaw.sin() as f32), 0.0, 0.0);
        let heading = heading.map_err(|error| refused_field("yaw", error.reason))?;
        self.governor.start(&single(position, "position")?, &velocity, &heading).map_err(refused)
    }

    /// Replaces the setpoint, world frame.
    ///
    /// A position alone: go there and rest. A velocity alone: move so. Both, and an acceleration: follow that moving
    /// point. A position with `None` on some axes: go there on the others, and on these move at the velocity. No yaw:
    /// keep the last one. `late`: how long ago it was true, s, at most 0.3; a moving point has gone on since.
    #[pyo3(signature = (position=None, velocity=None, acceleration=None, *, yaw=None, yaw_rate=None, late=0.0))]
    fn accept(
        &mut self,
        position: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        acceleration: Option<&Bound<'_, PyAny>>,
        yaw: Option<f32>,
        yaw_rate: Option<f32>,
        late: f32,
    ) -> PyResult<()> {
        let motion = motion(position, velocity, acceleration)?;
        let turn = match (yaw, yaw_rate) {
            (None, None) => HeadingSetpoint::Keep,
            (Some(angle), rate) => HeadingSetpoint::Angle { angle, rate: rate.unwrap_or(0.0) },
            (None, Some(rate)) => HeadingSetpoint::Rate(rate),
        };
        self.governor.accept_late(&Setpoint { motion, turn }, late).map_err(refused)
    }

    /// Gives up the setpoint and comes to rest.
    fn stop(&mut self) {
        self.governor.stop();
    }

    /// Whether the reference rests at its setpoint.
    #[getter]
    fn at_rest(&self) -> bool {
        self.governor.at_rest()
    }

    /// The reference (19,) one period later.
    fn tick<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, &of_reference(&self.governor.tick()))
    }

    /// The references (ticks, 19) of as many periods. Interrupted, it is where it was.
    fn run<'py>(&mut self, py: Python<'py>, ticks: Whole) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let ticks = ticks.within("ticks", 0..=TICKS_MAX)? as usize;
        let mut governor = self.governor.clone();
        let mut references = Vec::with_capacity(ticks);
        while references.len() < ticks {
            let brief = TICKS_BETWEEN_SIGNALS.min(ticks - references.len());
            py.detach(|| references.extend((0..brief).map(|_| of_reference(&governor.tick()))));
            py.check_signals()?;
        }
        self.governor = governor;
        array(py, references)
    }
}

/// A governor at rest at the origin.
fn made(scenario: &scenario::Scenario, limits: &GovernorLimits) -> PyResult<Box<governor::Governor>> {
    let (bounds, period) = (scenario.configuration.bounds(), scenario.timing.period() as f32);
    let mut memory = Box::new(Memory::EMPTY);
    let made = governor::Governor::new(bounds, limits, period, &mut memory).map_err(refused)?;
    Ok(Box::new(made.clone()))
}

/// Of one call: about half a gigabyte of references.
const TICKS_MAX: u64 = 10_000_000;
/// Some milliseconds of them.
const TICKS_BETWEEN_SIGNALS: usize = 10_000;

fn single(array: &Bound<'_, PyAny>, field: &str) -> PyResult<Vector3<f32>> {
    Ok(Vector3::from(row::<3>(array, field)?).map(|value| value as f32))
}

/// The setpoint from its given parts. A position may be `None` on axes that move at a velocity.
fn motion(
    position: Option<&Bound<'_, PyAny>>,
    velocity: Option<&Bound<'_, PyAny>>,
    acceleration: Option<&Bound<'_, PyAny>>,
) -> PyResult<Motion> {
    let or_still =
        |given: Option<&Bound<'_, PyAny>>, field| given.map_or(Ok(Vector3::zeros()), |given| single(given, field));
    let Some(position) = position else {
        if acceleration.is_some() {
            return Err(refused_field("acceleration", "needs a position and its velocity"));
        }
        let lacking = || refused_field("velocity", "there is neither a position nor a velocity; give one");
        return Ok(Motion::Velocity(single(velocity.ok_or_else(lacking)?, "velocity")?));
    };
    if let Ok(mixed) = position.extract::<[Option<f32>; 3]>()
        && mixed.contains(&None)
    {
        if acceleration.is_some() {
            return Err(refused_field("acceleration", "needs a position on every axis, without None"));
        }
        return Ok(Motion::Mixed { position: mixed, velocity: or_still(velocity, "velocity")? });
    }
    let position = single(position, "position")?;
    if velocity.is_none() && acceleration.is_none() {
        return Ok(Motion::Position(position));
    }
    let (velocity, acceleration) = (or_still(velocity, "velocity")?, or_still(acceleration, "acceleration")?);
    Ok(Motion::PositionVelocityAcceleration { position, velocity, acceleration })
}
