//! Which column of a recorded flight is what: a few lines of TOML.
//!
//! ```toml
//! axes = "z-up"                # or "z-down": north, east, down and forward, right, down
//! loop_rate = 500              # Hz, of the loop that wrote the commands; may be left out
//!
//! [time]
//! column = "t"
//! unit = "s"                   # s, ms, us or ns
//!
//! [pose]                       # by motion capture
//! position = ["px", "py", "pz"]
//! unit = "m"                   # m, cm or mm
//! attitude = ["qw", "qx", "qy", "qz"]   # or three Euler angles roll, pitch, yaw; or nine of a matrix, row by row
//! angle = "rad"                # of Euler angles: rad or deg
//!
//! [imu]
//! rates = ["gyro_x", "gyro_y", "gyro_z"]
//! rates_unit = "rad/s"         # or deg/s
//! force = ["acc_x", "acc_y", "acc_z"]   # what an accelerometer shows: +1 g along z at rest
//! force_unit = "m/s^2"         # or g, or mg
//!
//! [motors]                     # in the order of the scenario's rotors
//! columns = ["m1", "m2", "m3", "m4"]
//! unit = "share"               # of a full command; or rad/s or rpm, measured; or N
//! full = 65535                 # a full command, of shares
//! zero = 0                     # where a rotor gives no thrust
//! battery = "vbat"             # V; thrust then goes with the square of command times voltage
//! full_voltage = 4.2           # V, at which a full command gives the scenario's greatest thrust
//!
//! [estimate]                   # the vehicle's own filter
//! [setpoint]                   # position, and yaw = "…"
//! ```
//!
//! A name with a minus before it is taken with the other sign. Each section may have a `file` of its own, beside the
//! first, its own `time` and `time_unit`, and an `offset`, s, which is added to its times.

use controller_core::allocation::geometry::ROTORS_MAX;
use scenario::section::{FieldError, Section};
use std::collections::BTreeSet;
use std::f64::consts::PI;
use toml::Value;

/// The map of NanoBench's files, which is built in.
pub const NANOBENCH: &str = include_str!("../../../tests/real_flights/nanobench.toml");

/// A column: its name, and what its numbers become: (number - zero) * factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// As the file has it.
    pub name: String,
    /// In the file's numbers.
    pub zero: f64,
    /// To SI units.
    pub factor: f64,
}

/// Some columns of one file, with that of their times.
#[derive(Debug, Clone, PartialEq)]
pub struct Stream {
    /// Beside the first file; none for the first itself.
    pub file: Option<String>,
    /// Of the rows.
    pub time: Column,
    /// s, added to its times.
    pub offset: f64,
    /// Of the numbers, in the order in which they are read.
    pub columns: Vec<Column>,
}

/// How an attitude is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttitudeForm {
    /// w, x, y, z.
    Quaternion,
    /// Roll, pitch, yaw.
    Euler,
    /// Row by row.
    Matrix,
}

impl AttitudeForm {
    const ALL: [(usize, Self); 3] = [(4, Self::Quaternion), (3, Self::Euler), (9, Self::Matrix)];
}

/// What motors' numbers are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MotorMeasure {
    /// A command from 0 to 1; with the battery's voltage beside it, V at which a full command gives full thrust.
    Share {
        /// V.
        full_voltage: Option<f64>,
    },
    /// A measured speed, rad/s.
    Speed,
    /// A thrust, N.
    Thrust,
}

/// All of it.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnMap {
    /// Whether z points down in the world and in the body.
    pub z_down: bool,
    /// Hz.
    pub loop_rate: Option<f64>,
    /// Position, then attitude.
    pub pose: Option<(Stream, AttitudeForm)>,
    /// Rates, then specific force, if there is one.
    pub imu: Stream,
    /// Motors, then the battery's voltage where shares depend on it.
    pub motors: (Stream, MotorMeasure),
    /// Position, attitude.
    pub estimate: Option<(Stream, AttitudeForm)>,
    /// Position, and yaw where there is one.
    pub setpoint: Option<Stream>,
}

const LENGTHS: [(&str, f64); 3] = [("m", 1.0), ("cm", 1e-2), ("mm", 1e-3)];
const ANGLES: [(&str, f64); 2] = [("rad", 1.0), ("deg", PI / 180.0)];
const RATES: [(&str, f64); 2] = [("rad/s", 1.0), ("deg/s", PI / 180.0)];
const FORCES: [(&str, f64); 3] = [("m/s^2", 1.0), ("g", STANDARD_GRAVITY), ("mg", 1e-3 * STANDARD_GRAVITY)];
const TIMES: [(&str, f64); 4] = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
const SPEEDS: [(&str, f64); 2] = [("rad/s", 1.0), ("rpm", PI / 30.0)];

