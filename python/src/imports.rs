//! Vehicles from the files and dictionaries of other programs, as `host-sim vehicle` reads them.

use crate::errors::{refused, refused_field};
use crate::scenarios::{Scenario, change};
use host_sim::identification::import::numbers::VehicleNumbers;
use host_sim::identification::import::value::Value;
use host_sim::identification::import::written::{Wishes, Written, written};
use host_sim::identification::import::{self, Format, rotorpy};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use scenario::check_name;
use std::path::PathBuf;

/// How deep dictionaries and lists may lie in each other: one that holds itself has no end.
const NESTING_MAX: usize = 8;

/// A vehicle's numbers from another program, as a vehicle file; what the source has not is marked in it, never guessed.
///
/// docs/import.md has the formats.
#[pyclass(frozen, module = "saturated_hybrid")]
pub struct Vehicle {
    file: Written,
    /// Names the vehicle.
    #[pyo3(get)]
    name: String,
}

impl Vehicle {
    fn convert(numbers: &VehicleNumbers, name: String, from: &str, neglect_products: bool) -> PyResult<Self> {
        check_name(&name).map_err(refused)?;
        let wishes = Wishes { given: Vec::new(), neglect_products };
        let file = written(numbers, &name, from, &wishes).map_err(refused)?;
        Ok(Self { file, name })
    }
}

#[pymethods]
impl Vehicle {
    /// The vehicle of RotorPy's dictionary, e.g. `rotorpy.vehicles.crazyflie_params.quad_params`.
    ///
    /// `ValueError` names the key and the reason. Products of inertia are written as they are, which no scenario takes,
    /// unless they are to be neglected.
    #[staticmethod]
    #[pyo3(signature = (quad_params, name="vehicle", neglect_products=false))]
    fn from_rotorpy(quad_params: &Bound<'_, PyDict>, name: &str, neglect_products: bool) -> PyResult<Self> {
        let dictionary = value(quad_params, NESTING_MAX)?;
        let numbers = rotorpy::of_dictionary(&dictionary, "quad_params").map_err(refused)?;
        Self::convert(&numbers, name.to_owned(), "Python", neglect_products)
    }

    /// The vehicle of a file: RotorPy's (Python or JSON), URDF, SDF, MuJoCo's XML, PX4's parameters.
    ///
    /// `format` is "rotorpy", "urdf", "sdf", "mujoco" or "px4", left out what the file looks like; `name` left out the
    /// file's. `ValueError` names the file, the element and the reason.
    #[staticmethod]
    #[pyo3(signature = (path, name=None, format=None, neglect_products=false))]
    fn read(path: PathBuf, name: Option<String>, format: Option<&str>, neglect_products: bool) -> PyResult<Self> {
        let file = path.display().to_string();
        let known = |requested: &str| {
            let found = Format::ALL.into_iter().find(|(name, _)| *name == requested).map(|(_, format)| format);
            let all = Format::ALL.map(|(name, _)| name).join(", ");
            found.ok_or_else(|| refused_field("format", format!("must be one of {all}, found {requested:?}")))
        };
        let format = format.map(known).transpose()?;
        let text =
            scenario::text::read(&path).map_err(|error| refused_field(&file, format!("cannot be read: {error}")))?;
        let numbers = import::read(&text, &path, format).map_err(|what| refused_field(&file, what))?;
        let own = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let from = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Self::convert(&numbers, name.unwrap_or(own), &from, neglect_products)
    }

    /// The vehicle file, TOML: `Scenario.parse` reads it if nothing is missing.
    #[getter]
    fn text(&self) -> &str {
        &self.file.text
    }

    /// Dotted paths of the numbers that the source has not.
    #[getter]
    fn missing(&self) -> Vec<String> {
        self.file.missing.clone()
    }

    /// The vehicle as a scenario, with numbers of your own by their dotted paths: `{"rotors.lag": 0.03}`.
    ///
    /// `ValueError` names the numbers that are still missing.
    #[pyo3(signature = (changes=None))]
    fn scenario(&self, changes: Option<&Bound<'_, PyDict>>) -> PyResult<Scenario> {
        let mut document: toml_edit::DocumentMut = self.file.text.parse().map_err(refused)?;
        for (path, value) in changes.into_iter().flatten() {
            let path: String =
                path.extract().map_err(|_| refused_field("changes", "keys must be dotted paths, as text"))?;
            change(&mut document, &path, &value)?;
        }
        Scenario::from_text(document.to_string(), self.name.clone())
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    #[allow(clippy::type_complexity)] // what pickle asks for
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String, String, Vec<String>))> {
        let Self { file: Written { text, missing }, name } = slf.get();
        Ok((slf.getattr("_read_before")?, (name.clone(), text.clone(), missing.clone())))
    }

    /// What another object of this class was.
    #[staticmethod]
    fn _read_before(name: String, text: String, missing: Vec<String>) -> Self {
        Self { file: Written { text, missing }, name }
    }

    fn __repr__(&self) -> String {
        format!("<Vehicle {:?}, {} numbers missing>", self.name, self.file.missing.len())
    }
}

/// A Python value, with at most so many `levels` in it.
fn value(python: &Bound<'_, PyAny>, levels: usize) -> PyResult<Value> {
    let Some(levels) = levels.checked_sub(1) else {
        return Err(refused_field("quad_params", "lies too deep in lists and dictionaries"));
    };
    let plain = if python.hasattr("tolist")? { python.call_method0("tolist")? } else { python.clone() };
    if plain.is_instance_of::<PyBool>() {
        Ok(Value::Other)
    } else if plain.is_instance_of::<PyFloat>() || plain.is_instance_of::<PyInt>() {
        Ok(Value::Number(plain.extract().map_err(|_| refused_field("quad_params", format!("too large: {plain}")))?))
    } else if plain.is_instance_of::<PyString>() {
        Ok(plain.extract().map_or(Value::Other, Value::Text))
    } else if plain.is_instance_of::<PyList>() || plain.is_instance_of::<PyTuple>() {
        let elements = plain.try_iter()?.map(|element| value(&element?, levels));
        Ok(Value::List(elements.collect::<PyResult<_>>()?))
    } else if let Ok(dictionary) = plain.cast::<PyDict>() {
        let entry = |(key, held): (Bound<'_, PyAny>, Bound<'_, PyAny>)| Ok((key.to_string(), value(&held, levels)?));
        Ok(Value::Dictionary(dictionary.iter().map(entry).collect::<PyResult<_>>()?))
    } else {
        Ok(Value::Other)
    }
}
