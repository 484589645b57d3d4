//! A campaign's flights as columns, in Apache Arrow's file format: one record batch for each chunk of flights, nothing
//! compressed.
//!
//! Arrow and not Parquet, for two reasons. The bytes of a file depend on its rows alone: nothing is compressed, no
//! encoder chooses, and no library writes its version into it. And readers map it as it lies: pyarrow, polars, pandas,
//! R and DuckDB open it.
//!
//! | column | unit | |
//! |---|---|---|
//! | `number` | | of the flight |
//! | `hover` | | whether it was to hover at the origin; otherwise to fly the file's reference |
//! | `start_px` … `start_wz` | m, m/s, -, rad/s | position, velocity, attitude (scalar first), body rates |
//! | `wind_x`, `wind_y` | m/s | steady wind |
//! | `gust_x`, `gust_y` | m/s | its step, zero for none |
//! | `height_lost`, `rise`, `final_error` | m | [`Outcome`] |
//! | `settled`, `attitude`, `heading` | s | since when it has been near its reference, attitude and heading; null where it was away at the end |
//! | `share_thrust`, `share_torque_x` …, `share_rotor_1` … | | greatest part of each certified bound |
//! | `clipped`, `beyond`, `ticks` | ticks | |
//! | `fallback` | | how often the extended law's fallback came |
//! | `verdict` | | `holds`, `away`, `late` or `beyond`; nothing is proven of another law's commands, so it is never `beyond` |
//! | `failed_rotor`, `found_rotor` | | which rotor failed, from 1, and which one the law took for lost; null for none |
//! | `failure_time`, `found_time` | s | when; null for none |
//! | `thrust_left` | | what the failed rotor had left; null for none |
//! | `failure_height_lost`, `failure_distance` | m | after the failure ([`RotorLoss`]); null for none |
//! | `least_command` | | least command of any rotor, part of a full one; null without rotors |
//!
//! A file of another law than ours says which in its schema's metadata, under `law`.

use super::manifest::Manifest;
use super::outcome::Outcome;
use super::rotor_loss::RotorLoss;
use arrow_array::builder::Float64Builder;
use arrow_array::{ArrayRef, BooleanArray, Float64Array, RecordBatch, StringArray, UInt64Array};
use arrow_schema::{ArrowError, DataType, Field, Schema};
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::body::BodyState;
use scenario::reference::ReferenceKind;
use std::sync::Arc;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlightRow {
    pub number: u64,
    /// Whether it was to hover at the origin.
    pub hover: bool,
    /// Where it started.
    pub start: BodyState,
    /// Steady wind and gust, m/s, world.
    pub wind: [Vector3<f64>; 2],
    /// Its figures.
    pub outcome: Outcome,
}

/// The law's key in the metadata.
const LAW_KEY: &str = "law";

impl FlightRow {
    /// Flight `number`, in the circumstances of `thrown`.
    pub fn new(number: u64, thrown: &Scenario, outcome: Outcome) -> Self {
        let wind = thrown.reality.wind.unwrap_or_default();
        Self {
            number,
            hover: matches!(thrown.reference, ReferenceKind::Hover { .. }),
            start: thrown.initial,
            wind: [wind.steady, wind.gust.map_or_else(Vector3::zeros, |gust| gust.velocity)],
            outcome,
        }
    }
}

impl Outcome {
    /// In a word; whether the bounds were kept counts where they are `proven` of the law that flew.
    pub fn verdict(&self, proven: bool) -> &'static str {
        let reached = self.settled.is_some() && self.attitude.is_some() && self.heading.is_some();
        // A flight without a rotor is held to its place at the end, so it cannot be late.
        let there = if self.rotor.failure.is_some() { self.tracks() } else { reached };
        match (proven && self.beyond > 0, there) {
            (true, _) => BEYOND_COLUMN,
            (false, false) => AWAY_COLUMN,
            (false, true) if self.tracks() => HOLDS_COLUMN,
            (false, true) => LATE_COLUMN,
        }
    }
}

/// Recovered, tracked, and commanded nothing beyond a bound.
pub const HOLDS_COLUMN: &str = "holds";
/// Was not near its reference, attitude or heading at the end.
pub const AWAY_COLUMN: &str = "away";
/// Came near them for good, but too late to have recovered ([`Outcome::in_time`]).
pub const LATE_COLUMN: &str = "late";
/// Commanded more than is proven.
pub const BEYOND_COLUMN: &str = "beyond";

const START_COLUMNS: [&str; 13] = [
    "start_px", "start_py", "start_pz", "start_vx", "start_vy", "start_vz", "start_qw", "start_qx", "start_qy",
    "start_qz", "start_wx", "start_wy", "start_wz",
];
const WIND_COLUMNS: [&str; 4] = ["wind_x", "wind_y", "gust_x", "gust_y"];
const FIGURE_COLUMNS: [&str; 3] = ["height_lost", "rise", "final_error"];
const REACHED_COLUMNS: [&str; 3] = ["settled", "attitude", "heading"];
const ROTOR_COLUMNS: [&str; 2] = ["failed_rotor", "found_rotor"];
const LOSS_COLUMNS: [&str; 5] =
    ["failure_time", "thrust_left", "found_time", "failure_height_lost", "failure_distance"];
/// The column of the least command of any rotor.
pub const LEAST_COMMAND_COLUMN: &str = "least_command";
const SHARE_COLUMNS: [&str; 4] = ["share_thrust", "share_torque_x", "share_torque_y", "share_torque_z"];

