//! Rows of time and place from a file of numbers, as many programs write them.
//!
//! | column | | left out |
//! |---|---|---|
//! | `t` | time, s, increasing | only where a speed is given |
//! | `x`, `y`, `z` | position, m, world, z up | refused |
//! | `yaw_deg` or `yaw` | heading, degrees or rad | that of the quaternion, or 0 |
//! | `qw`, `qx`, `qy`, `qz` | attitude, body to world; only its heading is used | all or none |
//! | `vx`, `vy`, `vz` | velocity, m/s | all or none |
//! | `ax`, `ay`, `az` | acceleration, m/s^2 | all or none |
//! | `speed` | the maximum speed up to the next row, m/s | as the scenario says |
//!
//! Or the polynomial pieces that Crazyswarm and the Crazyflie's `uav_trajectories` fly ([`super::pieces`]).
//! [`cells`] finds the cells, `column` knows names and units, and [`super::slips`] what is probably not meant.

mod column;

use super::row::Row;
use super::{pieces, slips};
use crate::cells;
use crate::section::FieldError;
use column::Quantity::{self, Acceleration, Duration, Heading, Position, Quaternion, Speed, Time, Velocity};
use csv::StringRecord;
use nalgebra::{Vector3, Vector4};
use std::collections::BTreeSet;

/// What rows without names hold, by how many cells they have.
const NAMELESS_COLUMNS: [(usize, &str); 4] =
    [(3, "x,y,z"), (8, "t,x,y,z,qx,qy,qz,qw"), (1 + 3 * 8, "duration"), (1 + 4 * 8, "duration")];
/// The most rows of one file.
const ROWS_MAX: usize = 100_000;
/// Two rows at one time that are no farther apart are one, m.
const SAME_PLACE_M: f64 = 1e-3;
/// How far the length of a quaternion may be from 1.
const UNIT_LENGTH_TOLERANCE: f64 = 0.01;
/// The horizontal share of the forward axis below which an attitude has no heading.
const FORWARD_SHARE_MIN: f64 = 0.1;

/// Columns that may say whose a row is.
const VEHICLE_COLUMNS: [&str; 7] = ["id", "drone", "drone_id", "uav", "uav_id", "vehicle", "vehicle_id"];
/// The most names of columns that a remark lists.
const NAMES_LISTED_MAX: usize = 8;

/// The rows of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// In their order.
    pub rows: Vec<Row>,
    /// Whether the header says what times are counted in.
    pub has_time_unit: bool,
    /// What was taken for what, where that does not go without saying.
    pub remarks: Vec<String>,
}

/// A column that is used, or could be.
struct Column<'a> {
    quantity: Quantity,
    name: &'a str,
    /// In s, m and rad; none where the header does not say.
    unit: Option<f64>,
    /// As the file has them; none where a cell is empty.
    values: Vec<Option<f64>>,
}

/// A row's line and cells.
type Line = (u64, StringRecord);

/// Reads `text`; `field` is what errors call it.
///
/// # Errors
/// Names the line, the column, what is wrong and what is allowed.
pub fn read(text: &str, field: &str) -> Result<Table, FieldError> {
    table(text).map_err(|problem| FieldError::new(field, problem))
}

fn table(text: &str) -> Result<Table, String> {
    let cells::Cells { header, rows: lines } =
        cells::read(text, ROWS_MAX, |name| matches!(column::recognised(name), Ok(Some(_))))?;
    let mut remarks = Vec::new();
    let (line, names) = names(header, &lines, &mut remarks)?;
    let refuse = |problem: String| format!("line {line}: {problem}");
    let first = names.first().map_or(Ok(None), |name| column::recognised(name)).map_err(refuse)?;
    if let Some((Duration, unit)) = first {
        if unit.is_some_and(|unit| unit != 1.0) {
            return Err(refuse(format!("column {}: must be in s, as the coefficients are", names[0])));
        }
        let rows = pieces::rows(&numbers(&lines)?)?;
        let slip = slips::degrees_as_radians(rows.iter().map(|row| row.heading));
        remarks
            .extend(slip.map(|most| format!("yaw is in rad, and reaches {most:.1}: divide it by 57.3 if in degrees")));
        return Ok(Table { rows, has_time_unit: unit.is_some(), remarks });
    }
    check_lengths(&lines, names.len())?;
    let (mut columns, mut unused) = (Vec::new(), Vec::new());
    for (place, name) in names.iter().enumerate() {
        match column::recognised(name).map_err(refuse)? {
            Some((quantity, unit)) => {
                let values = lines.iter().map(|row| value(row, place, name)).collect::<Result<_, _>>()?;
                columns.push(Column { quantity, name, unit, values });
            }
            None if is_vehicle(name, place, &lines) => {
                return Err(refuse(format!("column {name} numbers several vehicles: give each a file")));
            }
            None if !name.is_empty() => unused.push(name.as_str()),
            None => {}
        }
    }
    if !unused.is_empty() {
        let more = if unused.len() > NAMES_LISTED_MAX { ", …" } else { "" };
        let listed = unused.iter().take(NAMES_LISTED_MAX).copied().collect::<Vec<_>>().join(", ");
        remarks.push(format!("columns not used: {listed}{more}"));
    }
    columns.retain(|column| column.values.iter().any(Option::is_some));
    complete(&columns, &unused).map_err(refuse)?;
    check_filled(&columns, &lines)?;
    remarks.extend(judged(&mut columns)?);
    let has_time_unit = columns.iter().any(|column| column.quantity == Time && column.unit.is_some());
    Ok(Table { rows: rows(&columns, &lines)?, has_time_unit, remarks })
}

