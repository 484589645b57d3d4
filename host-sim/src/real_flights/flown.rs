//! The flight, sample by sample, on one clock: what the rotors were asked for, what sensors showed, and where the
//! vehicle was.
//!
//! Where it was is what poses say, [aligned](super::alignment); without poses, what the vehicle's own filter says. Its
//! velocity is the slope of a parabola through 0.1 s of positions. The longest part in the air without a gap is kept, a
//! second at each end left out: there the ground is near.
//!
//! Where there is no accelerometer, forces are the slopes of velocities, which softens them.
//!
//! Markers are seldom level: their frame leans against the IMU's. By how much, the flight shows: on the whole, speed
//! changes by what is felt. Attitudes are turned by that constant tilt; a steady wind would pass for one.
//!
//! Of two clocks that stretch against each other one is wrong, and velocities by it are. Which, the accelerometer says:
//! the flight is put together on either, and that is kept on which speed changes more nearly by what was felt.

use super::alignment::{Alignment, BRIDGED_MAX_S, three};
use super::columns::{MotorMeasure, STANDARD_GRAVITY};
use super::recording::{Recording, of_row};
use super::series::Series;
use super::slopes::slopes;
use controller_core::allocation::Rotors;
use nalgebra::{UnitQuaternion, Vector3};

/// Between two samples, s: as most logs have it.
pub const PERIOD_S: f64 = 0.01;
/// Setpoints hold for so long, s; so does a battery's voltage.
const HELD_MAX_S: f64 = 1.0;
/// Flight is above this height, m, over the lowest, unless the log never rests; and with this share of the usual
/// thrust.
const AIRBORNE_HEIGHT_M: f64 = 0.2;
const AIRBORNE_SHARE: f64 = 0.3;
/// What is left out at each end, s.
const ENDS_S: f64 = 1.0;
/// Over how many samples speed changes are compared with what was felt.
const FELT_SAMPLES: usize = 20;
/// The shortest flight that says anything, s.
pub const FLIGHT_MIN_S: f64 = 8.0;

/// One sample. SI units, world z up, body forward, left, up.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// s.
    pub time: f64,
    /// The same on the vehicle's clock, s.
    pub felt: f64,
    /// rad/s, body, by the gyro, without its bias.
    pub rates: Vector3<f64>,
    /// m/s^2, body, by the accelerometer; without one by how speed changes.
    pub force: Option<Vector3<f64>>,
    /// Each rotor's, N, by the scenario's curve: without lag and scale.
    pub thrusts: Vec<f64>,
    /// m, world.
    pub position: Vector3<f64>,
    /// m/s, world.
    pub velocity: Vector3<f64>,
    /// Body to world.
    pub attitude: UnitQuaternion<f64>,
    /// What the vehicle's own filter said.
    pub own: Option<(Vector3<f64>, UnitQuaternion<f64>)>,
    /// m, and rad where there is a yaw.
    pub setpoint: Option<(Vector3<f64>, Option<f64>)>,
}

/// A flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Flown {
    /// One each [`PERIOD_S`].
    pub samples: Vec<Sample>,
    /// Of the poses; none without poses, or without turning.
    pub alignment: Option<Alignment>,
    /// Whether places are the vehicle's own estimates, for want of poses.
    pub by_itself: bool,
    /// Whose times are kept.
    pub clock: Clock,
    /// Whether forces are an accelerometer's; else they are how speed changes, softened.
    pub is_felt: bool,
    /// From the IMU's axes to those of the markers; attitudes are corrected.
    pub tilt: UnitQuaternion<f64>,
}

/// Whose times are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// The poses'.
    Poses,
    /// The vehicle's.
    Vehicle,
}

impl Flown {
    /// The flight of `recording` on a vehicle with these `rotors`.
    ///
    /// # Errors
    /// Says what of it cannot be used.
    pub fn new(recording: &Recording, rotors: &Rotors) -> Result<Self, String> {
        let count = recording.motors.rows.first().map_or(0, Vec::len) - usize::from(has_battery(recording.measure));
        if count != rotors.len() {
            return Err(format!("motors.columns: has {count}, and the scenario {} rotors", rotors.len()));
        }
        let alignment = recording.pose.as_ref().and_then(|poses| Alignment::new(poses, &recording.imu));
        let places = recording.pose.as_ref().or(recording.estimate.as_ref());
        let places = places.ok_or("pose: is missing, as is estimate")?;
        let on = |clock: Clock| Self::on(clock, recording, rotors, places, alignment.as_ref());
        if alignment.is_none() {
            return on(Clock::Vehicle);
        }
        match (on(Clock::Poses), on(Clock::Vehicle)) {
            (Ok(poses), Ok(vehicle)) if poses.unfelt() > vehicle.unfelt() => Ok(vehicle),
            (Err(_), vehicle) => vehicle,
            (poses, _) => poses,
        }
    }

