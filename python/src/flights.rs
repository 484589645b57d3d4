//! Whole flights: the columns of log.csv, and what was claimed against what was flown.

use crate::certificates::reasons;
use crate::errors::{failed, refused};
use crate::interruptible::interruptible;
use crate::scenarios::Scenario;
use controller_core::error::ParameterError;
use host_sim::flight::claims::{self, claims};
use host_sim::flight::extremes::FlightExtremes;
use host_sim::flight::{self, FlightError};
use host_sim::output::interrupt::Interrupt;
use host_sim::reports::log;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use scenario::verdict::Verdict;
use std::io;

/// What a flight claimed, and whether it holds: texts, as `host-sim fly` prints them.
#[pyclass(frozen, get_all, module = "saturated_hybrid")]
#[derive(Clone)]
pub struct Claim {
    /// What it is about.
    claim: String,
    /// What must be; empty where nothing must.
    required: String,
    /// What was.
    flown: String,
    /// None where nothing is required.
    holds: Option<bool>,
}

#[pymethods]
impl Claim {
    fn __repr__(&self) -> String {
        let verdict = self.holds.map_or("", |holds| if holds { ", holds" } else { ", FAILS" });
        format!("<{}: {} (required: {}){verdict}>", self.claim, self.flown, self.required)
    }
}

/// A flight that was flown. Its length is its number of control ticks.
#[pyclass(frozen, module = "saturated_hybrid")]
pub struct Flight {
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
    /// All of them.
    #[pyo3(get)]
    claims: Vec<Claim>,
    /// The claims as a table.
    #[pyo3(get)]
    table: String,
    /// Why not.
    #[pyo3(get)]
    reasons: Vec<String>,
}

#[pymethods]
impl Flight {
    /// What log.csv holds, number by number: each column (ticks,), by its name there.
    #[getter]
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let named = PyDict::new(py);
        for (name, column) in self.names.iter().zip(&self.columns) {
            named.set_item(name, PyArray1::from_slice(py, column))?;
        }
        Ok(named)
    }

    /// Whether none fails.
    #[getter]
    fn every_claim_holds(&self) -> bool {
        self.claims.iter().all(|claim| claim.holds != Some(false))
    }

    /// Whether the scenario may fly for real.
    #[getter]
    fn certified(&self) -> bool {
        self.reasons.is_empty()
    }

    fn __len__(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    fn __repr__(&self) -> String {
        let verdict = if self.every_claim_holds() { "every claim holds" } else { "NOT every claim holds" };
        format!("<Flight: {} ticks, {} columns; {verdict}>", self.__len__(), self.names.len())
    }
}

/// Flies a scenario. `RuntimeError` with the time if the flight cannot go on.
#[pyfunction]
pub fn fly(py: Python<'_>, scenario: &Scenario) -> PyResult<Flight> {
    let flown = interruptible(py, |interrupt| flown(&scenario.read, interrupt))?;
    flown.map_err(|stopped| match stopped {
        Stopped::Scenario(error) => refused(error),
        Stopped::Flight(error) => failed(error),
        Stopped::Log(error) => failed(error),
    })
}

/// Why a flight came to no end.
enum Stopped {
    Scenario(ParameterError),
    Flight(FlightError),
    Log(io::Error),
}

/// Flies `scenario` to its end, or to where it is interrupted.
fn flown(scenario: &scenario::Scenario, interrupt: &Interrupt) -> Result<Flight, Stopped> {
    let verdict = Verdict::judge(scenario).map_err(Stopped::Scenario)?;
    let mut flight = flight::Flight::new(scenario).map_err(Stopped::Scenario)?;
    let configuration = &scenario.configuration;
    let rotors = configuration.rotors().map_or(0, |rotors| rotors.len());
    let header = log::header(rotors, configuration.paper().is_none()) + &log::reality_header(&scenario.reality);
    let names: Vec<String> = header.split(',').map(str::to_owned).collect();
    let mut columns = vec![Vec::new(); names.len()];
    let (mut row, mut seen) = (Vec::new(), FlightExtremes::new(scenario));
    for _ in 0..scenario.timing.ticks {
        if interrupt.signal().is_some() {
            break;
        }
        let tick = flight.tick().map_err(Stopped::Flight)?;
        // The numbers that a reader of log.csv finds, whatever columns it comes to have.
        log::write_row(&mut row, &tick).map_err(Stopped::Log)?;
        let text = str::from_utf8(&row).map_err(|error| Stopped::Log(io::Error::other(error)))?;
        for (column, number) in columns.iter_mut().zip(text.trim_end().split(',')) {
            column.push(number.parse().map_err(|error| Stopped::Log(io::Error::other(error)))?);
        }
        row.clear();
        seen.observe(&tick);
    }
    let claims = claims(scenario, &verdict, &seen);
    let table = claims::table(&claims);
    let shown = |claim: claims::Claim| Claim {
        claim: claim.claim,
        required: claim.required,
        flown: claim.flown,
        holds: claim.holds,
    };
    Ok(Flight { names, columns, claims: claims.into_iter().map(shown).collect(), table, reasons: reasons(&verdict) })
}
