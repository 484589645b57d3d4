//! What a person on the bench looks at, before there is any pose: the inertial sensor, vibration, and single values by
//! name.
//!
//! | NAMED_VALUE_FLOAT | is |
//! |---|---|
//! | `TICK_MAX`, `TICK_LATE` | the longest tick and the worst delay of its start since boot, us |
//! | `TICK_MISS`, `IMU_GAPS` | ticks that were missed, and breaks in the IMU's samples, since boot |
//! | `CAL_GYRO`, `CAL_ACCEL`, `CAL_LEVEL` | 1 where the gyro's bias was found since boot, the accelerometer was ever calibrated, and its level |
//! | `LEVEL_M1` … `LEVEL_M4` | the thrust with which the law would level the vehicle as it is held, over the rotors' mean: above 1 for those that would speed up. No motor turns by it |
//!
//! They are sent in turn. Those that have no value are left out.

use super::View;
use crate::frames;
use mavlink::dialects::common::{HIGHRES_IMU_DATA, HighresImuUpdatedFlags, NAMED_VALUE_FLOAT_DATA, VIBRATION_DATA};

/// The fields of HIGHRES_IMU that there are.
const MEASURED: HighresImuUpdatedFlags = HighresImuUpdatedFlags::HIGHRES_IMU_UPDATED_XACC
    .union(HighresImuUpdatedFlags::HIGHRES_IMU_UPDATED_YACC)
    .union(HighresImuUpdatedFlags::HIGHRES_IMU_UPDATED_ZACC)
    .union(HighresImuUpdatedFlags::HIGHRES_IMU_UPDATED_XGYRO)
    .union(HighresImuUpdatedFlags::HIGHRES_IMU_UPDATED_YGYRO)
    .union(HighresImuUpdatedFlags::HIGHRES_IMU_UPDATED_ZGYRO);

/// Rates and specific force, as the newest sample has them: low-passed, calibrated.
pub fn imu(view: &View) -> Option<HIGHRES_IMU_DATA> {
    let sample = view.imu?;
    let rate = frames::body(&sample.value.angular_velocity);
    let force = frames::body(&sample.value.specific_force);
    Some(HIGHRES_IMU_DATA {
        time_usec: sample.time,
        xacc: force.x,
        yacc: force.y,
        zacc: force.z,
        xgyro: rate.x,
        ygyro: rate.y,
        zgyro: rate.z,
        fields_updated: MEASURED,
        ..HIGHRES_IMU_DATA::DEFAULT
    })
}

/// Levels as ArduPilot measures them, m/s^2, and samples at full scale.
pub fn vibration(view: &View) -> Option<VIBRATION_DATA> {
    let report = view.vibration?;
    Some(VIBRATION_DATA {
        time_usec: view.now,
        vibration_x: report.level.x,
        vibration_y: report.level.y,
        vibration_z: report.level.z,
        clipping_0: report.clipped,
        clipping_1: 0,
        clipping_2: 0,
    })
}

/// A value's name, and what it is now.
type Named = (&'static str, fn(&View) -> Option<f32>);

/// How many there are.
pub const NAMED_COUNT: usize = NAMED.len();

const NAMED: [Named; 11] = [
    ("TICK_MAX", |view| Some(view.report()?.timing.worst_duration as f32)),
    ("TICK_LATE", |view| Some(view.report()?.timing.worst_jitter as f32)),
    ("TICK_MISS", |view| Some(view.report()?.timing.missed as f32)),
    ("IMU_GAPS", |view| Some(view.report()?.timing.gaps as f32)),
    ("CAL_GYRO", |view| Some(f32::from(view.calibrated.gyro))),
    ("CAL_ACCEL", |view| Some(f32::from(view.calibrated.accelerometer))),
    ("CAL_LEVEL", |view| Some(f32::from(view.calibrated.level))),
    ("LEVEL_M1", |view| levelling(view, 0)),
    ("LEVEL_M2", |view| levelling(view, 1)),
    ("LEVEL_M3", |view| levelling(view, 2)),
    ("LEVEL_M4", |view| levelling(view, 3)),
];

fn levelling(view: &View, rotor: usize) -> Option<f32> {
    view.report()?.levelling?.get(rotor).copied()
}

/// The value whose turn it is, or the next that there is.
pub fn named(view: &View) -> Option<NAMED_VALUE_FLOAT_DATA> {
    let later = NAMED.iter().cycle().skip(view.turn % NAMED_COUNT).take(NAMED_COUNT);
    let (name, value) = later.filter_map(|(name, value)| Some((*name, value(view)?))).next()?;
    Some(NAMED_VALUE_FLOAT_DATA { time_boot_ms: (view.now / 1000) as u32, value, name: name.into() })
}
