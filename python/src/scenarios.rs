//! Scenarios: text that was read, and what it says. A changed scenario is a changed text, read anew.

use crate::errors::{refused, refused_field};
use crate::rows::{REFERENCE_COLUMNS, array, of_body, of_reference, vector};
use controller_core::allocation::Rotor;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use scenario::Scenario as Read;
use std::path::PathBuf;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, Value};

/// The files of `scenarios/` and `vehicles/`, by their names.
const BUILT_IN: [(&str, &str); 12] = [
    ("paper", include_str!("../../scenarios/paper.toml")),
    ("paper-extended", include_str!("../../scenarios/paper-extended.toml")),
    ("paper-tuned", include_str!("../../scenarios/paper-tuned.toml")),
    ("circle", include_str!("../../scenarios/circle.toml")),
    ("hover", include_str!("../../scenarios/hover.toml")),
    ("waypoints", include_str!("../../scenarios/waypoints.toml")),
    ("study", include_str!("../../vehicles/study.toml")),
    ("study-paper-law", include_str!("../../vehicles/study-paper-law.toml")),
    ("study-paper", include_str!("../../vehicles/study-paper.toml")),
    ("hummingbird", include_str!("../../vehicles/hummingbird.toml")),
    ("hummingbird-paper-law", include_str!("../../vehicles/hummingbird-paper-law.toml")),
    ("hummingbird-paper", include_str!("../../vehicles/hummingbird-paper.toml")),
];

/// A scenario: vehicle, limits, gains, start, reference and circumstances of a flight. docs/scenario-file.md has its
/// keys.
///
/// It never changes; `edited` gives a changed one. It can be pickled.
#[pyclass(frozen, module = "saturated_hybrid")]
pub struct Scenario {
    /// What was read.
    pub read: Read,
    /// What errors call it.
    pub file: String,
    /// The TOML.
    #[pyo3(get)]
    pub text: String,
}

impl Scenario {
    /// Reads `text`, which errors call `file`.
    ///
    /// # Errors
    /// Names the file, the field and the reason.
    pub fn from_text(text: String, file: String) -> PyResult<Self> {
        let read = Read::parse(&text, &file).map_err(refused)?;
        Ok(Self { read, file, text })
    }
}

