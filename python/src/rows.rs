//! Arrays as states, references and wrenches, and back. One row each; the columns, SI units, rad:
//!
//! ```text
//! state      13   p(3) v(3) world, z up | q(4) scalar first, body to world | omega(3) body
//! reference  19   p_d(3) v(3) a(3) j(3) s(3) world | nu_x nu_y (unit) | psi' psi''
//! acceleration 3  v'(3) world, by an accelerometer; NaN without one
//! wrench      4   thrust along body z | torque(3) body
//! demand      4   acceleration(3) world | yaw rate
//!             5   q(4) scalar first, body to world | thrust
//! rotors      4   speeds in [-1, 1]: front right, back right, back left, front left
//! ```
//!
//! The order of `log.csv`. A heading is a direction, as everywhere, so that a row gives a reference back bit for bit.

use crate::errors::{refused, refused_field};
use controller_core::extended::measured::Measured;
use controller_core::heading::Heading;
use controller_core::reference::Reference;
use controller_core::shield::Demand;
use controller_core::state::{State, Wrench};
use nalgebra::{Quaternion, Vector2, Vector3};
use numpy::{
    AllowTypeChange, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayLikeDyn, PyArrayMethods, PyUntypedArray,
    PyUntypedArrayMethods, get_array_module,
};
use pyo3::prelude::*;
use scenario::body::{BodyState, attitude_from_euler};

/// Columns of a state.
pub const STATE_COLUMNS: usize = 13;
/// Columns of a reference.
pub const REFERENCE_COLUMNS: usize = 19;
/// Columns of a wrench.
pub const WRENCH_COLUMNS: usize = 4;

/// Rows of `N` numbers each.
pub type Rows<const N: usize> = Vec<[f64; N]>;

/// The numbers of `array` and its shape.
fn numbers(array: &Bound<'_, PyAny>, field: &str) -> PyResult<(Vec<f64>, Vec<usize>)> {
    let other = |_| refused_field(field, "must be an array of numbers");
    let given = match array.cast::<PyUntypedArray>() {
        Ok(given) => given.clone(),
        Err(_) => {
            let made = get_array_module(array.py())?.call_method1("asarray", (array,)).map_err(other)?;
            made.cast_into::<PyUntypedArray>().map_err(|error| other(error.into()))?
        }
    };
    // numpy would make numbers of more: of dates, of texts, of None, of the real part of complex ones.
    let kind = given.dtype();
    if !matches!(kind.kind(), b'b' | b'i' | b'u' | b'f') {
        return Err(refused_field(field, format!("must be an array of numbers, found one of {kind}")));
    }
    let read: PyArrayLikeDyn<'_, f64, AllowTypeChange> = given.as_any().extract().map_err(other)?;
    Ok((read.as_array().iter().copied().collect(), read.shape().to_vec()))
}

/// The numbers of an array whose shape `fits`, as `allowed` says.
fn shaped(array: &Bound<'_, PyAny>, field: &str, allowed: &str, fits: impl Fn(&[usize]) -> bool) -> PyResult<Vec<f64>> {
    let (values, shape) = numbers(array, field)?;
    if fits(&shape) {
        return Ok(values);
    }
    let sizes: Vec<String> = shape.iter().map(usize::to_string).collect();
    let found = if let [size] = sizes.as_slice() { format!("({size},)") } else { format!("({})", sizes.join(", ")) };
    Err(refused_field(field, format!("must have shape {allowed}, found {found}")))
}

/// One row.
///
/// # Errors
/// Names `field` if it has another shape.
pub fn row<const N: usize>(array: &Bound<'_, PyAny>, field: &str) -> PyResult<[f64; N]> {
    let values = shaped(array, field, &format!("({N},)"), |shape| *shape == [N])?;
    Ok(core::array::from_fn(|place| values[place]))
}

/// So many rows.
///
/// # Errors
/// Names `field` if it has another shape.
pub fn rows<const N: usize>(array: &Bound<'_, PyAny>, count: usize, field: &str) -> PyResult<Rows<N>> {
    let values = shaped(array, field, &format!("({count}, {N})"), |shape| *shape == [count, N])?;
    Ok(values.as_chunks().0.to_vec())
}

/// Rows of any number.
///
/// # Errors
/// Names `field` if it has another shape.
pub fn counted<const N: usize>(array: &Bound<'_, PyAny>, field: &str) -> PyResult<Rows<N>> {
    let values = shaped(array, field, &format!("(n, {N})"), |shape| matches!(shape, [_, columns] if *columns == N))?;
    Ok(values.as_chunks().0.to_vec())
}

/// So many rows of so many numbers, one row after another.
///
/// # Errors
/// Names `field` if it has another shape.
pub fn wide_rows(array: &Bound<'_, PyAny>, count: usize, columns: usize, field: &str) -> PyResult<Vec<f64>> {
    shaped(array, field, &format!("({count}, {columns})"), |shape| *shape == [count, columns])
}

