//! A flight that PX4 logged: its topics on one clock, in this crate's frames.
//!
//! ```text
//! actuator_motors     each motor's mean over a period -> thrusts by the scenario's rotors -> the commanded wrench
//! sensor_combined     body rates, each the mean over its time, taken at the middle of it
//! vehicle_attitude, vehicle_local_position, trajectory_setpoint     between two samples on a straight line
//! ```
//!
//! North, east, down and forward, right, down become z up and forward, left, up: y and z change their signs, of vectors
//! and of quaternions. The clock is one of `CLOCK_PERIOD_S`; where a topic has a gap, or the vehicle stands, there is
//! no flight.
//!
//! Supposed: a full output is a rotor's greatest thrust, and thrust goes with the square of the output, or as the
//! bench's thrust stand has it; a part of it in all motors alike is found as the thrust scale. `CA_ROTOR…` parameters
//! say which motor is which of the scenario's rotors, and without them PX4's order of a quadrotor (front right, rear
//! left, front left, rear right). Rates of `vehicle_angular_velocity`, taken where `sensor_combined` is missing, are
//! late by PX4's low-pass, which counts as a pure delay.

use super::flight_log::{FlightLog, Moment, Source, moment};
use crate::identification::ulog::reader::{Series, Ulog};
use controller_core::allocation::{Rotors, Spin};
use nalgebra::{Vector2, Vector4};
use std::f64::consts::{PI, SQRT_2};

pub(crate) const TOPICS_READ: [&str; 9] = [
    "actuator_motors",
    "actuator_outputs",
    "sensor_combined",
    "vehicle_angular_velocity",
    "vehicle_attitude",
    "vehicle_local_position",
    "trajectory_setpoint",
    "vehicle_local_position_setpoint",
    "vehicle_land_detected",
];

const CLOCK_PERIOD_S: f64 = 0.01;

/// What to set for a log that is quick enough.
const PROFILE_ADVICE: &str = "set SDLOG_PROFILE to 25 (default, system identification, high rate) and fly again";

/// A gap in a topic: this many times its usual step.
const GAP_STEPS: f64 = 5.0;

/// PX4's IMU_GYRO_CUTOFF where it is not logged.
const GYRO_CUTOFF_HZ: f64 = 40.0;

