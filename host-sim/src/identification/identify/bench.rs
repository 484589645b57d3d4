//! The bench's measurements: a small TOML file, every section optional.
//!
//! ```toml
//! [weighing]
//! mass = [0.5021, 0.5023]              # kg, each time put on the scale anew, battery in
//! uncertainty = 0.0005                 # kg, of the scale, standard
//!
//! [[swing]]                            # hung by two parallel strings, turning about the vertical
//! axis = "x"                           # the body axis that is vertical
//! length = 1.250                       # m, of the strings
//! distance = 0.300                     # m, between them
//! swings = 20                          # in each of
//! times = [25.51, 25.47, 25.53]        # s
//! uncertainty = 0.001                  # m, of length and distance, standard
//!
//! [thrust_stand]                       # one motor at the nominal voltage
//! commands = [0.2, 0.4, 0.6, 0.8, 1.0]
//! thrusts = [0.5, 2.0, 4.5, 8.0, 12.5] # N
//! uncertainty = 0.01                   # of the scale's readings as a part of them, standard
//! ```
//!
//! J = m g T^2 d^2 / (16 pi^2 L) for small swings with the period T; f = f_max (a u + (1 - a) u^2) by least squares.

use controller_core::allocation::Rotors;
use std::f64::consts::PI;
use toml_edit::{DocumentMut, Item, TableLike};

/// A measured number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// Its standard uncertainty.
    pub uncertainty: f64,
}

impl Measured {
    /// The uncertainty as a part of the number.
    pub fn relative(&self) -> f64 {
        self.uncertainty / self.value
    }
}

/// A bifilar pendulum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// 0 for x.
    pub axis: usize,
    /// J/m, m^2.
    pub over_mass: Measured,
}

/// All that the bench says.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bench {
    /// kg.
    pub mass: Option<Measured>,
    /// J/m about one axis or another.
    pub swings: Vec<Swing>,
    /// Greatest thrust over the file's.
    pub thrust_scale: Option<Measured>,
    /// a, for `rotors.thrust_curve`.
    pub curve: Option<f64>,
}

/// Reads bench data for a vehicle with these rotors under `gravity`, m/s^2.
///
/// # Errors
/// Names the field that is missing or refused.
pub fn read(text: &str, rotors: &Rotors, gravity: f64) -> Result<Bench, String> {
    let document: DocumentMut = text.parse().map_err(|error| format!("not TOML: {error}").replace('\n', " "))?;
    allow(document.as_table(), "", &["weighing", "swing", "thrust_stand"])?;
    let mut bench = Bench::default();
    if let Some(item) = document.get("weighing") {
        let table = section(item, "weighing", &["mass", "uncertainty"])?;
        bench.mass = Some(mean(&numbers(table, "weighing", "mass", 1)?, number(table, "weighing", "uncertainty")?));
    }
    if let Some(item) = document.get("swing") {
        let tables = item.as_array_of_tables().ok_or("swing: must be written as [[swing]]")?;
        bench.swings = tables.iter().map(|table| swing(table, gravity)).collect::<Result<_, _>>()?;
    }
    if let Some(item) = document.get("thrust_stand") {
        let table = section(item, "thrust_stand", &["commands", "thrusts", "uncertainty"])?;
        let (full, curve) = stand(table)?;
        let file = rotors.iter().map(|rotor| f64::from(rotor.thrust_max)).fold(0.0, f64::max);
        bench.thrust_scale = Some(Measured { value: full.value / file, uncertainty: full.uncertainty / file });
        bench.curve = Some(curve);
    }
    Ok(bench)
}

fn swing(table: &dyn TableLike, gravity: f64) -> Result<Swing, String> {
    allow(table, "swing.", &["axis", "length", "distance", "swings", "times", "uncertainty"])?;
    let axis =
        table.get("axis").and_then(Item::as_str).and_then(|axis| ["x", "y", "z"].iter().position(|a| *a == axis));
    let axis = axis.ok_or("swing.axis: must be \"x\", \"y\" or \"z\"")?;
    let of = |key| number(table, "swing", key);
    let (length, distance, swings, uncertainty) = (of("length")?, of("distance")?, of("swings")?, of("uncertainty")?);
    let times = mean(&numbers(table, "swing", "times", 2)?, 0.0);
    let period = times.value / swings;
    let value = gravity * period * period * distance * distance / (16.0 * PI * PI * length);
    let relative = [2.0 * times.relative(), 2.0 * uncertainty / distance, uncertainty / length];
    let relative = relative.iter().map(|part| part * part).sum::<f64>().sqrt();
    Ok(Swing { axis, over_mass: Measured { value, uncertainty: value * relative } })
}