/// m/s^2.
pub const STANDARD_GRAVITY: f64 = 9.80665;

/// The keys that any section may have.
const SOURCE_KEYS: [&str; 4] = ["file", "time", "time_unit", "offset"];

impl ColumnMap {
    /// Reads `text`.
    ///
    /// # Errors
    /// Names the field that is missing or refused.
    pub fn parse(text: &str) -> Result<Self, String> {
        let table: toml::Table = text.parse().map_err(|error: toml::de::Error| {
            format!("not TOML: {}", error.to_string().trim_end().replace('\n', " "))
        })?;
        Self::of_root(&Section::root(&table)).map_err(|error| error.to_string())
    }

    fn of_root(root: &Section) -> Result<Self, FieldError> {
        root.allow(&["axes", "loop_rate", "time", "pose", "imu", "motors", "estimate", "setpoint"])?;
        let z_down = match root.has("axes").then(|| root.text("axes")).transpose()? {
            None | Some("z-up") => false,
            Some("z-down") => true,
            Some(other) => {
                return Err(FieldError::new("axes", format!("must be \"z-up\" or \"z-down\", found {other:?}")));
            }
        };
        let first = match root.optional_section("time")? {
            Some(section) => {
                section.allow(&["column", "unit"])?;
                Some(column(section.text("column")?, unit(&section, "unit", &TIMES)?))
            }
            None => None,
        };
        let pose = |name: &str| -> Result<Option<(Stream, AttitudeForm)>, FieldError> {
            root.optional_section(name)?.map(|section| posed(&section, first.as_ref())).transpose()
        };
        let map = Self {
            z_down,
            loop_rate: root.optional_number("loop_rate")?,
            pose: pose("pose")?,
            imu: imu(&root.section("imu")?, first.as_ref())?,
            motors: motors(&root.section("motors")?, first.as_ref())?,
            estimate: pose("estimate")?,
            setpoint: match root.optional_section("setpoint")? {
                Some(section) => Some(setpoint(&section, first.as_ref())?),
                None => None,
            },
        };
        if map.pose.is_none() && map.estimate.is_none() {
            return Err(FieldError::new("pose", "missing, as is estimate: one of them must say where the vehicle was"));
        }
        Ok(map)
    }

    /// The names of all columns of the first file.
    pub fn names(&self) -> BTreeSet<&str> {
        let streams = [
            self.pose.as_ref().map(|(stream, _)| stream),
            Some(&self.imu),
            Some(&self.motors.0),
            self.estimate.as_ref().map(|(stream, _)| stream),
            self.setpoint.as_ref(),
        ];
        let of_first = streams.into_iter().flatten().filter(|stream| stream.file.is_none());
        of_first.flat_map(|stream| stream.columns.iter().chain([&stream.time])).map(|column| &*column.name).collect()
    }
}

/// The factor of the unit under `key`, the first of `units` where it is left out.
fn unit(section: &Section, key: &str, units: &[(&str, f64)]) -> Result<f64, FieldError> {
    if !section.has(key) {
        return Ok(units.first().map_or(1.0, |(_, factor)| *factor));
    }
    let found = section.text(key)?;
    let known = || units.iter().map(|(name, _)| format!("{name:?}")).collect::<Vec<_>>().join(", ");
    units
        .iter()
        .find(|(name, _)| *name == found)
        .map(|(_, factor)| *factor)
        .ok_or_else(|| FieldError::new(section.path_of(key), format!("must be one of {}, found {found:?}", known())))
}

/// The columns under `key`, as many as `counts` allows.
fn columns(section: &Section, key: &str, counts: &[usize], factor: f64) -> Result<Vec<Column>, FieldError> {
    let counted = counts.iter().map(ToString::to_string).collect::<Vec<_>>().join(" or ");
    let requirement = format!("a list of {counted} names of columns");
    let elements = section.elements(key, &requirement)?;
    if !counts.contains(&elements.len()) {
        let problem = format!("must be {requirement}, found {}", elements.len());
        return Err(FieldError::new(section.path_of(key), problem));
    }
    let column = |(path, value): &(String, &Value)| match value.as_str() {
        Some(name) => Ok(column(name, factor)),
        None => Err(FieldError::new(path, format!("must be the name of a column, found {}", value.type_str()))),
    };
    elements.iter().map(column).collect()
}

/// A name, with a minus before it for the other sign.
fn column(name: &str, factor: f64) -> Column {
    match name.strip_prefix('-') {
        Some(name) => Column { name: name.to_owned(), zero: 0.0, factor: -factor },
        None => Column { name: name.to_owned(), zero: 0.0, factor },
    }
}

