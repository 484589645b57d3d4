//! What of a recorded flight cannot be as its columns are said to be, each by its name, with what to write instead.
//!
//! The same motion is seen by sensors that know nothing of each other: a gyro and poses turn alike; an accelerometer
//! carries the weight and feels the drag; positions accelerate as it says; rotors turn the vehicle and carry it.
//! Where two disagree, every other order and sign of axes, every order of motors, the usual units and other times are
//! tried. If one of these fits far better than what the file of columns says, that is named.

mod motors;
mod sensors;
mod together;

use super::alignment::Alignment;
use super::columns::ColumnMap;
use super::flown::{Clock, Flown};
use super::recording::Recording;
use super::series::Series;
use controller_core::allocation::Rotors;
use nalgebra::Matrix3;
use together::{AXES, SCALE_FACTOR, median};

/// What is left of the turning beside what there was, of streams that fit.
const LEFT_MAX_SHARE: f64 = 0.6;
/// Another order must leave at most this share of the remainder that the file's order leaves.
const BETTER_MAX_SHARE: f64 = 0.6;
/// Less turning than this, rad within a window, tells nothing apart.
const TURNED_MIN_RAD: f64 = 0.004;

/// What is wrong with the turning by gyro and poses; nothing else can be judged before.
pub fn of_turning(recording: &Recording, map: &ColumnMap) -> Vec<String> {
    let period = recording.imu.period();
    if !(1e-4..0.2).contains(&period) {
        return vec![format!("time.unit: samples of the IMU would be {period:.6} s apart")];
    }
    let Some(places) = recording.pose.as_ref().or(recording.estimate.as_ref()) else { return Vec::new() };
    let Some(given) = Alignment::new(places, &recording.imu) else { return Vec::new() };
    let scale = given.gyro_over_poses;
    for (factor, what) in [
        (180.0 / std::f64::consts::PI, "deg/s, read as rad/s: write rates_unit = \"deg/s\""),
        (std::f64::consts::PI / 180.0, "rad/s, read as deg/s: write rates_unit = \"rad/s\""),
    ] {
        if (scale / factor).ln().abs() < SCALE_FACTOR.ln() * 2.0 {
            return vec![format!("imu.rates: turn {scale:.2} times as fast as the poses: they look like {what}")];
        }
    }
    if given.turned < TURNED_MIN_RAD
        || given.left[0] < LEFT_MAX_SHARE * given.turned && scale.ln().abs() < SCALE_FACTOR.ln()
    {
        return Vec::new();
    }
    let mut tried: Vec<(f64, String)> = Vec::new();
    for matrix in orders() {
        let turned = rotated(&recording.imu, &matrix);
        if let Some(fit) = Alignment::new(places, &turned) {
            tried.push((fit.left[0] / fit.turned, named_order(&matrix, map)));
        }
    }
    let reordered = Series {
        rows: places.rows.iter().map(|row| vec![row[0], row[1], row[2], row[6], row[3], row[4], row[5]]).collect(),
        ..places.clone()
    };
    if let Some(fit) = Alignment::new(&reordered, &recording.imu) {
        let what = "pose.attitude: looks like w last, read as w first: write the columns in the order w, x, y, z";
        tried.push((fit.left[0] / fit.turned, what.to_owned()));
    }
    let here = given.left[0] / given.turned;
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    match tried.into_iter().next() {
        Some((left, what)) if left < BETTER_MAX_SHARE * here => vec![what],
        _ if here > 0.95 => vec![format!(
            "imu.rates and pose.attitude: have nothing to do with each other: {:.0} % of the turning is left over, in \
             whatever order of axes and with any delay up to 3 s",
            100.0 * here
        )],
        _ => Vec::new(),
    }
}

/// Every order and sign of three axes but the given one.
fn orders() -> impl Iterator<Item = Matrix3<f64>> {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    ORDERS
        .into_iter()
        .flat_map(|order| {
            (0..8).map(move |signs: u32| {
                Matrix3::from_fn(|row, column| {
                    let sign = if signs >> row & 1 == 1 { -1.0 } else { 1.0 };
                    if order[row] == column { sign } else { 0.0 }
                })
            })
        })
        .filter(|matrix| *matrix != Matrix3::identity())
}