/// The names of columns that stand in the header, or that rows without one have; and their line.
fn names(
    header: Option<(u64, Vec<String>)>,
    lines: &[Line],
    remarks: &mut Vec<String>,
) -> Result<(u64, Vec<String>), String> {
    let (first, record) = lines.first().ok_or("has no row below its header")?;
    if let Some((line, mut names)) = header {
        names.truncate(names.len() - names.iter().rev().take_while(|name| name.is_empty()).count());
        return Ok((line, names));
    }
    let (_, names) = NAMELESS_COLUMNS.iter().find(|(count, _)| *count == filled(record).count()).ok_or_else(|| {
        format!("line {first}: the names of its columns are missing; write them above, such as t,x,y,z")
    })?;
    remarks.push(format!("rows without a header are read as {names}"));
    Ok((*first, names.split(',').map(str::to_owned).collect()))
}

/// Whether a column says whose each row is: it has fewer different cells than rows, but more than one.
fn is_vehicle(name: &str, place: usize, lines: &[Line]) -> bool {
    let whose = lines.iter().map(|(_, row)| row.get(place)).collect::<BTreeSet<_>>();
    VEHICLE_COLUMNS.contains(&name.to_lowercase().as_str()) && (2..lines.len()).contains(&whose.len())
}

/// The rows, times increasing; two at one time and in one place are one.
fn rows(columns: &[Column], lines: &[Line]) -> Result<Vec<Row>, String> {
    let mut rows: Vec<Row> = Vec::with_capacity(lines.len());
    for (number, (line, _)) in lines.iter().enumerate() {
        let row = row(columns, number).map_err(|problem| format!("line {line}{problem}"))?;
        match rows.last() {
            Some(before) if before.time.is_some() && row.time <= before.time => {
                let apart = (row.position - before.position).norm();
                if row.time < before.time || apart > SAME_PLACE_M {
                    let [before, time] = [before.time, row.time].map(Option::unwrap_or_default);
                    return Err(format!("line {line}, column t: must be after {before}, found {time}; leave one out"));
                }
            }
            _ => rows.push(row),
        }
    }
    Ok(rows)
}

/// Refuses rows that do not have a cell for each of so many names.
fn check_lengths(lines: &[Line], names: usize) -> Result<(), String> {
    for (line, row) in lines {
        let hint = match filled(row).count() > names {
            true => "; where decimals have commas, put semicolons between cells",
            false if row.len() < names => "; leave cells empty, but not out",
            false => continue,
        };
        return Err(format!("line {line}: has {} cells, and there are {names} names of columns{hint}", row.len()));
    }
    Ok(())
}

/// The cells of a row up to the last that is not empty.
fn filled(row: &StringRecord) -> impl Iterator<Item = &str> {
    let empty = row.iter().rev().take_while(|cell| cell.is_empty()).count();
    row.iter().take(row.len() - empty)
}

fn value((line, row): &Line, place: usize, name: &str) -> Result<Option<f64>, String> {
    match row.get(place) {
        None | Some("") => Ok(None),
        Some(cell) => match cells::number(cell).filter(|number| number.is_finite()) {
            Some(number) => Ok(Some(number)),
            None => Err(format!("line {line}, column {name}: must be a finite number, found {cell:?}")),
        },
    }
}

/// The rows of pieces, of which each number is needed.
fn numbers(lines: &[Line]) -> Result<Vec<(u64, Vec<f64>)>, String> {
    let number = |line: &Line, place: usize| {
        let name = (place + 1).to_string();
        value(line, place, &name)?.ok_or_else(|| format!("line {}, column {name}: is empty; fill it", line.0))
    };
    let numbers = |line: &Line| {
        Ok((line.0, (0..filled(&line.1).count()).map(|i| number(line, i)).collect::<Result<_, String>>()?))
    };
    lines.iter().map(numbers).collect()
}

