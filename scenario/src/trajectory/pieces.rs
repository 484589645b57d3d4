//! Polynomial pieces as Crazyswarm and `uav_trajectories` write them: a duration (s) and, for x, y, z and yaw, the
//! eight coefficients of a polynomial in the time since the piece began, lowest power first.
//!
//! `duration,x^0,…,x^7,y^0,…,y^7,z^0,…,z^7,yaw^0,…,yaw^7`; the yaw (rad) may be missing. Pieces that others computed
//! need not meet in jerk and snap, so they are read as what they say of position, velocity and acceleration at many
//! instants, and [`super::fit`] finds the smooth path.

use super::row::Row;
use nalgebra::Vector3;

/// Coefficients of one axis.
const COEFFICIENT_COUNT: usize = 8;
/// Between two instants at most, s.
const INTERVAL_MAX_S: f64 = 0.02;
/// The longest of all pieces together, s.
const DURATION_MAX_S: f64 = 1800.0;

/// Rows along the pieces in `lines`, each with its number in the file.
///
/// # Errors
/// Names the line and what is wrong.
pub fn rows(lines: &[(u64, Vec<f64>)]) -> Result<Vec<Row>, String> {
    let mut rows: Vec<Row> = Vec::new();
    let mut start = 0.0;
    for (line, numbers) in lines {
        let (duration, axes) = numbers.split_first().unwrap_or((&0.0, &[]));
        if ![3, 4].contains(&(axes.len() / COEFFICIENT_COUNT)) || axes.len() % COEFFICIENT_COUNT != 0 {
            let found = numbers.len();
            return Err(format!("line {line}: a piece has 25 numbers, or 33 with yaw, found {found}"));
        }
        if *duration <= 0.0 || start + duration > DURATION_MAX_S {
            let problem = "must be positive, all together at most";
            return Err(format!("line {line}, duration: {problem} {DURATION_MAX_S} s, found {duration}"));
        }
        let steps = (duration / INTERVAL_MAX_S).ceil();
        // The end of a piece is the beginning of the next one.
        let first = if rows.is_empty() { 0 } else { 1 };
        for step in first..=steps as u32 {
            let time = duration * f64::from(step) / steps;
            rows.push(row(axes, start + time, time));
        }
        start += duration;
    }
    if rows.is_empty() { Err("has no piece below its header".to_owned()) } else { Ok(rows) }
}

fn row(axes: &[f64], time: f64, since: f64) -> Row {
    let axis = |index: usize| axes.chunks(COEFFICIENT_COUNT).nth(index).map_or([0.0; 3], |axis| evaluated(axis, since));
    let [x, y, z, yaw] = [0, 1, 2, 3].map(axis);
    let [position, velocity, acceleration] = [0, 1, 2].map(|order| Vector3::new(x[order], y[order], z[order]));
    let (velocity, acceleration) = (Some(velocity), Some(acceleration));
    Row { time: Some(time), position, heading: yaw[0], velocity, acceleration, speed: None }
}

/// A polynomial with its first two derivatives, by Horner's rule.
fn evaluated(coefficients: &[f64], time: f64) -> [f64; 3] {
    coefficients
        .iter()
        .rev()
        .fold([0.0; 3], |[p, v, a], coefficient| [p * time + coefficient, v * time + p, a * time + 2.0 * v])
}