/// One row, or rows of any number.
///
/// # Errors
/// Names `field` if it has another shape.
pub fn one_or_more<const N: usize>(array: &Bound<'_, PyAny>, field: &str) -> PyResult<Rows<N>> {
    let fits = |shape: &[usize]| matches!(shape, [columns] | [_, columns] if *columns == N);
    let values = shaped(array, field, &format!("({N},) or (n, {N})"), fits)?;
    Ok(values.as_chunks().0.to_vec())
}

/// Numbers of any count.
///
/// # Errors
/// Names `field` if it is not one-dimensional.
pub fn vector(array: &Bound<'_, PyAny>, field: &str) -> PyResult<Vec<f64>> {
    shaped(array, field, "(n,)", |shape| shape.len() == 1)
}

/// Rows as an array.
pub fn array<'py, T: numpy::Element, const N: usize>(
    py: Python<'py>,
    rows: Vec<[T; N]>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let count = rows.len();
    PyArray1::from_vec(py, rows.into_iter().flatten().collect()).reshape([count, N])
}

/// Three of the numbers of a row, from `first` on.
fn three<const N: usize>(row: &[f64; N], first: usize) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| row[first + axis])
}

/// The vehicle's state.
pub fn body(row: &[f64; STATE_COLUMNS]) -> BodyState {
    BodyState {
        position: three(row, 0),
        velocity: three(row, 3),
        attitude: Quaternion::new(row[6], row[7], row[8], row[9]),
        angular_velocity: three(row, 10),
    }
}

/// The law's input state.
pub fn measured(row: &[f64; STATE_COLUMNS]) -> State {
    body(row).measured()
}

/// What an accelerometer says beside a state, m/s^2, world: nothing where it is not finite.
pub fn felt(row: &[f64; 3]) -> Measured {
    let acceleration = Some(three(row, 0).map(|value| value as f32));
    Measured {
        acceleration: acceleration.filter(|felt| felt.iter().all(|value| value.is_finite())),
        ..Measured::default()
    }
}

/// A state as a row.
pub fn of_body(state: &BodyState) -> [f64; STATE_COLUMNS] {
    let (p, v, q, w) = (&state.position, &state.velocity, &state.attitude, &state.angular_velocity);
    [p.x, p.y, p.z, v.x, v.y, v.z, q.w, q.i, q.j, q.k, w.x, w.y, w.z]
}

/// The law's input state as a row.
pub fn of_measured(state: &State) -> [f64; STATE_COLUMNS] {
    let State { position, velocity, attitude, angular_velocity } = state;
    of_body(&BodyState {
        position: position.cast(),
        velocity: velocity.cast(),
        attitude: Quaternion::from(attitude.coords.cast()),
        angular_velocity: angular_velocity.cast(),
    })
}

/// The reference of a row.
///
/// # Errors
/// If its heading is invalid.
pub fn reference_of(row: &[f64; REFERENCE_COLUMNS]) -> Result<Reference, controller_core::error::ParameterError> {
    let single = |first| three(row, first).map(|value| value as f32);
    let direction = Vector2::new(row[15] as f32, row[16] as f32);
    let (rate, acceleration) = (row[17] as f32, row[18] as f32);
    let heading =
        Heading::restored(direction, rate, acceleration).or_else(|_| Heading::new(direction, rate, acceleration))?;
    let (position, velocity, acceleration) = (single(0), single(3), single(6));
    Ok(Reference { position, velocity, acceleration, jerk: single(9), snap: single(12), heading })
}

/// A reference as a row.
pub fn of_reference(reference: &Reference) -> [f32; REFERENCE_COLUMNS] {
    let Reference { position, velocity, acceleration, jerk, snap, heading } = reference;
    let mut row = [0.0; REFERENCE_COLUMNS];
    for (place, vector) in [position, velocity, acceleration, jerk, snap].into_iter().enumerate() {
        row[3 * place..3 * place + 3].copy_from_slice(vector.as_slice());
    }
    let direction = heading.direction();
    row[15..].copy_from_slice(&[direction.x, direction.y, heading.rate(), heading.acceleration()]);
    row
}

/// The wrench of a row.
///
/// # Errors
/// If a number is not finite in single precision.
pub fn wrench(row: &[f64; WRENCH_COLUMNS]) -> Result<Wrench, &'static str> {
    let single = row.map(|value| value as f32);
    if single.iter().all(|value| value.is_finite()) {
        Ok(Wrench { thrust: single[0], torque: Vector3::new(single[1], single[2], single[3]) })
    } else {
        Err("wrench: must be finite")
    }
}