    /// The same on one of the clocks.
    fn on(
        clock: Clock,
        recording: &Recording,
        rotors: &Rotors,
        places: &Series,
        alignment: Option<&Alignment>,
    ) -> Result<Self, String> {
        let series = [&recording.imu, &recording.motors, places];
        let start = series.iter().map(|series| series.first()).fold(f64::NEG_INFINITY, f64::max);
        let end = series.iter().map(|series| series.last()).fold(f64::INFINITY, f64::min);
        let bias = alignment.map_or_else(Vector3::zeros, |alignment| alignment.gyro_bias);
        let ticks = ((end - start) / PERIOD_S).max(0.0) as usize;
        let sample = |tick: usize| {
            let time = start + tick as f64 * PERIOD_S;
            // The poses' time, and the vehicle's.
            let (seen, felt) = match (alignment, clock) {
                (None, _) => (time, time),
                (Some(alignment), Clock::Poses) => (time, time + alignment.of_pose(time)),
                (Some(alignment), Clock::Vehicle) => (time - alignment.at(time), time),
            };
            let imu = averaged(&recording.imu, felt)?;
            let (position, attitude) = of_row(&places.at(seen, BRIDGED_MAX_S)?);
            let own = recording.estimate.as_ref().and_then(|own| own.at(felt, BRIDGED_MAX_S)).map(|row| of_row(&row));
            let setpoint = recording.setpoint.as_ref().and_then(|setpoint| setpoint.held(felt, HELD_MAX_S));
            Some(Sample {
                time,
                felt,
                rates: three(&imu) - bias,
                force: (imu.len() > 3).then(|| Vector3::new(imu[3], imu[4], imu[5])),
                thrusts: thrusts(&recording.motors.at(felt, HELD_MAX_S)?, recording.measure, rotors),
                position,
                velocity: Vector3::zeros(),
                attitude,
                own,
                setpoint: setpoint.map(|row| (three(row), row.get(3).copied())),
            })
        };
        let mut samples = in_the_air(&(0..ticks).map(sample).collect::<Vec<_>>());
        let velocities = slopes(&samples.iter().map(|sample| sample.position).collect::<Vec<_>>(), PERIOD_S);
        for (sample, velocity) in samples.iter_mut().zip(&velocities) {
            sample.velocity = *velocity;
        }
        let is_felt = samples.iter().all(|sample| sample.force.is_some());
        if !is_felt {
            for (sample, acceleration) in samples.iter_mut().zip(slopes(&velocities, PERIOD_S)) {
                let force = acceleration + Vector3::z() * STANDARD_GRAVITY;
                sample.force = Some(sample.attitude.inverse_transform_vector(&force));
            }
        }
        let ends = (ENDS_S / PERIOD_S) as usize;
        let kept = samples.get(ends..samples.len().saturating_sub(ends)).unwrap_or_default().to_vec();
        let seconds = kept.len() as f64 * PERIOD_S;
        if seconds < FLIGHT_MIN_S {
            return Err(format!(
                "has {seconds:.1} s in the air without a gap, at least {FLIGHT_MIN_S} are needed: higher than \
                 {AIRBORNE_HEIGHT_M} m above the lowest place, with sensors, motors and poses together"
            ));
        }
        let mut flown = Self {
            samples: kept,
            alignment: alignment.cloned(),
            by_itself: recording.pose.is_none(),
            clock,
            is_felt,
            tilt: UnitQuaternion::identity(),
        };
        flown.level();
        Ok(flown)
    }

    /// Finds the tilt, and takes it away.
    fn level(&mut self) {
        let (mut seen, mut felt) = (Vector3::zeros(), Vector3::zeros());
        for window in self.samples.windows(FELT_SAMPLES + 1) {
            let (first, middle, last) = (&window[0], &window[FELT_SAMPLES / 2], &window[FELT_SAMPLES]);
            let Some(force) = middle.force else { return };
            let gained = (last.velocity - first.velocity) / (FELT_SAMPLES as f64 * PERIOD_S);
            seen += middle.attitude.inverse_transform_vector(&(gained + Vector3::z() * STANDARD_GRAVITY));
            felt += force;
        }
        self.tilt = UnitQuaternion::rotation_between(&felt, &seen).unwrap_or_else(UnitQuaternion::identity);
        for sample in &mut self.samples {
            sample.attitude *= self.tilt;
        }
    }

