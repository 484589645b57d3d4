//! Rows of time and place from a file: comma-separated values whose first line names the columns.
//!
//! | column | | |
//! |---|---|---|
//! | `t` | time, s, increasing; may be missing where a speed is given | needed |
//! | `x`, `y`, `z` | position, m, world, z up | needed |
//! | `yaw_deg` or `yaw` | heading, degrees or rad | 0 |
//! | `vx`, `vy`, `vz` | velocity, m/s | all or none |
//! | `ax`, `ay`, `az` | acceleration, m/s^2 | all or none |
//! | `speed` | the greatest speed up to the next row, m/s | as the scenario says |
//!
//! Or the polynomial pieces that Crazyswarm and the Crazyflie's `uav_trajectories` fly ([`super::pieces`]). Lines that
//! begin with `#` are comments.

use super::pieces;
use super::row::Row;
use crate::section::FieldError;
use nalgebra::Vector3;

/// The columns that may be there, with other names for them.
const COLUMNS: [(&str, &[&str]); 13] = [
    ("t", &["time", "time_s", "t_s"]),
    ("x", &["px", "pos_x", "position_x"]),
    ("y", &["py", "pos_y", "position_y"]),
    ("z", &["pz", "pos_z", "position_z"]),
    ("yaw_deg", &["heading_deg"]),
    ("yaw", &["yaw_rad", "psi", "heading"]),
    ("vx", &["vel_x", "velocity_x"]),
    ("vy", &["vel_y", "velocity_y"]),
    ("vz", &["vel_z", "velocity_z"]),
    ("ax", &["acc_x", "acceleration_x"]),
    ("ay", &["acc_y", "acceleration_y"]),
    ("az", &["acc_z", "acceleration_z"]),
    ("speed", &["speed_m_s", "v_max"]),
];

/// The most rows of one file.
const MOST_ROWS: usize = 100_000;

/// Reads `text`; `field` is what errors call it.
///
/// # Errors
/// Names the line, the column, what is wrong and what is allowed.
pub fn read(text: &str, field: &str) -> Result<Vec<Row>, FieldError> {
    let refuse = |problem: String| FieldError::new(field, problem);
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let headers = reader.headers().map_err(|error| refuse(error.to_string()))?.clone();
    let names: Vec<String> = headers.iter().map(str::to_lowercase).collect();
    let mut lines = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| refuse(error.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        let mut numbers = Vec::with_capacity(record.len());
        for (name, value) in names.iter().zip(&record) {
            let number: f64 = value.parse().unwrap_or(f64::NAN);
            if !number.is_finite() {
                return Err(refuse(format!("line {line}, column {name}: must be a finite number, found {value:?}")));
            }
            numbers.push(number);
        }
        lines.push((line, numbers));
        if lines.len() > MOST_ROWS {
            return Err(refuse(format!("has more than {MOST_ROWS} rows; leave out what a path does not need")));
        }
    }
    if names.first().is_some_and(|name| name == "duration") {
        return pieces::rows(&lines).map_err(refuse);
    }
    let column = columns(&names).map_err(refuse)?;
    let rows: Vec<Row> = lines.iter().map(|(_, numbers)| row(numbers, &column)).collect();
    for (pair, (line, _)) in rows.windows(2).zip(lines.iter().skip(1)) {
        if let [Row { time: Some(before), .. }, Row { time: Some(time), .. }] = pair
            && time <= before
        {
            return Err(refuse(format!("line {line}, column t: must be after {before}, found {time}")));
        }
    }
    for (row, (line, _)) in rows.iter().zip(&lines) {
        if row.speed.is_some_and(|speed| speed <= 0.0) {
            return Err(refuse(format!("line {line}, column speed: must be positive; to wait, give times")));
        }
    }
    if rows.is_empty() { Err(refuse("has no row below its header".to_owned())) } else { Ok(rows) }
}

/// Where each of [`COLUMNS`] stands.
type Places = [Option<usize>; COLUMNS.len()];

/// Finds the columns, refusing unknown ones and halves of a vector.
fn columns(names: &[String]) -> Result<Places, String> {
    let mut places: Places = [None; COLUMNS.len()];
    for (place, name) in names.iter().enumerate() {
        let known = COLUMNS.iter().position(|(own, others)| own == name || others.contains(&name.as_str()));
        let Some(known) = known else {
            let all = COLUMNS.map(|(own, _)| own).join(", ");
            return Err(format!("line 1: unknown column {name:?} (allowed: {all}; or pieces: duration, x^0, …)"));
        };
        if places[known].replace(place).is_some() {
            return Err(format!("line 1: column {name} stands there twice"));
        }
    }
    let has = |index: usize| places[index].is_some();
    for (group, needed) in [([1, 2, 3], true), ([6, 7, 8], false), ([9, 10, 11], false)] {
        if (needed || group.into_iter().any(has))
            && let Some(missing) = group.into_iter().find(|index| !has(*index))
        {
            return Err(format!("line 1: column {} is missing", COLUMNS[missing].0));
        }
    }
    Ok(places)
}

fn row(numbers: &[f64], places: &Places) -> Row {
    let number = |index: usize| places[index].and_then(|place| numbers.get(place)).copied();
    let vector = |[x, y, z]: [usize; 3]| Some(Vector3::new(number(x)?, number(y)?, number(z)?));
    Row {
        time: number(0),
        position: vector([1, 2, 3]).unwrap_or_default(),
        heading: number(4).map(f64::to_radians).or_else(|| number(5)).unwrap_or(0.0),
        velocity: vector([6, 7, 8]),
        acceleration: vector([9, 10, 11]),
        speed: number(12),
    }
}