#[pymethods]
impl Scenario {
    /// Reads a TOML file. `ValueError` names the file, the field and the reason.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        let file = path.display().to_string();
        let text = scenario::self_contained::read(&path)
            .map_err(|error| refused_field(&file, format!("cannot be read: {error}")))?;
        Self::from_text(text, file)
    }

    /// Reads TOML text, which errors call `file`.
    #[staticmethod]
    #[pyo3(signature = (text, file="scenario"))]
    fn parse(text: String, file: &str) -> PyResult<Self> {
        Self::from_text(text, file.to_owned())
    }

    /// One of `names()`: the repository's scenarios and vehicles.
    #[staticmethod]
    fn built_in(name: &str) -> PyResult<Self> {
        let Some((_, text)) = BUILT_IN.iter().find(|(known, _)| *known == name) else {
            let known = BUILT_IN.map(|(known, _)| known).join(", ");
            return Err(refused_field("name", format!("there is no scenario {name:?}; there are {known}")));
        };
        Self::from_text((*text).to_owned(), format!("{name} (built in)"))
    }

    /// What `built_in` knows.
    #[staticmethod]
    fn names() -> Vec<&'static str> {
        BUILT_IN.map(|(name, _)| name).to_vec()
    }

    /// The scenario with other values, by their dotted paths: `{"vehicle.mass": 0.48, "wind": {"steady": [2, 0, 0]}}`.
    ///
    /// Numbers, text, booleans, lists and dictionaries; `None` takes a key or a section away. Comments in the text
    /// stay.
    fn edited(&self, changes: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut document: DocumentMut = self.text.parse().map_err(refused)?;
        for (path, value) in changes.iter() {
            let path: String =
                path.extract().map_err(|_| refused_field("changes", "keys must be dotted paths, as text"))?;
            change(&mut document, &path, &value)?;
        }
        Self::from_text(document.to_string(), self.file.clone())
    }

    /// Names the flight.
    #[getter]
    fn name(&self) -> &str {
        &self.read.name
    }

    /// s.
    #[getter]
    fn duration(&self) -> f64 {
        self.read.timing.duration()
    }

    /// Of the control, s.
    #[getter]
    fn period(&self) -> f64 {
        self.read.timing.period()
    }

    /// Control periods in `duration`.
    #[getter]
    fn ticks(&self) -> u64 {
        self.read.timing.ticks
    }

    /// "paper" or "extended".
    #[getter]
    fn law(&self) -> &'static str {
        if self.read.configuration.paper().is_some() { "paper" } else { "extended" }
    }

    /// kg.
    #[getter]
    fn mass(&self) -> f64 {
        f64::from(self.read.configuration.vehicle().mass)
    }

    /// m/s^2.
    #[getter]
    fn gravity(&self) -> f64 {
        f64::from(self.read.configuration.vehicle().gravity)
    }

    /// (3,), diagonal, kg m^2, body.
    #[getter]
    fn inertia<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.read.configuration.vehicle().inertia.map(f64::from).as_slice())
    }

    /// N.
    #[getter]
    fn thrust_max(&self) -> f64 {
        f64::from(self.read.configuration.limits().thrust_max)
    }

    /// (3,), N m, body.
    #[getter]
    fn torque_max<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.read.configuration.limits().torque_max.map(f64::from).as_slice())
    }

    /// None if thrust and torque act directly.
    #[getter]
    fn rotors<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(rotors) = self.read.configuration.rotors() else { return Ok(None) };
        let each = |of: fn(&Rotor) -> f32| PyArray1::from_vec(py, rotors.iter().map(|r| f64::from(of(r))).collect());
        let named = PyDict::new(py);
        let positions = rotors.iter().map(|rotor| rotor.position.map(f64::from).into());
        let speeds = rotors.iter().map(|r| [r.thrust_min, r.thrust_max].map(|thrust| f64::from(r.speed_at(thrust))));
        named.set_item("position", array::<f64, 3>(py, positions.collect())?)?;
        named.set_item("spin", each(|rotor| rotor.spin.sign()))?;
        named.set_item("thrust_coefficient", each(|rotor| rotor.thrust_coefficient))?;
        named.set_item("drag_coefficient", each(|rotor| rotor.drag_coefficient))?;
        named.set_item("speed", array(py, speeds.collect())?)?;
        named.set_item("lag", self.read.rotor_lag)?;
        Ok(Some(named))
    }

    /// (13,): where it starts.
    #[getter]
    fn initial<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &of_body(&self.read.initial))
    }

    /// The reference at `times` (n,), s, rounded to microseconds: (n, 19).
    fn reference<'py>(&self, py: Python<'py>, times: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let at = |time: f64| -> PyResult<[f32; REFERENCE_COLUMNS]> {
            let micros = (time * 1e6).round();
            if !(0.0..=REFERENCE_TIME_MAX_US).contains(&micros) {
                return Err(refused_field(
                    "times",
                    format!("must be from 0 to {:e} s, found {time}", REFERENCE_TIME_MAX_US / 1e6),
                ));
            }
            Ok(of_reference(&self.read.trajectory.at(micros as u64)))
        };
        array(py, vector(times, "times")?.into_iter().map(at).collect::<PyResult<Vec<_>>>()?)
    }

    fn __repr__(&self) -> String {
        format!("<Scenario {:?}, {} law, {} s>", self.read.name, self.law(), self.read.timing.duration())
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String, String))> {
        let this = slf.get();
        Ok((slf.getattr("parse")?, (this.text.clone(), this.file.clone())))
    }
}

/// The longest time of a reference, us: beyond it a double no longer resolves microseconds.
const REFERENCE_TIME_MAX_US: f64 = 9e15;