/// The wrenches of so many rows.
///
/// # Errors
/// Names the row, or the field if it has another shape.
pub fn wrench_rows(array: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<Wrench>> {
    let given = rows::<WRENCH_COLUMNS>(array, count, "wrenches")?;
    let each = given.iter().enumerate().map(|(number, row)| wrench(row).map_err(|problem| (number, problem)));
    each.collect::<Result<_, _>>().map_err(|(number, problem)| refused(format!("row {number}: {problem}")))
}

/// The demand of a row of 4 or 5 numbers.
fn demand(row: &[f64]) -> Option<Demand> {
    let single: Vec<f32> = row.iter().map(|value| *value as f32).collect();
    match *single {
        [x, y, z, yaw_rate] => Some(Demand::Acceleration { acceleration: Vector3::new(x, y, z), yaw_rate }),
        [w, x, y, z, thrust] => Some(Demand::Attitude { attitude: Quaternion::new(w, x, y, z), thrust }),
        _ => None,
    }
}

/// One demand.
///
/// # Errors
/// Names `field` if it has another shape.
pub fn demand_row(array: &Bound<'_, PyAny>, field: &str) -> PyResult<Demand> {
    let values = shaped(array, field, "(4,) or (5,)", |shape| matches!(shape, [4 | 5]))?;
    demand(&values).ok_or_else(|| refused_field(field, "must have shape (4,) or (5,)"))
}

/// The demands of so many rows.
///
/// # Errors
/// Names `field` if it has another shape.
pub fn demand_rows(array: &Bound<'_, PyAny>, count: usize, field: &str) -> PyResult<Vec<Demand>> {
    let allowed = format!("({count}, 4) or ({count}, 5)");
    let values = shaped(array, field, &allowed, |shape| matches!(shape, [rows, 4 | 5] if *rows == count))?;
    Ok(values.chunks_exact(if values.len() == 4 * count { 4 } else { 5 }).filter_map(demand).collect())
}

/// The speeds of rotors that a row demands.
pub fn of_rotors(row: &[f64; 4]) -> Demand {
    Demand::Rotors { speeds: row.map(|speed| speed as f32) }
}

/// A wrench as a row.
pub fn of_wrench(wrench: &Wrench) -> [f32; WRENCH_COLUMNS] {
    [wrench.thrust, wrench.torque.x, wrench.torque.y, wrench.torque.z]
}

/// A vector argument; zero where it is left out.
fn or_zero(argument: Option<&Bound<'_, PyAny>>, field: &str) -> PyResult<Vector3<f64>> {
    argument.map_or(Ok(Vector3::zeros()), |array| Ok(row::<3>(array, field)?.into()))
}

/// A state (13,): (3,) m, (3,) m/s world, (4,) scalar first, (3,) rad/s body. What is left out: at rest at the origin,
/// level, facing world x. `euler` (3,) instead of `attitude`: roll, pitch, yaw in rad, R = Rz(yaw) Ry(pitch) Rx(roll).
#[pyfunction]
#[pyo3(signature = (position=None, velocity=None, attitude=None, angular_velocity=None, *, euler=None))]
pub fn state<'py>(
    py: Python<'py>,
    position: Option<&Bound<'py, PyAny>>,
    velocity: Option<&Bound<'py, PyAny>>,
    attitude: Option<&Bound<'py, PyAny>>,
    angular_velocity: Option<&Bound<'py, PyAny>>,
    euler: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let attitude = match (attitude, euler) {
        (Some(_), Some(_)) => return Err(refused_field("euler", "attitude is given already; leave one of them out")),
        (Some(attitude), None) => {
            let [w, i, j, k] = row::<4>(attitude, "attitude")?;
            Quaternion::new(w, i, j, k)
        }
        (None, Some(euler)) => {
            let [roll, pitch, yaw] = row::<3>(euler, "euler")?;
            attitude_from_euler(roll, pitch, yaw)
        }
        (None, None) => Quaternion::identity(),
    };
    let state = BodyState {
        position: or_zero(position, "position")?,
        velocity: or_zero(velocity, "velocity")?,
        attitude,
        angular_velocity: or_zero(angular_velocity, "angular_velocity")?,
    };
    Ok(PyArray1::from_slice(py, &of_body(&state)))
}

/// A reference (19,), world: (3,) each, in m to m/s^4; rad, rad/s, rad/s^2. What is left out is zero.
#[pyfunction]
#[pyo3(signature = (position=None, velocity=None, acceleration=None, jerk=None, snap=None, yaw=0.0, yaw_rate=0.0, yaw_acceleration=0.0))]
#[allow(clippy::too_many_arguments)] // its user names them
pub fn reference<'py>(
    py: Python<'py>,
    position: Option<&Bound<'py, PyAny>>,
    velocity: Option<&Bound<'py, PyAny>>,
    acceleration: Option<&Bound<'py, PyAny>>,
    jerk: Option<&Bound<'py, PyAny>>,
    snap: Option<&Bound<'py, PyAny>>,
    yaw: f64,
    yaw_rate: f64,
    yaw_acceleration: f64,
) -> PyResult<Bound<'py, PyArray1<f32>>> {
    let single = |argument, field| Ok::<_, PyErr>(or_zero(argument, field)?.map(|value| value as f32));
    let direction = Vector2::new(yaw.cos() as f32, yaw.sin() as f32);
    let heading = Heading::new(direction, yaw_rate as f32, yaw_acceleration as f32).map_err(refused)?;
    let reference = Reference {
        position: single(position, "position")?,
        velocity: single(velocity, "velocity")?,
        acceleration: single(acceleration, "acceleration")?,
        jerk: single(jerk, "jerk")?,
        snap: single(snap, "snap")?,
        heading,
    };
    Ok(PyArray1::from_slice(py, &of_reference(&reference)))
}
