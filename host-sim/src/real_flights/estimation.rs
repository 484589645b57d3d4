//! Our estimator on the sensors of a real flight, as boards run it.
//!
//! It gets each sample of the recorded IMU, and one in so many of the poses, as late as a link makes them, with or
//! without gaps. What it believes of their noise is a part of [`PoseStream`]. What it says is compared with all poses,
//! most of which it never got. Beside it stands the vehicle's own filter, against the same poses.
//!
//! Poses come with the vehicle's time, which is [aligned](super::alignment); or with their own, as a bridge would send
//! them that knows no better. Then the truth is the row that has the same time in the file.

use super::alignment::{BRIDGED_MAX_S, three};
use super::flown::{Flown, PERIOD_S};
use super::recording::{Recording, of_row};
use controller_core::state::State;
use controller_core::vehicle::Vehicle;
use estimation::estimator::history::{Clipped, Increment};
use estimation::estimator::settings::{EstimatorParameters, Settings};
use estimation::estimator::{Estimator, PoseMeasurement};
use estimation::measurement::{Pose, Stamped, Velocity};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Which poses the estimator gets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseStream {
    /// One of so many.
    pub every: usize,
    /// s.
    pub late: f64,
    /// Without poses for so long, s, each `GAPS_EVERY_S`.
    pub gap: f64,
    /// Whether their times are the vehicle's.
    pub aligned: bool,
    /// sigma_t, s.
    pub time_noise: f64,
    /// What positions are believed to be off by, m.
    pub position_noise: f64,
    /// Attitudes, rad.
    pub attitude_noise: f64,
    /// By how much the IMU's noise is believed to be greater than a BMI088's: gyro, accelerometer.
    pub imu_noise: [f64; 2],
}

/// Between the beginnings of two gaps, s.
pub const GAPS_EVERY_S: f64 = 4.0;
/// Estimates settle for so long, s.
const SETTLING_S: f64 = 2.0;

/// How far off a filter was.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Off {
    /// RMS, m.
    pub position: f64,
    /// The greatest, m.
    pub greatest: f64,
    /// RMS of the attitude, degrees.
    pub degrees: f64,
    /// RMS, m/s.
    pub velocity: f64,
}

/// What came of one stream.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimated {
    /// Estimate against poses.
    pub off: Off,
    /// Means of NIS, position and attitude: 3 where noise is as believed.
    pub nis: [f64; 2],
    /// Poses fused and refused.
    pub counts: (u32, u32),
    /// Estimate less truth, sample by sample: m, m/s, rotation vector, rad/s.
    pub errors: Vec<Option<[Vector3<f64>; 4]>>,
    /// Samples without a state.
    pub missing: usize,
}

/// A sample of the IMU: s; rad/s; m/s^2.
type ImuRow = (f64, Vector3<f64>, Vector3<f64>);

/// Where the vehicle was: s; m; m/s.
type Place = (f64, Vector3<f64>, Vector3<f64>, UnitQuaternion<f64>);

/// Runs it.
///
/// # Errors
/// If there are no poses, or no accelerometer.
pub fn estimated(
    flown: &Flown,
    recording: &Recording,
    stream: &PoseStream,
    vehicle: &Vehicle,
) -> Result<Estimated, String> {
    if !flown.is_felt {
        return Err("imu.force: is missing; the estimator needs an accelerometer".to_owned());
    }
    let (imu, places) = if stream.aligned { on_one_clock(flown) } else { as_written(recording, flown) }
        .ok_or("imu.force or pose: is missing; the estimator needs an accelerometer and poses")?;
    let [gyro, accelerometer] = stream.imu_noise;
    let parameters = EstimatorParameters {
        gravity: vehicle.gravity,
        position_noise: stream.position_noise as f32,
        attitude_noise: stream.attitude_noise as f32,
        time_noise: stream.time_noise as f32,
        gyro_noise: EstimatorParameters::BMI088.gyro_noise * gyro as f32,
        accelerometer_noise: EstimatorParameters::BMI088.accelerometer_noise * accelerometer as f32,
        ..EstimatorParameters::BMI088
    };
    let mut estimator = Estimator::new(&Settings::new(&parameters).map_err(|error| error.to_string())?);
    estimator.may_stand(false);
    let zero = imu.first().map_or(0.0, |row| row.0);
    let clock = |time: f64| ((time - zero) * 1e6).round().max(0.0) as u64 + 1_000_000;
    let mut arriving = places
        .iter()
        .step_by(stream.every.max(1))
        .filter(|(time, ..)| stream.gap == 0.0 || (time - zero).rem_euclid(GAPS_EVERY_S) > stream.gap)
        .peekable();
    let mut sums = Sums::default();
    let mut out = Estimated { off: Off::default(), nis: [0.0; 2], counts: (0, 0), errors: vec![None], missing: 0 };
    for pair in imu.windows(2) {
        let [before, after] = pair else { break };
        let now = clock(after.0);
        estimator.imu(&increment(before, after, clock(before.0), now));
        while let Some((time, position, _, attitude)) = arriving.next_if(|(time, ..)| time + stream.late <= after.0) {
            let attitude = Quaternion::from(attitude.coords.map(|number| number as f32));
            let still = Velocity::World(Vector3::zeros());
            if let Ok(pose) = Pose::new(position.map(|number| number as f32), still, attitude) {
                // Its health counts what became of it.
                let _ = estimator.pose(&Stamped { value: PoseMeasurement::new(&pose), time: clock(*time) }, now);
            }
        }
        let state = estimator.state(now, &after.1.map(|number| number as f32), None);
        let next = places.partition_point(|(time, ..)| *time < after.0 - 1e-6);
        // Truth has the same time, but for what clocks round.
        let truth = places.get(next).filter(|(time, ..)| time - after.0 < PERIOD_S / 2.0);
        let error = state.zip(truth).map(|(estimated, (_, position, velocity, attitude))| {
            apart(&estimated.state, position, attitude, velocity, &after.1)
        });
        if after.0 > zero + SETTLING_S {
            match &error {
                Some(error) => sums.add(error),
                None => out.missing += 1,
            }
        }
        out.errors.push(error);
    }
    let health = estimator.health(clock(imu.last().map_or(0.0, |row| row.0)));
    out.nis = [health.nis.0.into(), health.nis.1.into()];
    out.counts = health.counts;
    out.off = sums.off();
    Ok(out)
}