fn stream(section: &Section, first: Option<&Column>, columns: Vec<Column>) -> Result<Stream, FieldError> {
    let file = section.has("file").then(|| section.text("file").map(str::to_owned)).transpose()?;
    let time = match (section.has("time"), first) {
        (true, _) => column(section.text("time")?, unit(section, "time_unit", &TIMES)?),
        (false, Some(first)) => first.clone(),
        (false, None) => {
            return Err(FieldError::new("time", format!("missing: give [time], or {}", section.path_of("time"))));
        }
    };
    Ok(Stream { file, time, offset: section.number_or("offset", 0.0)?, columns })
}

fn allow(section: &Section, keys: &[&str]) -> Result<(), FieldError> {
    section.allow(&[keys, &SOURCE_KEYS].concat())
}

fn posed(section: &Section, first: Option<&Column>) -> Result<(Stream, AttitudeForm), FieldError> {
    allow(section, &["position", "unit", "attitude", "angle"])?;
    let mut all = columns(section, "position", &[3], unit(section, "unit", &LENGTHS)?)?;
    let written = columns(section, "attitude", &AttitudeForm::ALL.map(|(count, _)| count), 1.0)?;
    let form = AttitudeForm::ALL.into_iter().find(|(count, _)| *count == written.len());
    let form = form.map_or(AttitudeForm::Quaternion, |(_, form)| form);
    let factor = if form == AttitudeForm::Euler { unit(section, "angle", &ANGLES)? } else { 1.0 };
    all.extend(written.into_iter().map(|column| Column { factor: column.factor * factor, ..column }));
    Ok((stream(section, first, all)?, form))
}

fn imu(section: &Section, first: Option<&Column>) -> Result<Stream, FieldError> {
    allow(section, &["rates", "rates_unit", "force", "force_unit"])?;
    let mut all = columns(section, "rates", &[3], unit(section, "rates_unit", &RATES)?)?;
    if section.has("force") {
        all.extend(columns(section, "force", &[3], unit(section, "force_unit", &FORCES)?)?);
    }
    stream(section, first, all)
}

fn motors(section: &Section, first: Option<&Column>) -> Result<(Stream, MotorMeasure), FieldError> {
    allow(section, &["columns", "unit", "full", "zero", "battery", "full_voltage"])?;
    let counts: Vec<usize> = (3..=ROTORS_MAX).collect();
    let word = if section.has("unit") { section.text("unit")? } else { "share" };
    let speed = SPEEDS.iter().find(|(name, _)| *name == word).map(|(_, factor)| *factor);
    let (measure, factor) = match (word, speed) {
        ("share", _) => {
            let full_voltage = section.optional_number("full_voltage")?;
            if section.has("battery") != full_voltage.is_some() {
                let missing = if full_voltage.is_some() { "battery" } else { "full_voltage" };
                let problem = "missing: battery and full_voltage come together";
                return Err(FieldError::new(section.path_of(missing), problem));
            }
            (MotorMeasure::Share { full_voltage }, 1.0)
        }
        (_, Some(factor)) => (MotorMeasure::Speed, factor),
        ("N", _) => (MotorMeasure::Thrust, 1.0),
        _ => {
            let problem = format!("must be \"share\", \"rad/s\", \"rpm\" or \"N\", found {word:?}");
            return Err(FieldError::new(section.path_of("unit"), problem));
        }
    };
    let (zero, full) = (section.number_or("zero", 0.0)?, section.number_or("full", 1.0)?);
    if full <= zero {
        return Err(FieldError::new(section.path_of("full"), format!("must be above zero = {zero}, found {full}")));
    }
    let of_shares = ["full", "zero", "battery", "full_voltage"].into_iter().find(|key| section.has(key));
    if let (Some(key), false) = (of_shares, matches!(measure, MotorMeasure::Share { .. })) {
        return Err(FieldError::new(section.path_of(key), "is for unit = \"share\" alone"));
    }
    let mut all = columns(section, "columns", &counts, factor)?;
    if matches!(measure, MotorMeasure::Share { .. }) {
        for column in &mut all {
            (column.zero, column.factor) = (zero, column.factor / (full - zero));
        }
    }
    if section.has("battery") {
        all.push(column(section.text("battery")?, 1.0));
    }
    Ok((stream(section, first, all)?, measure))
}

fn setpoint(section: &Section, first: Option<&Column>) -> Result<Stream, FieldError> {
    allow(section, &["position", "unit", "yaw", "angle"])?;
    let mut all = columns(section, "position", &[3], unit(section, "unit", &LENGTHS)?)?;
    if section.has("yaw") {
        all.push(column(section.text("yaw")?, unit(section, "angle", &ANGLES)?));
    }
    stream(section, first, all)
}