/// f_max, N, and a.
fn stand(table: &dyn TableLike) -> Result<(Measured, f64), String> {
    let (commands, thrusts) =
        (numbers(table, "thrust_stand", "commands", 4)?, numbers(table, "thrust_stand", "thrusts", 4)?);
    let scale = number(table, "thrust_stand", "uncertainty")?;
    if commands.len() != thrusts.len() || commands.iter().any(|command| *command > 1.0) {
        return Err("thrust_stand.commands: must be as many as thrusts, each at most 1".to_owned());
    }
    let sum = |of: &dyn Fn(f64, f64) -> f64| commands.iter().zip(&thrusts).map(|(u, f)| of(*u, *f)).sum::<f64>();
    let (uu, uuu, uuuu) = (sum(&|u, _| u * u), sum(&|u, _| u * u * u), sum(&|u, _| u * u * u * u));
    let (uf, uuf) = (sum(&|u, f| u * f), sum(&|u, f| u * u * f));
    let determinant = uu * uuuu - uuu * uuu;
    if determinant < 1e-6 * uu * uuuu {
        return Err("thrust_stand.commands: must differ from one another".to_owned());
    }
    let (linear, square) = ((uf * uuuu - uuf * uuu) / determinant, (uuf * uu - uf * uuu) / determinant);
    let value = linear + square;
    let left = sum(&|u, f| (f - linear * u - square * u * u).powi(2)) / (commands.len() - 2) as f64;
    let of_sum = left * (uuuu + uu - 2.0 * uuu) / determinant;
    let pairs = || commands.iter().zip(&thrusts);
    let rises = pairs().all(|(u, f)| pairs().all(|(v, g)| u >= v || f < g));
    // A curve through rising thrusts may still end below zero.
    if !rises || value <= 0.0 {
        return Err("thrust_stand.thrusts: must rise with the commands".to_owned());
    }
    Ok((Measured { value, uncertainty: of_sum.sqrt().hypot(scale * value) }, (linear / value).clamp(0.0, 1.0)))
}

/// The mean, with the uncertainty of its readings beside that of the instrument.
fn mean(readings: &[f64], instrument: f64) -> Measured {
    let count = readings.len() as f64;
    let value = readings.iter().sum::<f64>() / count;
    let spread = readings.iter().map(|reading| (reading - value).powi(2)).sum::<f64>();
    let of_mean = if count > 1.0 { (spread / (count * (count - 1.0))).sqrt() } else { 0.0 };
    Measured { value, uncertainty: instrument.hypot(of_mean).max(1e-6 * value) }
}

fn section<'a>(item: &'a Item, name: &str, keys: &[&str]) -> Result<&'a dyn TableLike, String> {
    let table = item.as_table_like().ok_or(format!("{name}: must be a section"))?;
    allow(table, &format!("{name}."), keys)?;
    Ok(table)
}

fn allow(table: &dyn TableLike, path: &str, keys: &[&str]) -> Result<(), String> {
    match table.iter().find(|(key, _)| !keys.contains(key)) {
        Some((key, _)) => Err(format!("{path}{}: unknown key (allowed: {})", key.escape_debug(), keys.join(", "))),
        None => Ok(()),
    }
}

/// A number above zero.
fn number(table: &dyn TableLike, section: &str, key: &str) -> Result<f64, String> {
    let item = table.get(key).ok_or(format!("{section}.{key}: is missing"))?;
    positive(item.as_float().or(item.as_integer().map(|whole| whole as f64)), &format!("{section}.{key}"))
}

fn positive(value: Option<f64>, path: &str) -> Result<f64, String> {
    value.filter(|value| *value > 0.0 && value.is_finite()).ok_or(format!("{path}: must be a number above zero"))
}

/// At least so many numbers above zero.
fn numbers(table: &dyn TableLike, section: &str, key: &str, least: usize) -> Result<Vec<f64>, String> {
    let path = format!("{section}.{key}");
    let array = table.get(key).ok_or(format!("{path}: is missing"))?.as_array();
    let array =
        array.filter(|array| array.len() >= least).ok_or(format!("{path}: must be a list of {least} or more"))?;
    array.iter().map(|item| positive(item.as_float().or(item.as_integer().map(|n| n as f64)), &path)).collect()
}
