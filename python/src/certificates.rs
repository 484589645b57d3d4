//! The certificate of a scenario and its sampled loops, in numbers and in words.

use crate::errors::refused;
use crate::rows::array;
use crate::scenarios::Scenario;
use host_sim::commands::certify::{certify as report_on, may_fly};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use scenario::sampled_loop::LoopReport;
use scenario::stability::LoopMargin;
use scenario::verdict::Verdict;

/// One inequality of a certificate: `required` below `available`.
#[pyclass(frozen, get_all, module = "saturated_hybrid")]
#[derive(Clone)]
pub struct Inequality {
    /// Where it comes from (A1: Assumption 1, T1 and T2: Theorems 1 and 2, R: a rotor) and what it is about.
    name: &'static str,
    /// Of both sides.
    unit: &'static str,
    /// The left side.
    required: f64,
    /// The right side.
    available: f64,
    /// The part of what is available that is left over; negative where it fails.
    margin: f64,
    /// Whether it does.
    holds: bool,
}

#[pymethods]
impl Inequality {
    fn __repr__(&self) -> String {
        let Self { name, unit, required, available, .. } = self;
        let verdict = if self.holds { "holds" } else { "FAILS" };
        format!("<{name}: {required:.4} of {available:.4} {unit}, {verdict}>")
    }
}

/// One sampled loop about hover, with rotor lag and delays: an analysis of small motions, not a proof.
#[pyclass(frozen, get_all, module = "saturated_hybrid")]
#[derive(Clone)]
pub struct Loop {
    /// "roll", "pitch", "yaw", "lateral x", "lateral y" or "vertical".
    axis: &'static str,
    /// Growth of an error per sample; stable below one.
    spectral_radius: f64,
    /// Whether it is.
    stable: bool,
    /// Greatest factor below one on the loop's gain that destabilises it; 0 if none does. None if it is unstable as it
    /// is.
    gain_down: Option<f64>,
    /// Least factor above one that does; infinite if none does.
    gain_up: Option<f64>,
    /// Least further delay that does, s.
    delay: Option<f64>,
    /// Highest frequency at which the loop's gain is one, rad/s.
    crossover: Option<f64>,
    /// What it lacks of the margin that flying takes, in words.
    lacks: Option<String>,
}

#[pymethods]
impl Loop {
    fn __repr__(&self) -> String {
        let verdict = self.lacks.as_deref().unwrap_or("enough margin");
        format!("<{}: spectral radius {:.4}; {verdict}>", self.axis, self.spectral_radius)
    }
}

impl Loop {
    fn from_report(report: &LoopReport) -> Self {
        let margins = report.margins;
        Self {
            axis: report.axis.name(),
            spectral_radius: report.spectral_radius,
            stable: margins.is_some(),
            gain_down: margins.map(|margins| margins.gain_down),
            gain_up: margins.map(|margins| margins.gain_up),
            delay: margins.map(|margins| margins.delay),
            crossover: margins.map(|margins| margins.crossover),
            lacks: LoopMargin::FLYABLE_MIN.lacking(report).map(|lack| lack.to_string()),
        }
    }
}

/// Whether a scenario may fly: the proof that its commands stay within the limits, and its sampled loops. True if it
/// may.
#[pyclass(frozen, module = "saturated_hybrid")]
pub struct Certificate {
    verdict: Verdict,
    rotors: usize,
    /// The output of `host-sim certify`.
    #[pyo3(get)]
    report: String,
    /// Everything that keeps it on the ground, in words; empty if nothing does.
    #[pyo3(get)]
    reasons: Vec<String>,
}

/// The certificate and the sampled loops of a scenario.
#[pyfunction]
pub fn certify(scenario: &Scenario) -> PyResult<Certificate> {
    let read = &scenario.read;
    let verdict = Verdict::judge(read).map_err(refused)?;
    let (report, _) = report_on(read).map_err(refused)?;
    let report = format!("{report}\n{}", may_fly::lines(read));
    let rotors = read.configuration.rotors().map_or(0, |rotors| rotors.len());
    Ok(Certificate { reasons: reasons(&verdict), verdict, rotors, report })
}

/// Everything that keeps a scenario on the ground.
pub fn reasons(verdict: &Verdict) -> Vec<String> {
    verdict.refusals().map(|refusal| refusal.to_string()).collect()
}

#[pymethods]
impl Certificate {
    /// Whether it may fly.
    #[getter]
    fn certified(&self) -> bool {
        self.verdict.refusal().is_none()
    }

    /// Whether every inequality holds, whatever the sampled loops do.
    #[getter]
    fn commands_proven(&self) -> bool {
        self.verdict.certificate().holds()
    }

    /// All that decide.
    #[getter]
    fn inequalities(&self) -> Vec<Inequality> {
        let named = |one: &controller_core::certificate::inequality::Inequality| Inequality {
            name: one.name,
            unit: one.unit,
            required: one.required,
            available: one.available,
            margin: one.margin(),
            holds: one.holds(),
        };
        self.verdict.certificate().inequalities().map(named).collect()
    }

    /// The six sampled loops.
    #[getter]
    fn loops(&self) -> Vec<Loop> {
        self.verdict.loops().iter().map(Loop::from_report).collect()
    }

    /// Least and greatest thrust that the law can command, N.
    #[getter]
    fn thrust(&self) -> (f64, f64) {
        let thrust = self.verdict.certificate().thrust();
        (thrust.min, thrust.max)
    }

    /// (3,): greatest |torque| that it can command about each body axis, N m.
    #[getter]
    fn torque<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.verdict.certificate().torque().as_slice())
    }

    /// (n, 2): least and greatest thrust that it can command of each rotor, N.
    #[getter]
    fn rotors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let proven = (0..self.rotors).filter_map(|rotor| self.verdict.certificate().rotor(rotor));
        array(py, proven.map(|proven| [proven.min, proven.max]).collect())
    }

    fn __bool__(&self) -> bool {
        self.certified()
    }

    fn __str__(&self) -> String {
        if self.certified() { "certified".to_owned() } else { format!("not certified: {}", self.reasons.join("; ")) }
    }

    fn __repr__(&self) -> String {
        format!("<Certificate: {}>", self.__str__())
    }
}
