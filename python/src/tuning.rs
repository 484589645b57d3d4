//! The search for gains.

use crate::errors::{failed, refused, refused_field};
use crate::interruptible::interruptible;
use crate::scenarios::Scenario;
use crate::threads::alone;
use crate::whole_number::Whole;
use host_sim::studies::tune::effort::Effort;
use host_sim::studies::tune::figures::TrialFigures;
use host_sim::studies::tune::requirements::{RECOVERY_MAX_S, RECOVERY_MIN_S, Requirements};
use host_sim::studies::tune::{output, tune as search};
use pyo3::prelude::*;
use scenario::check_name;
use scenario::stability::LoopMargin;

/// Gains that a search found, and what they showed.
#[pyclass(frozen, module = "saturated_hybrid")]
pub struct Tuned {
    /// The scenario with these gains.
    #[pyo3(get)]
    scenario: Py<Scenario>,
    shown: TrialFigures,
    /// What the search made small.
    #[pyo3(get)]
    cost: f64,
    /// The same of the constants that the search started from.
    #[pyo3(get)]
    cost_before: f64,
    /// Candidates.
    #[pyo3(get)]
    judged: u64,
}

#[pymethods]
impl Tuned {
    /// From upside down, m.
    #[getter]
    fn height_lost(&self) -> f64 {
        self.shown.height_lost
    }

    /// Time until back for good, s.
    #[getter]
    fn recovered(&self) -> f64 {
        self.shown.recovered
    }

    /// Deepest excursion in a gust of 5 m/s, m.
    #[getter]
    fn gust(&self) -> f64 {
        self.shown.gust
    }

    /// Time until a step of 1 m is flown, s.
    #[getter]
    fn step(&self) -> f64 {
        self.shown.step
    }

    /// RMS of the position under noise, m.
    #[getter]
    fn noise(&self) -> f64 {
        self.shown.noise
    }

    fn __repr__(&self) -> String {
        format!("<Tuned: height lost {:.3} m, cost {:.3}, {} judged>", self.shown.height_lost, self.cost, self.judged)
    }
}

/// Refines a scenario's constants: they certify, and then please a pilot most; about a minute, on all cores. As
/// `host-sim tune`.
///
/// Args:
///     name: of the tuned scenario; left out: its own with `-tuned`.
///     generations, population, seed: how hard to search, and from which seed: the same gives the same gains.
///     margin: least margin of every inequality, as a fraction.
///     gain_margin: least gain margin of every sampled loop, 1.5 or more.
///     delay_margin: least delay margin of every sampled loop, s, 0.002 or more.
///     position_error, mrp_error: greatest of the scenario's own flight in its last quarter, m and 1.
///     recovery: how long a recovery from upside down may take, s, 2 or more; its last quarter must be still.
///     projection: whether the paper's law may use the thrust projection.
///
/// Raises:
///     RuntimeError: no gains met the requirements; says in what the closest fail.
#[pyfunction]
#[pyo3(signature = (scenario, *, name=None, generations=Whole::new(60), population=Whole::new(24), seed=Whole::new(1), margin=0.0, gain_margin=1.75,
    delay_margin=0.003, position_error=0.02, mrp_error=0.01, recovery=20.0, projection=true),
    text_signature = "(scenario, *, name=None, generations=60, population=24, seed=1, margin=0.0, gain_margin=1.75, delay_margin=0.003, \
position_error=0.02, mrp_error=0.01, recovery=20.0, projection=True)")]
#[allow(clippy::too_many_arguments)] // its user names them
pub fn tune(
    py: Python<'_>,
    scenario: &Scenario,
    name: Option<String>,
    generations: Whole,
    population: Whole,
    seed: Whole,
    margin: f64,
    gain_margin: f64,
    delay_margin: f64,
    position_error: f64,
    mrp_error: f64,
    recovery: f64,
    projection: bool,
) -> PyResult<Tuned> {
    let positive = [("position_error", position_error), ("mrp_error", mrp_error)];
    for (field, value) in positive {
        check(value > 0.0 && value.is_finite(), field, "must be greater than zero and finite", value)?;
    }
    let least = LoopMargin::FLYABLE_MIN;
    let allowed = format!("must be from {RECOVERY_MIN_S} to {RECOVERY_MAX_S} s");
    check((RECOVERY_MIN_S..=RECOVERY_MAX_S).contains(&recovery), "recovery", &allowed, recovery)?;
    check((0.0..1.0).contains(&margin), "margin", "must be from 0 to below 1", margin)?;
    check(gain_margin >= least.gain && gain_margin.is_finite(), "gain_margin", "must be 1.5 or more", gain_margin)?;
    check(
        delay_margin >= least.delay && delay_margin.is_finite(),
        "delay_margin",
        "must be 0.002 s or more",
        delay_margin,
    )?;
    let generations = generations.within("generations", 1..=u64::from(u32::MAX))? as u32;
    let population = population.within("population", 4..=1000)? as usize;
    let seed = seed.within("seed", 0..=u64::MAX)?;
    let mut read = scenario.read.clone();
    read.name = name.unwrap_or_else(|| format!("{}-tuned", scenario.read.name));
    check_name(&read.name).map_err(refused)?;
    let loops = LoopMargin { gain: gain_margin, delay: delay_margin };
    let requirements = Requirements { margin, loops, position_error, mrp_error, recovery, projection };
    let effort = Effort { generations, population, seed };
    let found = interruptible(py, |interrupt| alone(|| search(&read, requirements, effort, interrupt)))?;
    let tuned = found?.map_err(|closest| {
        let what = closest.failed.clone().unwrap_or_default();
        failed(format!("{}: no gains meet the requirements; the closest fail in: {what}", scenario.read.name))
    })?;
    let text = output::rewritten(&scenario.text, &tuned).map_err(refused)?;
    let scenario = Py::new(py, Scenario::from_text(text, scenario.file.clone())?)?;
    Ok(Tuned {
        scenario,
        shown: tuned.verdict.figures,
        cost: tuned.verdict.cost,
        cost_before: tuned.before.cost,
        judged: tuned.judged,
    })
}

fn check(holds: bool, field: &str, allowed: &str, found: impl std::fmt::Display) -> PyResult<()> {
    if holds { Ok(()) } else { Err(refused_field(field, format!("{allowed}, found {found}"))) }
}