fn rotated(imu: &Series, matrix: &Matrix3<f64>) -> Series {
    let turn = |row: &Vec<f64>| {
        let rates = matrix * super::alignment::three(row);
        vec![rates.x, rates.y, rates.z]
    };
    Series { rows: imu.rows.iter().map(turn).collect(), ..imu.clone() }
}

/// What this order of the gyro's axes means.
fn named_order(matrix: &Matrix3<f64>, map: &ColumnMap) -> String {
    if *matrix == -Matrix3::identity() {
        return "pose.attitude: turns against the gyro about every axis: it looks like world to body; the columns must \
                be body to world (write a minus before qx, qy and qz)"
            .to_owned();
    }
    let name = |row: usize| {
        let column = (0..3).find(|column| matrix[(row, *column)] != 0.0).unwrap_or(row);
        let flips = if map.z_down { |axis: usize| if axis > 0 { -1.0 } else { 1.0 } } else { |_: usize| 1.0 };
        let found = map.imu.columns.get(column);
        let negated =
            matrix[(row, column)] * flips(row) * flips(column) * found.map_or(1.0, |column| column.factor.signum())
                < 0.0;
        format!("\"{}{}\"", if negated { "-" } else { "" }, found.map_or("?", |column| &column.name))
    };
    let wrong: Vec<&str> = (0..3).filter(|axis| matrix[(*axis, *axis)] != 1.0).map(|axis| AXES[axis]).collect();
    let [x, y, z] = [0, 1, 2].map(name);
    format!(
        "imu.rates: {} turn as the poses do in another order or sign: write rates = [{x}, {y}, {z}]",
        wrong.join(", ")
    )
}

/// What is wrong with all the rest.
pub fn of_flight(recording: &Recording, flown: &Flown, map: &ColumnMap, rotors: &Rotors, weight: f64) -> Vec<String> {
    // What is wrong first makes what comes later look wrong.
    let wrong_sensors = [
        sensors::speed_unit(flown),
        sensors::force_unit(flown),
        sensors::force_axes(flown, map),
        sensors::places(flown),
    ]
    .into_iter()
    .flatten()
    .next();
    let wrong_motors =
        [motors::battery(recording), motors::carried(recording, flown, weight), motors::motor_times(flown)]
            .into_iter()
            .flatten()
            .next();
    let wrong_motors = wrong_motors.or_else(|| motors::motor_order(flown, map, rotors));
    let estimate = if wrong_sensors.is_none() { estimate(flown) } else { None };
    [wrong_sensors, wrong_motors, estimate].into_iter().flatten().collect()
}

/// What is put right, but said.
pub fn remarks(flown: &Flown) -> String {
    let tilt = flown.tilt.angle().to_degrees();
    let tilt = if flown.is_felt {
        format!("  the poses' body leans {tilt:.1} degrees against the accelerometer's: taken away\n")
    } else {
        "  no accelerometer: forces are how speed changes, softened over 0.2 s\n".to_owned()
    };
    let late = match &flown.alignment {
        Some(alignment) => {
            let why = if flown.is_felt { ": on these, speed changes as the accelerometer felt" } else { "" };
            let whose = if flown.clock == Clock::Poses { "the poses'" } else { "the vehicle's" };
            format!("  {}\n  kept are {whose} times{why}\n", alignment.described())
        }
        None if flown.by_itself => "  no poses: places are the vehicle's own estimates\n".to_owned(),
        None => "  the vehicle does not turn enough to tell how late its poses are\n".to_owned(),
    };
    late + &tilt
}

fn estimate(flown: &Flown) -> Option<String> {
    let apart: Vec<f64> =
        flown.samples.iter().filter_map(|sample| Some((sample.own.as_ref()?.0 - sample.position).norm())).collect();
    let apart = median(apart)?;
    (apart > 1.0).then(|| {
        format!("estimate.position: is {apart:.2} m from the poses: another origin, another frame, or another unit")
    })
}
