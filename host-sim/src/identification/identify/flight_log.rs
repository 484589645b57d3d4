//! The state that a vehicle measured in flight and the wrench that it commanded, at each control tick.
//!
//! From log.csv, the state is `est_…` where there is an estimator, `measured_…` where there are sensors, and the true
//! state only where the vehicle flew on that. From a ULog, it is the estimate ([`super::ulog`]).
//!
//! World frame z up, body frame x forward, y left, z up, SI units.

use super::foreign::READABLE_LOGS;
use crate::identification::ulog::reader::Damage;
use controller_core::state::Wrench;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// The source of the state that a vehicle flew on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// By the estimator: body rates are late by the low-passes of the gyro.
    Estimator,
    /// By a scenario's `[sensors]`.
    Sensors,
    /// It is the state itself.
    Truth,
    /// By PX4, on another clock than its own: [`super::px4`].
    Px4,
}

/// One control tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// s.
    pub time: f64,
    /// m/s, world.
    pub velocity: Vector3<f64>,
    /// Body to world.
    pub attitude: UnitQuaternion<f64>,
    /// rad/s, body.
    pub angular_velocity: Vector3<f64>,
    /// The reference's velocity, m/s, world.
    pub reference_velocity: Vector3<f64>,
    /// The wrench commanded of the rotors: thrust, N, and torque, N m.
    pub commanded: Wrench,
}

/// The longest part of a log that was flown without a gap.
#[derive(Debug, Clone, PartialEq)]
pub struct FlightLog {
    /// Between two ticks, s.
    pub period: f64,
    /// The source of the state.
    pub source: Source,
    /// Tick by tick.
    pub moments: Vec<Moment>,
    /// What could not be read of the file.
    pub damage: Damage,
}

/// The greatest deviation of the time between two ticks from the usual one, as a share of it.
const JITTER_MAX_SHARE: f64 = 0.1;

impl FlightLog {
    /// Keeps the longest run of `moments` without a gap; none marks a tick without a state or not in the air.
    ///
    /// # Errors
    /// If there are no two moments, or time does not increase.
    pub fn longest(source: Source, moments: &[Option<Moment>]) -> Result<Self, String> {
        let mut steps: Vec<f64> =
            moments.windows(2).filter_map(|pair| Some(pair[1].as_ref()?.time - pair[0].as_ref()?.time)).collect();
        if steps.iter().any(|step| *step <= 0.0) {
            return Err("t: must increase from row to row".to_owned());
        }
        steps.sort_by(f64::total_cmp);
        let Some(&period) = steps.get(steps.len() / 2) else {
            return Err("holds no two ticks of flight one after the other".to_owned());
        };
        let (mut longest, mut current): (Vec<Moment>, Vec<Moment>) = (Vec::new(), Vec::new());
        for moment in moments {
            let follows = match (current.last(), moment) {
                (Some(last), Some(next)) => (next.time - last.time - period).abs() < JITTER_MAX_SHARE * period,
                (None, Some(_)) => true,
                (_, None) => false,
            };
            if !follows {
                if current.len() > longest.len() {
                    longest.clone_from(&current);
                }
                current.clear();
            }
            current.extend(moment);
        }
        let moments = if current.len() > longest.len() { current } else { longest };
        Ok(Self { period, source, moments, damage: Damage::default() })
    }

