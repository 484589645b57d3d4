//! Moments of inertia as files have them: the three of a diagonal matrix, or the whole matrix if it is diagonal.
//!
//! The law's inertia is diagonal in body axes. A matrix that is not is refused with its principal moments and the
//! angles by which the body axes would have to turn; moments that no body can have, with the sum to take.

use crate::key::{Bounds, Values};
use crate::section::{FieldError, Section, vector_at};
use controller_core::error::{ParameterError, Reason};
use controller_core::vehicle::Vehicle;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use toml::Value;

/// Products of inertia that count as zero, relative to the greatest moment: a file's rounding.
const NEGLIGIBLE_PRODUCT_SHARE: f64 = 1e-6;

/// What a file may write: moments, or a matrix.
pub const VALUES: Values =
    Values::Either(&[Values::Vector(Bounds::physical("kg m^2")), Values::List(&Values::Vector(Bounds::any("kg m^2")))]);

/// Reads the diagonal moments at `key`, kg m^2.
///
/// # Errors
/// If they are neither three numbers nor a symmetric matrix of three rows that is diagonal.
pub fn read(section: &Section, key: &str) -> Result<Vector3<f64>, FieldError> {
    let path = section.path_of(key);
    let is_matrix = |elements: &[(String, &Value)]| elements.iter().any(|(_, value)| value.is_array());
    match section.elements(key, "a list of three numbers, or of three lists of three") {
        Ok(rows) if is_matrix(&rows) => diagonal(&path, &matrix(&path, &rows)?),
        // The rest is said as of any vector.
        _ => section.vector(key),
    }
}

fn matrix(path: &str, rows: &[(String, &Value)]) -> Result<Matrix3<f64>, FieldError> {
    let [x, y, z] = rows else {
        return Err(FieldError::new(path, format!("must be a matrix of three rows, found {}", rows.len())));
    };
    let row = |(path, value): &(String, &Value)| vector_at(path, value).map(|row| row.transpose());
    Ok(Matrix3::from_rows(&[row(x)?, row(y)?, row(z)?]))
}

/// The diagonal of `inertia`, if the rest is zero.
fn diagonal(path: &str, inertia: &Matrix3<f64>) -> Result<Vector3<f64>, FieldError> {
    let negligible = NEGLIGIBLE_PRODUCT_SHARE * inertia.diagonal().amax();
    let differs =
        |&(row, column): &(usize, usize)| (inertia[(row, column)] - inertia[(column, row)]).abs() > negligible;
    if let Some((row, column)) = [(0, 1), (0, 2), (1, 2)].into_iter().find(differs) {
        let (one, other) = (inertia[(row, column)], inertia[(column, row)]);
        let problem = format!(
            "must be symmetric, found [{row}][{column}] = {one} and [{column}][{row}] = {other}; both are the same \
             product of inertia"
        );
        return Err(FieldError::new(path, problem));
    }
    let moments = inertia.diagonal();
    if (inertia - Matrix3::from_diagonal(&moments)).amax() <= negligible {
        return Ok(moments);
    }
    Err(FieldError::new(path, not_diagonal(inertia)))
}

/// The error of a matrix with products of inertia, and its remedy.
fn not_diagonal(inertia: &Matrix3<f64>) -> String {
    const REQUIREMENT: &str = "must be diagonal";
    let Some((moments, axes)) = principal(inertia) else {
        return format!("{REQUIREMENT}, found products of inertia, and no principal axes");
    };
    let listed = moments.map(|moment| format!("{moment:.5e}"));
    let listed = format!("[{}, {}, {}]", listed.x, listed.y, listed.z);
    if moments.min() <= 0.0 {
        return format!(
            "{REQUIREMENT}, and its moments greater than zero; found principal moments {listed}, which no body has"
        );
    }
    let [roll, pitch, yaw] = euler_deg(&axes);
    let turned = format!("write inertia = {listed}, and rotors.position in the turned axes");
    let about = format!("{REQUIREMENT}, found principal moments {listed} about axes turned by");
    if roll.abs().max(pitch.abs()) < 5e-3 {
        return format!("{about} a yaw of {yaw:.2} degrees: turn the body axes by it, {turned}");
    }
    format!(
        "{about} roll {roll:.2}, pitch {pitch:.2}, yaw {yaw:.2} degrees (as initial.euler_deg): turn the body axes by \
         them, {turned}; rotors push along body z, so where that tilts them balance the vehicle first or neglect it"
    )
}

/// The principal moments and their axes in columns, each in the place of the body axis that it is nearest to; none for
/// numbers too large to work with.
fn principal(inertia: &Matrix3<f64>) -> Option<(Vector3<f64>, Matrix3<f64>)> {
    const ITERATIONS_MAX: usize = 1000;
    let size = inertia.amax();
    let found = SymmetricEigen::try_new(inertia / size, f64::EPSILON, ITERATIONS_MAX)?;
    let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let axes = orders.map(|order| right_handed(Matrix3::from_columns(&order.map(|k| found.eigenvectors.column(k)))));
    let (order, axes) = orders.iter().zip(axes).max_by(|(_, a), (_, b)| a.trace().total_cmp(&b.trace()))?;
    let moments = Vector3::from(order.map(|k| found.eigenvalues[k])) * size;
    moments.iter().chain(axes.iter()).all(|value| value.is_finite()).then_some((moments, axes))
}

/// The same axes, each along its body axis rather than against it, as far as a rotation allows.
fn right_handed(mut axes: Matrix3<f64>) -> Matrix3<f64> {
    for k in 0..3 {
        if axes[(k, k)] < 0.0 {
            axes.column_mut(k).neg_mut();
        }
    }
    if axes.determinant() < 0.0 {
        let least = axes.diagonal().imin();
        axes.column_mut(least).neg_mut();
    }
    axes
}

/// Roll, pitch and yaw of Rz(yaw) Ry(pitch) Rx(roll), degrees.
fn euler_deg(rotation: &Matrix3<f64>) -> [f64; 3] {
    let roll = rotation[(2, 1)].atan2(rotation[(2, 2)]);
    let pitch = -rotation[(2, 0)].clamp(-1.0, 1.0).asin();
    let yaw = rotation[(1, 0)].atan2(rotation[(0, 0)]);
    // Without a negative zero.
    [roll, pitch, yaw].map(|angle| angle.to_degrees() + 0.0)
}

/// What is wrong with the `moments` at `path` and which sum to take, if `error` is that no body has them.
#[must_use]
pub fn impossible(path: &str, moments: &Vector3<f64>, error: &ParameterError) -> Option<FieldError> {
    if error.reason != Reason::TriangleInequality {
        return None;
    }
    let axis = moments.imax();
    let (greatest, one, other) = (moments[axis], moments[(axis + 1) % 3], moments[(axis + 2) % 3]);
    let (one, other) = (one.min(other), one.max(other));
    let problem = format!(
        "{}: [{axis}] = {greatest} is {:.1} % above {one} + {other}, and at most {} % are let pass; measure it again \
         or take the sum, {}",
        error.reason,
        100.0 * (greatest / (one + other) - 1.0),
        100.0 * Vehicle::INERTIA_ALLOWANCE,
        (one + other) as f32
    );
    Some(FieldError::new(path, problem))
}

#[cfg(test)]
mod tests;