/// The columns of what `manifest` describes.
pub fn schema(manifest: &Manifest) -> Schema {
    let number = |name: &str| Field::new(name, DataType::Float64, false);
    let count = |name: &str| Field::new(name, DataType::UInt64, false);
    let mut fields = vec![count("number"), Field::new("hover", DataType::Boolean, false)];
    fields.extend(START_COLUMNS.iter().chain(&WIND_COLUMNS).chain(&FIGURE_COLUMNS).map(|name| number(name)));
    fields.extend(REACHED_COLUMNS.iter().map(|name| Field::new(*name, DataType::Float64, true)));
    fields.extend(SHARE_COLUMNS.iter().map(|name| number(name)));
    fields.extend((1..=manifest.rotors as usize).map(|rotor| number(&share_of_rotor(rotor))));
    fields.extend(["clipped", "beyond", "fallback", "ticks"].map(count));
    fields.push(Field::new("verdict", DataType::Utf8, false));
    fields.extend(ROTOR_COLUMNS.iter().map(|name| Field::new(*name, DataType::UInt64, true)));
    fields.extend(LOSS_COLUMNS.iter().map(|name| Field::new(*name, DataType::Float64, true)));
    fields.push(Field::new(LEAST_COMMAND_COLUMN, DataType::Float64, true));
    let schema = Schema::new(fields);
    match manifest.rival() {
        Some(law) => schema.with_metadata([(LAW_KEY.to_owned(), law.to_owned())]),
        None => schema,
    }
}

/// The column of a rotor's share, numbered from 1.
pub fn share_of_rotor(rotor: usize) -> String {
    format!("share_rotor_{rotor}")
}

/// The rows, of what `manifest` describes, as a record batch.
///
/// # Errors
/// As Arrow's: none for rows of that vehicle.
pub fn batch(rows: &[FlightRow], manifest: &Manifest) -> Result<RecordBatch, ArrowError> {
    let numbers = |value: &dyn Fn(&FlightRow) -> f64| -> ArrayRef {
        Arc::new(Float64Array::from_iter_values(rows.iter().map(value)))
    };
    let counts =
        |value: fn(&FlightRow) -> u64| -> ArrayRef { Arc::new(UInt64Array::from_iter_values(rows.iter().map(value))) };
    let mut columns = vec![counts(|row| row.number)];
    columns.push(Arc::new(BooleanArray::from_iter(rows.iter().map(|row| Some(row.hover)))));
    columns.extend((0..START_COLUMNS.len()).map(|index| numbers(&|row| start(&row.start)[index])));
    columns.extend((0..WIND_COLUMNS.len()).map(|index| numbers(&|row| row.wind[index / 2][index % 2])));
    columns.push(numbers(&|row| row.outcome.height_lost));
    columns.push(numbers(&|row| row.outcome.rise));
    columns.push(numbers(&|row| row.outcome.final_error));
    columns.extend(REACHED_OF.map(|since| optional(rows, |row| since(&row.outcome))));
    columns.push(numbers(&|row| row.outcome.shares.thrust));
    columns.extend((0..3).map(|axis| numbers(&|row| row.outcome.shares.torque[axis])));
    columns.extend((0..manifest.rotors as usize).map(|rotor| numbers(&|row| row.outcome.shares.rotors[rotor])));
    columns.extend([
        counts(|row| row.outcome.clipped),
        counts(|row| row.outcome.beyond),
        counts(|row| row.outcome.fallback),
        counts(|row| row.outcome.ticks),
    ]);
    let proven = manifest.rival().is_none();
    columns.push(Arc::new(StringArray::from_iter_values(rows.iter().map(|row| row.outcome.verdict(proven)))));
    columns.extend(ROTORS_OF.map(|rotor| -> ArrayRef {
        let numbers = rows.iter().map(|row| rotor(&row.outcome.rotor).map(|rotor| rotor as u64 + 1));
        Arc::new(UInt64Array::from_iter(numbers))
    }));
    columns.extend(LOSS_OF.map(|figure| optional(rows, |row| figure(&row.outcome.rotor))));
    columns.push(optional(rows, |row| row.outcome.least_command.least()));
    RecordBatch::try_new(Arc::new(schema(manifest)), columns)
}

/// [`REACHED_COLUMNS`], of an outcome.
const REACHED_OF: [fn(&Outcome) -> Option<f64>; 3] =
    [|outcome| outcome.settled, |outcome| outcome.attitude, |outcome| outcome.heading];

/// [`ROTOR_COLUMNS`], of a flight.
const ROTORS_OF: [fn(&RotorLoss) -> Option<usize>; 2] = [|loss| Some(loss.failure?.rotor), |loss| Some(loss.found?.0)];

/// [`LOSS_COLUMNS`], of a flight.
const LOSS_OF: [fn(&RotorLoss) -> Option<f64>; 5] = [
    |loss| Some(loss.failure?.time),
    |loss| Some(loss.failure?.thrust_left),
    |loss| Some(loss.found?.1),
    |loss| loss.failure.map(|_| loss.height_lost),
    |loss| loss.failure.map(|_| loss.distance),
];

fn optional(rows: &[FlightRow], value: impl Fn(&FlightRow) -> Option<f64>) -> ArrayRef {
    let mut column = Float64Builder::with_capacity(rows.len());
    for row in rows {
        column.append_option(value(row));
    }
    Arc::new(column.finish())
}

fn start(state: &BodyState) -> [f64; 13] {
    let BodyState { position: p, velocity: v, attitude: q, angular_velocity: w } = state;
    [p.x, p.y, p.z, v.x, v.y, v.z, q.w, q.i, q.j, q.k, w.x, w.y, w.z]
}