    /// How long it is, s.
    pub fn seconds(&self) -> f64 {
        self.samples.len() as f64 * PERIOD_S
    }

    /// How little what speed changes by within `FELT_SAMPLES` goes with what was felt, from 0 to 2; zero without an
    /// accelerometer.
    fn unfelt(&self) -> f64 {
        let (mut both, mut of_seen, mut of_felt) = (0.0, 0.0, 0.0);
        for window in self.samples.windows(FELT_SAMPLES + 1) {
            let felt = window
                .iter()
                .skip(1)
                .map(|sample| Some((sample.attitude * sample.force? - Vector3::z() * STANDARD_GRAVITY) * PERIOD_S));
            let Some(felt) = felt.sum::<Option<Vector3<f64>>>() else { return 0.0 };
            let seen = window[FELT_SAMPLES].velocity - window[0].velocity;
            both += seen.dot(&felt);
            of_seen += seen.norm_squared();
            of_felt += felt.norm_squared();
        }
        1.0 - both / (of_seen * of_felt).sqrt().max(f64::MIN_POSITIVE)
    }
}

fn has_battery(measure: MotorMeasure) -> bool {
    matches!(measure, MotorMeasure::Share { full_voltage: Some(_) })
}

/// The mean over a sample's time of a stream that is quicker, else the stream at that time.
fn averaged(series: &Series, time: f64) -> Option<Vec<f64>> {
    let (first, last) = (time - PERIOD_S / 2.0, time + PERIOD_S / 2.0);
    let begin = series.times.partition_point(|row| *row < first);
    let end = series.times.partition_point(|row| *row < last);
    let rows = series.rows.get(begin..end).unwrap_or_default();
    if rows.len() < 2 {
        return series.at(time, BRIDGED_MAX_S);
    }
    let mut mean = rows[0].clone();
    for row in &rows[1..] {
        mean.iter_mut().zip(row).for_each(|(sum, number)| *sum += number);
    }
    mean.iter_mut().for_each(|sum| *sum /= rows.len() as f64);
    Some(mean)
}

/// N, by the scenario's curve.
fn thrusts(row: &[f64], measure: MotorMeasure, rotors: &Rotors) -> Vec<f64> {
    let share = match measure {
        MotorMeasure::Share { full_voltage: Some(full) } => row.last().map_or(1.0, |voltage| voltage / full),
        _ => 1.0,
    };
    let thrust = |(rotor, level): (&controller_core::allocation::geometry::Rotor, &f64)| match measure {
        MotorMeasure::Share { .. } => f64::from(rotor.thrust_max) * (level.max(0.0) * share).powi(2),
        MotorMeasure::Speed => f64::from(rotor.thrust_at(*level as f32)),
        MotorMeasure::Thrust => *level,
    };
    rotors.iter().zip(row).map(thrust).collect()
}

/// The longest run in the air.
fn in_the_air(all: &[Option<Sample>]) -> Vec<Sample> {
    let lowest = all.iter().flatten().map(|sample| sample.position.z).fold(f64::INFINITY, f64::min);
    let mut sums: Vec<f64> = all.iter().flatten().map(|sample| sample.thrusts.iter().sum()).collect();
    sums.sort_by(f64::total_cmp);
    let usual = sums.get(sums.len() * 9 / 10).copied().unwrap_or(0.0);
    let carries = |sample: &Sample| sample.thrusts.iter().sum::<f64>() > AIRBORNE_SHARE * usual;
    let rests = all.iter().flatten().any(|sample| !carries(sample));
    let flies = |sample: &Sample| carries(sample) && (!rests || sample.position.z > lowest + AIRBORNE_HEIGHT_M);
    let (mut longest, mut current) = (0..0, 0..0);
    for (tick, sample) in all.iter().enumerate() {
        if sample.as_ref().is_some_and(flies) {
            current.end = tick + 1;
        } else {
            current = tick + 1..tick + 1;
        }
        if current.len() > longest.len() {
            longest = current.clone();
        }
    }
    all.get(longest).unwrap_or_default().iter().flatten().cloned().collect()
}