/// Refuses what is there twice, and what is there by half.
fn complete(columns: &[Column], unused: &[&str]) -> Result<(), String> {
    for (number, Column { quantity, name, .. }) in columns.iter().enumerate() {
        if let Some(twin) = columns[..number].iter().find(|column| column.quantity == *quantity) {
            return Err(format!("columns {} and {name} both say {}: leave one out", twin.name, quantity.name()));
        }
    }
    let has = |quantity: &Quantity| columns.iter().any(|column| column.quantity == *quantity);
    let groups = [
        ([0, 1, 2].map(Position).to_vec(), true),
        ([0, 1, 2].map(Velocity).to_vec(), false),
        ([0, 1, 2].map(Acceleration).to_vec(), false),
        ([0, 1, 2, 3].map(Quaternion).to_vec(), false),
    ];
    for (group, is_needed) in groups {
        if (is_needed || group.iter().any(has))
            && let Some(missing) = group.iter().find(|quantity| !has(quantity))
        {
            let is_global = unused.iter().any(|name| name.to_lowercase().starts_with("lat"));
            let hint = if is_global { ": latitudes and longitudes become m first, x east, y north, z up" } else { "" };
            return Err(format!("column {} is missing, or empty{hint}", missing.name()));
        }
    }
    Ok(())
}

/// Refuses a cell that is empty where every row needs a number.
fn check_filled(columns: &[Column], lines: &[Line]) -> Result<(), String> {
    for Column { quantity, name, values, .. } in columns {
        if let (Time | Position(_) | Heading | Quaternion(_), Some(empty)) =
            (quantity, values.iter().position(Option::is_none))
        {
            return Err(format!("line {}, column {name}: is empty; fill it, or leave the row out", lines[empty].0));
        }
    }
    Ok(())
}

/// Turns the columns' numbers into s, m and rad, and says where that was a guess.
fn judged(columns: &mut [Column]) -> Result<Vec<String>, String> {
    let mut remarks = Vec::new();
    for Column { quantity, name, unit, values } in columns {
        let numbers = || values.iter().copied().flatten();
        let factor = match (&quantity, &unit) {
            (Time, None) => numbers().next().and_then(slips::since_1970).map(|(unit_name, factor)| {
                remarks.push(format!("column {name} is read as {unit_name} since 1970"));
                *unit = Some(factor);
                factor
            }),
            (Heading, None) => match slips::degrees_as_radians(numbers()) {
                Some(most) => {
                    let problem = "is in rad, and reaches";
                    let remedy = "name it yaw_deg if these are degrees, yaw_rad if not";
                    return Err(format!("column {name}: {problem} {most}: {remedy}"));
                }
                None => None,
            },
            (Heading, Some(factor)) if *factor < 1.0 => {
                remarks.extend(slips::radians_as_degrees(numbers()).map(|slip| format!("column {name}: {slip}")));
                *unit
            }
            _ => *unit,
        };
        let factor = factor.unwrap_or(1.0);
        values.iter_mut().flatten().for_each(|value| *value *= factor);
    }
    Ok(remarks)
}

/// The row of a number; an error begins with the place in its line.
fn row(columns: &[Column], number: usize) -> Result<Row, String> {
    let value = |quantity: Quantity| columns.iter().find(|column| column.quantity == quantity)?.values[number];
    let vector = |quantity: fn(usize) -> Quantity| {
        Some(Vector3::new(value(quantity(0))?, value(quantity(1))?, value(quantity(2))?))
    };
    let quaternion = || {
        let [w, x, y, z] = [0, 1, 2, 3].map(|component| value(Quaternion(component)));
        Some(Vector4::new(w?, x?, y?, z?))
    };
    let heading = match (value(Heading), quaternion()) {
        (Some(heading), _) => heading,
        (None, Some(quaternion)) => heading(&quaternion)?,
        (None, None) => 0.0,
    };
    let speed = value(Speed);
    if speed.is_some_and(|speed| speed <= 0.0) {
        return Err(", column speed: must be positive; to wait, give times".to_owned());
    }
    Ok(Row {
        time: value(Time),
        position: vector(Position).unwrap_or_default(),
        heading,
        velocity: vector(Velocity),
        acceleration: vector(Acceleration),
        speed,
    })
}

/// Of an attitude (w, x, y, z), rad.
fn heading(quaternion: &Vector4<f64>) -> Result<f64, String> {
    let length = quaternion.norm();
    if (length - 1.0).abs() > UNIT_LENGTH_TOLERANCE {
        return Err(format!(": its quaternion must have length 1, found {length:.3}"));
    }
    let [w, x, y, z] = (*quaternion / length).into();
    let forward = [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z)];
    if forward[0].hypot(forward[1]) < FORWARD_SHARE_MIN {
        return Err(": its attitude points up or down, and has no heading; give a yaw, or no quaternions".to_owned());
    }
    Ok(forward[1].atan2(forward[0]))
}