    /// Reads log.csv.
    ///
    /// # Errors
    /// Names the line and the column that cannot be used.
    pub fn from_csv(text: &str) -> Result<Self, String> {
        // Spreadsheets put a byte order mark before all else.
        let mut lines = text.strip_prefix('\u{feff}').unwrap_or(text).lines();
        let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
        let has = |name: &str| header.contains(&name);
        let (source, prefix) = if has("est_px") {
            (Source::Estimator, "est_")
        } else if has("measured_px") {
            (Source::Sensors, "measured_")
        } else {
            (Source::Truth, "")
        };
        let column = |name: &str| {
            let place = header.iter().position(|found| *found == name);
            place.ok_or_else(|| format!("line 1: has no column {name}: no log.csv; {READABLE_LOGS}"))
        };
        let measured = ["vx", "vy", "vz", "qw", "qx", "qy", "qz", "wx", "wy", "wz"];
        let mut columns = vec![column("t")?];
        for name in measured {
            columns.push(column(&format!("{prefix}{name}"))?);
        }
        for name in ["thrust", "tau_x", "tau_y", "tau_z", "pdx", "pdy", "pdz"] {
            columns.push(column(name)?);
        }
        let scale = has("thrust_scale").then(|| column("thrust_scale")).transpose()?;
        let mut moments = Vec::new();
        for (index, line) in lines.enumerate() {
            let fields: Vec<&str> = line.split(',').collect();
            let read = |column: usize| -> Result<f64, String> {
                let place = || format!("line {}, {}", index + 2, header[column]);
                let field = fields.get(column).ok_or_else(|| format!("{}: is missing", place()))?;
                match field.parse::<f64>() {
                    Ok(number) if number.is_finite() => Ok(number),
                    _ => Err(format!("{}: must be a finite number, found {field:?}", place())),
                }
            };
            let numbers = columns.iter().map(|column| read(*column)).collect::<Result<Vec<f64>, String>>()?;
            let scale = scale.map_or(Ok(1.0), read)?;
            let moment = moment(&numbers, scale).ok_or(format!("line {}: is no state of a vehicle", index + 2))?;
            moments.push(Some(moment));
        }
        differentiate(&mut moments);
        Self::longest(source, &moments)
    }

    /// How long it is, s.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.moments.len() as f64 * self.period
    }

    /// The same flight as the reference has it: velocities without gusts and noise, level, turning in heading only.
    #[must_use]
    pub fn of_reference(&self) -> Self {
        let referred = |moment: &Moment| Moment {
            velocity: moment.reference_velocity,
            attitude: UnitQuaternion::from_euler_angles(0.0, 0.0, moment.attitude.euler_angles().2),
            angular_velocity: Vector3::zeros(),
            ..*moment
        };
        Self { moments: self.moments.iter().map(referred).collect(), ..self.clone() }
    }
}

/// The reference's velocities from its positions, which are exact.
fn differentiate(moments: &mut [Option<Moment>]) {
    let positions: Vec<Option<(f64, Vector3<f64>)>> =
        moments.iter().map(|moment| moment.map(|moment| (moment.time, moment.reference_velocity))).collect();
    for (index, moment) in moments.iter_mut().enumerate() {
        let at = |index: usize| positions.get(index).copied().flatten();
        let (before, after) = (at(index.saturating_sub(1)), at(index + 1).or(at(index)));
        if let (Some(moment), Some((t_0, p_0)), Some((t_1, p_1))) = (moment, before, after) {
            moment.reference_velocity = if t_1 > t_0 { (p_1 - p_0) / (t_1 - t_0) } else { Vector3::zeros() };
        }
    }
}

/// A moment from time, velocity, attitude, rates, the law's thrust and torque, the reference's velocity, and the
/// estimated thrust scale; `None` if that is no state.
#[must_use]
pub fn moment(numbers: &[f64], scale: f64) -> Option<Moment> {
    let &[time, vx, vy, vz, qw, qx, qy, qz, wx, wy, wz, thrust, tau_x, tau_y, tau_z, rx, ry, rz] = numbers else {
        return None;
    };
    let attitude = Quaternion::new(qw, qx, qy, qz);
    let usable = numbers.iter().all(|number| number.is_finite());
    if !(usable && (attitude.norm() - 1.0).abs() < 1e-2 && scale > 0.0 && scale.is_finite()) {
        return None;
    }
    Some(Moment {
        time,
        velocity: Vector3::new(vx, vy, vz),
        attitude: UnitQuaternion::new_normalize(attitude),
        angular_velocity: Vector3::new(wx, wy, wz),
        reference_velocity: Vector3::new(rx, ry, rz),
        commanded: Wrench {
            thrust: (thrust / scale) as f32,
            torque: Vector3::new(tau_x, tau_y, tau_z).map(|torque| (torque / scale) as f32),
        },
    })
}