/// Between two samples.
fn increment(before: &ImuRow, after: &ImuRow, start: u64, end: u64) -> Increment {
    let seconds = after.0 - before.0;
    let (rates, force) = ((before.1 + after.1) / 2.0, (before.2 + after.2) / 2.0);
    Increment {
        start,
        end,
        delta_angle: (rates * seconds).map(|number| number as f32),
        // From the middle's axes to the start's.
        delta_velocity: ((force + rates.cross(&force) * (seconds / 2.0)) * seconds).map(|number| number as f32),
        clipped: Clipped::NEITHER,
    }
}

/// The flight as it was put together.
fn on_one_clock(flown: &Flown) -> Option<(Vec<ImuRow>, Vec<Place>)> {
    let imu = flown.samples.iter().map(|sample| Some((sample.time, sample.rates, sample.force?)));
    let place = |sample: &super::flown::Sample| (sample.time, sample.position, sample.velocity, sample.attitude);
    Some((imu.collect::<Option<_>>()?, flown.samples.iter().map(place).collect()))
}

/// The file's rows with the file's times, while it flew; the markers level.
fn as_written(recording: &Recording, flown: &Flown) -> Option<(Vec<ImuRow>, Vec<Place>)> {
    let (first, last) = (flown.samples.first()?.time, flown.samples.last()?.time);
    let flies = |time: &f64| (first..=last).contains(time);
    let imu = recording.imu.times.iter().zip(&recording.imu.rows).filter(|(time, _)| flies(time));
    let imu: Option<Vec<ImuRow>> = imu
        .map(|(time, row)| (row.len() >= 6).then(|| (*time, three(row), Vector3::new(row[3], row[4], row[5]))))
        .collect();
    let poses = recording.pose.as_ref()?;
    let places = poses.times.iter().zip(&poses.rows).filter(|(time, _)| flies(time)).map(|(time, row)| {
        let (position, attitude) = of_row(row);
        let near = flown.samples.partition_point(|sample| sample.time < *time).min(flown.samples.len() - 1);
        (*time, position, flown.samples[near].velocity, attitude * flown.tilt)
    });
    Some((imu?, places.collect()))
}

fn apart(
    state: &State,
    position: &Vector3<f64>,
    attitude: &UnitQuaternion<f64>,
    velocity: &Vector3<f64>,
    rates: &Vector3<f64>,
) -> [Vector3<f64>; 4] {
    let wide = |vector: &Vector3<f32>| vector.map(f64::from);
    let estimated = UnitQuaternion::new_normalize(Quaternion::from(state.attitude.coords.map(f64::from)));
    [
        wide(&state.position) - position,
        wide(&state.velocity) - velocity,
        (attitude.inverse() * estimated).scaled_axis(),
        wide(&state.angular_velocity) - rates,
    ]
}

/// The vehicle's own filter against the poses, their body level: on one clock, or row by row with the file's times;
/// none where the file has none.
pub fn own(recording: &Recording, flown: &Flown, aligned: bool) -> Option<Off> {
    let (poses, own) = (recording.pose.as_ref()?, recording.estimate.as_ref()?);
    let mut sums = Sums::default();
    for sample in &flown.samples {
        let pair = if aligned {
            Some(((sample.position, sample.attitude), sample.own))
        } else {
            let (position, attitude) = of_row(&poses.at(sample.time, BRIDGED_MAX_S)?);
            let own = own.at(sample.time, BRIDGED_MAX_S).map(|row| of_row(&row));
            Some(((position, attitude * flown.tilt), own))
        };
        if let Some(((place, attitude), Some((own_place, own_attitude)))) = pair {
            let turn = (attitude.inverse() * own_attitude).scaled_axis();
            sums.add(&[own_place - place, Vector3::zeros(), turn, Vector3::zeros()]);
        }
    }
    Some(sums.off())
}

#[derive(Debug, Default)]
struct Sums {
    squares: [f64; 3],
    greatest: f64,
    count: f64,
}

impl Sums {
    fn add(&mut self, error: &[Vector3<f64>; 4]) {
        let [position, velocity, turn, _] = error;
        for (sum, vector) in self.squares.iter_mut().zip([position, velocity, turn]) {
            *sum += vector.norm_squared();
        }
        self.greatest = self.greatest.max(position.norm());
        self.count += 1.0;
    }

    fn off(&self) -> Off {
        let [position, velocity, turn] = self.squares.map(|sum| (sum / self.count.max(1.0)).sqrt());
        Off { position, greatest: self.greatest, degrees: turn.to_degrees(), velocity }
    }
}