/// Sets what stands at a dotted path, or with `None` takes it away; sections that are missing come into being.
///
/// # Errors
/// Names the path, and what of its value no scenario can hold.
pub fn change(document: &mut DocumentMut, path: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
    let mut sections: Vec<&str> = path.split('.').collect();
    let key = sections.pop().filter(|_| path.split('.').all(|part| !part.is_empty()));
    let key =
        key.ok_or_else(|| refused_field("changes", format!("{path:?} is no dotted path such as \"vehicle.mass\"")))?;
    let mut table: &mut dyn toml_edit::TableLike = document.as_table_mut();
    for section in sections {
        let there = table.entry(section).or_insert_with(|| Item::Table(Table::new()));
        let other = || refused_field("changes", format!("{path:?}: {section} is no section"));
        table = there.as_table_like_mut().ok_or_else(other)?;
    }
    if value.is_none() {
        table.remove(key);
    } else {
        table.insert(key, item(value, path)?);
    }
    Ok(())
}

/// A Python value as a TOML item: a dictionary becomes a section.
fn item(value: &Bound<'_, PyAny>, path: &str) -> PyResult<Item> {
    let Ok(section) = value.cast::<PyDict>() else {
        return Ok(Item::Value(toml(value, path, NESTING_MAX)?));
    };
    let mut table = Table::new();
    for (key, value) in section.iter() {
        let key = named(&key, path)?;
        table.insert(&key, Item::Value(toml(&value, &format!("{path}.{key}"), NESTING_MAX)?));
    }
    Ok(Item::Table(table))
}

/// How deep lists and dictionaries may lie in each other: no key of a scenario takes more, and one that holds itself
/// has no end.
const NESTING_MAX: usize = 16;

/// A key of a dictionary at `path`.
fn named(key: &Bound<'_, PyAny>, path: &str) -> PyResult<String> {
    key.extract().map_err(|_| refused_field("changes", format!("{path:?}: its keys must be text, found {key}")))
}

/// A Python value as a TOML value, with at most so many `levels` in it.
fn toml(value: &Bound<'_, PyAny>, path: &str, levels: usize) -> PyResult<Value> {
    let refused = |problem: &str| refused_field("changes", format!("{path:?}: {problem}"));
    let deeper = levels.checked_sub(1).ok_or_else(|| refused("lies too deep in lists and dictionaries"));
    // What numpy has: its scalars and arrays say what they are in Python.
    let plain = if value.hasattr("tolist")? { value.call_method0("tolist")? } else { value.clone() };
    if plain.is_instance_of::<PyBool>() {
        Ok(plain.extract::<bool>()?.into())
    } else if plain.is_instance_of::<PyString>() {
        Ok(plain.extract::<String>().map_err(|_| refused("must be text that UTF-8 has"))?.into())
    } else if plain.is_instance_of::<PyFloat>() {
        Ok(plain.extract::<f64>()?.into())
    } else if let Ok(whole) = plain.extract::<i64>() {
        Ok(whole.into())
    } else if plain.is_instance_of::<PyInt>() {
        Err(refused("must be a whole number of at most 64 bits"))
    } else if plain.is_instance_of::<PyList>() || plain.is_instance_of::<PyTuple>() {
        let deeper = deeper?;
        let elements = plain.try_iter()?.map(|element| toml(&element?, path, deeper));
        Ok(Value::Array(elements.collect::<PyResult<Array>>()?))
    } else if let Ok(section) = plain.cast::<PyDict>() {
        let deeper = deeper?;
        let pairs = section.iter().map(|(key, value)| Ok((named(&key, path)?, toml(&value, path, deeper)?)));
        Ok(Value::InlineTable(pairs.collect::<PyResult<InlineTable>>()?))
    } else {
        let what = plain.get_type().name()?;
        Err(refused(&format!("cannot be {what}; give a number, text, True, a list or a dict")))
    }
}