/// Where motors stand without `CA_ROTOR…` parameters, forward and left.
const QUADROTOR_PLACES: [[f64; 2]; 4] = [[1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [-1.0, -1.0]];

/// PX4's pulses of no command and of a full one where PWM_MIN and PWM_MAX are not logged.
const PULSE_RANGE_US: [f64; 2] = [1000.0, 2000.0];

/// Whether a log is PX4's.
pub fn is_one(log: &Ulog) -> bool {
    ["actuator_motors", "actuator_outputs"].iter().any(|name| log.topic(name).is_some())
}

/// Reads the flight.
///
/// # Errors
/// Names the topic that is missing or too slow, or the motor that is not among the `rotors`.
pub fn read(log: &Ulog, rotors: &Rotors, curve: Option<f64>) -> Result<FlightLog, String> {
    let places = places(log, rotors)?;
    let motors = motors(log, rotors.len())?;
    let rates = rates(log)?;
    let attitude = to_our_axes(Track::read_topic(log, "vehicle_attitude", &["q[0]", "q[1]", "q[2]", "q[3]"], 0.1)?);
    let velocity = to_our_axes(Track::read_topic(log, "vehicle_local_position", &["vx", "vy", "vz"], 0.2)?);
    let reference = reference(log)?;
    let landed = Track::read_topic(log, "vehicle_land_detected", &["landed"], f64::INFINITY).ok();
    let (start, end) = (motors.times[0], motors.times[motors.times.len() - 1]);
    let linear = curve.unwrap_or(0.0);
    let moments: Vec<Option<Moment>> = (0..((end - start) / CLOCK_PERIOD_S) as usize)
        .map(|tick| {
            let time = start + tick as f64 * CLOCK_PERIOD_S;
            let levels = motors.mean(time, time + CLOCK_PERIOD_S)?;
            let flies =
                landed.as_ref().is_none_or(|landed| landed.held_at(time).is_some_and(|landed| landed[0] == 0.0));
            if !flies || levels.iter().any(|level| !level.is_finite() || *level <= 0.0) {
                return None;
            }
            let mut wrench = Vector4::zeros();
            for (place, level) in places.iter().zip(&levels) {
                let thrust = f64::from(rotors[*place].thrust_max) * (linear * level + (1.0 - linear) * level * level);
                wrench += rotors.effectiveness()[*place] * thrust;
            }
            let parts = [velocity.at(time)?, attitude.at(time)?, rates.at(time)?, wrench.as_slice().to_vec()];
            let numbers = [&[time][..], &parts.concat(), &reference.at(time)?].concat();
            moment(&numbers, 1.0)
        })
        .collect();
    FlightLog::longest(Source::Px4, &moments)
}

/// Which of the `rotors` each motor is: the one that stands in the same direction and turns the same way.
fn places(log: &Ulog, rotors: &Rotors) -> Result<Vec<usize>, String> {
    let known = |index: usize, what: &str| log.parameters.get(&format!("CA_ROTOR{index}_{what}")).copied();
    let stands = |index: usize| -> Option<Vector2<f64>> {
        let place = match (known(index, "PX"), known(index, "PY")) {
            (Some(forward), Some(right)) => Vector2::new(forward, -right),
            _ => QUADROTOR_PLACES.get(index).copied()?.into(),
        };
        place.try_normalize(0.0)
    };
    let mut left: Vec<usize> = (0..rotors.len()).collect();
    (0..rotors.len())
        .map(|index| {
            let none =
                || format!("CA_ROTOR{index}_PX, _PY, _KM: no rotor of the scenario stands there and turns that way");
            let stands = stands(index).ok_or_else(none)?;
            let spin = known(index, "KM").map(|km| if km < 0.0 { Spin::Clockwise } else { Spin::CounterClockwise });
            // Within 20 degrees: scenarios are written from drawings.
            let fits = |place: &usize| {
                let rotor = &rotors[*place];
                let direction = rotor.position.xy().map(f64::from).normalize();
                direction.dot(&stands) > 0.94 && spin.is_none_or(|spin| spin == rotor.spin)
            };
            let found = left.iter().position(fits).ok_or_else(none)?;
            Ok(left.remove(found))
        })
        .collect()
}

/// Each motor's output, 0 to 1.
fn motors(log: &Ulog, count: usize) -> Result<Track, String> {
    let names = |of: &str| -> Vec<String> { (0..count).map(|index| format!("{of}[{index}]")).collect() };
    let track = |topic: &str, names: &[String]| {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        Track::read_topic(log, topic, &names, 1.25 * CLOCK_PERIOD_S)
    };
    if log.topic("actuator_motors").is_some() {
        return track("actuator_motors", &names("control"));
    }
    let mut pulses = track("actuator_outputs", &names("output"))?;
    let known = |name: &str, usual: f64| log.parameters.get(name).copied().unwrap_or(usual);
    let (least, most) = (known("PWM_MIN", PULSE_RANGE_US[0]), known("PWM_MAX", PULSE_RANGE_US[1]));
    pulses.rows.iter_mut().flatten().for_each(|pulse| *pulse = (*pulse - least) / (most - least));
    Ok(pulses)
}

/// Body rates, rad/s, at the times at which they were true.
fn rates(log: &Ulog) -> Result<Track, String> {
    let gyro = ["gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]", "gyro_integral_dt"];
    if let Ok(mut raw) = Track::read_topic(log, "sensor_combined", &gyro, 1.25 * CLOCK_PERIOD_S) {
        for (time, row) in raw.times.iter_mut().zip(&mut raw.rows) {
            *time -= 0.5e-6 * row.pop().unwrap_or(0.0);
        }
        return Ok(to_our_axes(raw));
    }
    let mut filtered =
        Track::read_topic(log, "vehicle_angular_velocity", &["xyz[0]", "xyz[1]", "xyz[2]"], 1.25 * CLOCK_PERIOD_S)
            .map_err(|what| format!("sensor_combined, or {what}"))?;
    let cutoff = log.parameters.get("IMU_GYRO_CUTOFF").copied().unwrap_or(GYRO_CUTOFF_HZ);
    // Of a low-pass of second order, at low frequencies.
    let late = if cutoff > 0.0 { SQRT_2 / (2.0 * PI * cutoff) } else { 0.0 };
    filtered.times.iter_mut().for_each(|time| *time -= late);
    Ok(to_our_axes(filtered))
}

/// The velocity that was asked for before any feedback, m/s; where only positions were, from one to the next.
fn reference(log: &Ulog) -> Result<Track, String> {
    let asked = |topic: &str, position: [&str; 3], velocity: [&str; 3]| -> Result<Track, String> {
        // Five a second are logged as a rule.
        let positions = Track::read_topic(log, topic, &position, 0.3)?;
        let mut velocities = Track::read_topic(log, topic, &velocity, 0.3)?;
        let finite = |row: &[f64]| row.iter().all(|number| number.is_finite());
        for index in 0..velocities.rows.len() {
            if finite(&velocities.rows[index]) {
                continue;
            }
            let (before, after) = (index.saturating_sub(1), (index + 1).min(positions.rows.len() - 1));
            let step = positions.times[after] - positions.times[before];
            let pairs = positions.rows[after].iter().zip(&positions.rows[before]);
            velocities.rows[index] = pairs.map(|(after, before)| (after - before) / step).collect();
        }
        Ok(to_our_axes(velocities))
    };
    let named = |name: &str| [0, 1, 2].map(|axis| format!("{name}[{axis}]"));
    let (position, velocity) = (named("position"), named("velocity"));
    asked("trajectory_setpoint", position.each_ref().map(String::as_str), velocity.each_ref().map(String::as_str))
        .or_else(|_| asked("vehicle_local_position_setpoint", ["x", "y", "z"], ["vx", "vy", "vz"]))
        .map_err(|what| format!("trajectory_setpoint, or {what}"))
}

/// The last two of the numbers with their signs changed.
fn to_our_axes(mut track: Track) -> Track {
    for row in &mut track.rows {
        row.iter_mut().rev().take(2).for_each(|number| *number = -*number);
    }
    track
}

/// A topic's numbers over time, s.
#[derive(Debug, Clone)]
struct Track {
    times: Vec<f64>,
    rows: Vec<Vec<f64>>,
    gap: f64,
}

impl Track {
    /// Columns of a topic whose usual step is `slowest` or less, s.
    fn read_topic(log: &Ulog, topic: &str, names: &[&str], slowest: f64) -> Result<Self, String> {
        let series = log.topic(topic).ok_or(format!("{topic}: is missing: {PROFILE_ADVICE}"))?;
        let missing = || format!("{topic}: has no {}: the log is of another PX4", names.join(", "));
        let rows = series.columns(names).ok_or_else(missing)?;
        let times: Vec<f64> = times(series).ok_or_else(missing)?;
        if times.len() < 2 {
            return Err(format!("{topic}: a single record: {PROFILE_ADVICE}"));
        }
        if times.windows(2).any(|pair| pair[1] < pair[0]) {
            return Err(format!("{topic}: timestamp: must not decrease"));
        }
        let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        let usual = steps[steps.len() / 2];
        if usual > slowest {
            return Err(format!(
                "{topic}: a record every {usual:.3} s, at least one every {slowest} s is needed: {PROFILE_ADVICE}"
            ));
        }
        Ok(Self { times, rows, gap: GAP_STEPS * usual })
    }

    /// The number of the last record up to `time`.
    fn before(&self, time: f64) -> Option<usize> {
        self.times.partition_point(|at| *at <= time).checked_sub(1)
    }

    /// Between two records.
    fn at(&self, time: f64) -> Option<Vec<f64>> {
        let index = self.before(time)?;
        let (from, to) = (self.times[index], *self.times.get(index + 1)?);
        if to - from > self.gap {
            return None;
        }
        let share = if to > from { (time - from) / (to - from) } else { 0.0 };
        let (one, other) = (&self.rows[index], &self.rows[index + 1]);
        // A quaternion and its negative are one attitude.
        let sign =
            if one.len() == 4 && one.iter().zip(other).map(|(a, b)| a * b).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
        Some(one.iter().zip(other).map(|(one, other)| one + share * (sign * other - one)).collect())
    }

    /// The last record's numbers.
    fn held_at(&self, time: f64) -> Option<&[f64]> {
        Some(&self.rows[self.before(time)?])
    }

    /// The mean from `begin` to `end` of a signal that is held from each record to the next.
    fn mean(&self, begin: f64, end: f64) -> Option<Vec<f64>> {
        let mut index = self.before(begin)?;
        let mut sum = vec![0.0; self.rows[index].len()];
        let mut at = begin;
        while at < end {
            let until = *self.times.get(index + 1)?;
            if until - self.times[index] > self.gap {
                return None;
            }
            let share = (until.min(end) - at) / (end - begin);
            sum.iter_mut().zip(&self.rows[index]).for_each(|(sum, level)| *sum += share * level);
            at = at.max(until);
            index += 1;
        }
        Some(sum)
    }
}

/// When each record was true, s: of an estimate, the time of its sample.
fn times(series: &Series) -> Option<Vec<f64>> {
    let of = |name: &str| series.columns(&[name]);
    let published = of("timestamp")?;
    let sampled = of("timestamp_sample").filter(|sampled| sampled.iter().all(|time| time[0] > 0.0));
    Some(sampled.unwrap_or(published).iter().map(|time| time[0] * 1e-6).collect())
}
