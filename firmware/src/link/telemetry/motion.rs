//! How the vehicle moves, and where it is to be.

use crate::frames;
use crate::link::origin::Origin;
use crate::shared::report::Report;
use crate::status::euler;
use controller_core::math;
use estimation::estimator::health::NIS_MEAN_MAX;
use estimation::estimator::{COASTING_AFTER_US, Fault, Health};
use flight::Mode;
use mavlink::dialects::common::{
    ATTITUDE_DATA, ATTITUDE_QUATERNION_DATA, ESTIMATOR_STATUS_DATA, EstimatorStatusFlags, GLOBAL_POSITION_INT_DATA,
    GPS_GLOBAL_ORIGIN_DATA, HOME_POSITION_DATA, LOCAL_POSITION_NED_DATA, MavFrame, ODOMETRY_DATA,
    POSITION_TARGET_LOCAL_NED_DATA, PositionTargetTypemask, SYSTEM_TIME_DATA,
};

/// A time stamp's milliseconds, which start again after 2^32.
fn milliseconds(time: u64) -> u32 {
    (time / 1000) as u32
}

/// Attitude as angles, and body rates, at `time`, us; none without an estimate, as everything here. But on the bench,
/// before there is one, gravity gives roll and pitch, with a yaw of 0: of all messages this one alone, with the AHRS of
/// SYS_STATUS unhealthy and no flag of ESTIMATOR_STATUS.
pub fn attitude(time: u64, report: &Report) -> Option<ATTITUDE_DATA> {
    let (attitude, rates, yaw_share) = match (&report.state, &report.lean) {
        (Some(state), _) => (&state.attitude, &state.angular_velocity, 1.0),
        (None, Some(lean)) => (&lean.attitude, &lean.angular_velocity, 0.0),
        (None, None) => return None,
    };
    let angles = euler(&frames::attitude(attitude));
    let rates = frames::body(rates);
    Some(ATTITUDE_DATA {
        time_boot_ms: milliseconds(time),
        roll: angles.roll.to_radians(),
        pitch: angles.pitch.to_radians(),
        yaw: yaw_share * angles.yaw.to_radians(),
        rollspeed: rates.x,
        pitchspeed: rates.y,
        yawspeed: rates.z,
    })
}

/// Attitude and body rates.
pub fn attitude_quaternion(time: u64, report: &Report) -> Option<ATTITUDE_QUATERNION_DATA> {
    let state = report.state.as_ref()?;
    let q = frames::attitude(&state.attitude);
    let rates = frames::body(&state.angular_velocity);
    Some(ATTITUDE_QUATERNION_DATA {
        time_boot_ms: milliseconds(time),
        q1: q.w,
        q2: q.i,
        q3: q.j,
        q4: q.k,
        rollspeed: rates.x,
        pitchspeed: rates.y,
        yawspeed: rates.z,
    })
}

/// Position and velocity.
pub fn position(time: u64, report: &Report) -> Option<LOCAL_POSITION_NED_DATA> {
    let state = report.state.as_ref()?;
    let (p, v) = (frames::world(&state.position), frames::world(&state.velocity));
    Some(LOCAL_POSITION_NED_DATA {
        time_boot_ms: milliseconds(time),
        x: p.x,
        y: p.y,
        z: p.z,
        vx: v.x,
        vy: v.y,
        vz: v.z,
    })
}

/// The same on the globe, as far as its origin means anything.
pub fn global_position(time: u64, report: &Report, origin: &Origin) -> Option<GLOBAL_POSITION_INT_DATA> {
    let state = report.state.as_ref()?;
    let (p, v) = (frames::world(&state.position), frames::world(&state.velocity));
    let place = origin.place(&p);
    let home = report.home.map_or(0.0, |home| frames::world(&home).z);
    let yaw = euler(&frames::attitude(&state.attitude)).yaw;
    let centimetres = |speed: f32| (speed * 100.0) as i16;
    Some(GLOBAL_POSITION_INT_DATA {
        time_boot_ms: milliseconds(time),
        lat: place.latitude,
        lon: place.longitude,
        alt: (place.altitude * 1e3) as i32,
        relative_alt: ((home - p.z) * 1e3) as i32,
        vx: centimetres(v.x),
        vy: centimetres(v.y),
        vz: centimetres(v.z),
        // Hundredths of a degree, 0 to 359.99.
        hdg: ((if yaw < 0.0 { yaw + 360.0 } else { yaw }) * 100.0) as u16 % 36_000,
    })
}

/// Position, attitude, velocity and rates, with the estimator's uncertainty.
pub fn odometry(time: u64, report: &Report) -> Option<ODOMETRY_DATA> {
    let state = report.state.as_ref()?;
    let q = frames::attitude(&state.attitude);
    let p = frames::world(&state.position);
    let turned = nalgebra::UnitQuaternion::new_unchecked(state.attitude).inverse() * state.velocity;
    let (v, rates) = (frames::body(&turned), frames::body(&state.angular_velocity));
    let (position, velocity, attitude) = report.health.deviations;
    Some(ODOMETRY_DATA {
        time_usec: time,
        x: p.x,
        y: p.y,
        z: p.z,
        q: [q.w, q.i, q.j, q.k],
        vx: v.x,
        vy: v.y,
        vz: v.z,
        rollspeed: rates.x,
        pitchspeed: rates.y,
        yawspeed: rates.z,
        pose_covariance: diagonal(position, attitude),
        velocity_covariance: diagonal(velocity, f32::NAN),
        frame_id: MavFrame::MAV_FRAME_LOCAL_NED,
        child_frame_id: MavFrame::MAV_FRAME_BODY_FRD,
    })
}

/// The upper triangle of a covariance of which two traces are known by their roots; the rest is unknown, sent as NaN,
/// or zero.
fn diagonal(first: f32, second: f32) -> [f32; 21] {
    // Row by row: the diagonal's places.
    let mut triangle = [0.0; 21];
    for (place, root) in [(0, first), (6, first), (11, first), (15, second), (18, second), (20, second)] {
        if let Some(entry) = triangle.get_mut(place) {
            *entry = root * root / 3.0;
        }
    }
    triangle
}

/// The reference that is flown. By the IMU alone it has no position: the vehicle is held level and goes down so fast.
pub fn position_target(time: u64, report: &Report) -> Option<POSITION_TARGET_LOCAL_NED_DATA> {
    let reference = report.reference.as_ref()?;
    let [p, v, a] = [&reference.position, &reference.velocity, &reference.acceleration].map(frames::world);
    let direction = reference.heading.direction();
    let yaw = frames::heading(micromath::F32Ext::atan2(direction.y, direction.x));
    Some(POSITION_TARGET_LOCAL_NED_DATA {
        time_boot_ms: milliseconds(time),
        x: p.x,
        y: p.y,
        z: p.z,
        vx: v.x,
        vy: v.y,
        vz: v.z,
        afx: a.x,
        afy: a.y,
        afz: a.z,
        yaw,
        yaw_rate: frames::heading_rate(reference.heading.rate()),
        type_mask: if report.mode == Mode::Descending { NO_PLACE } else { PositionTargetTypemask::empty() },
        coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
    })
}

/// The bits that set aside where to be and where to point.
const NO_PLACE: PositionTargetTypemask = PositionTargetTypemask::POSITION_TARGET_TYPEMASK_X_IGNORE
    .union(PositionTargetTypemask::POSITION_TARGET_TYPEMASK_Y_IGNORE)
    .union(PositionTargetTypemask::POSITION_TARGET_TYPEMASK_Z_IGNORE)
    .union(PositionTargetTypemask::POSITION_TARGET_TYPEMASK_YAW_IGNORE);

/// Where the vehicle was armed; before that, where it stands.
pub fn home(report: &Report, origin: &Origin) -> Option<HOME_POSITION_DATA> {
    let home = frames::world(report.home.as_ref()?);
    let place = origin.place(&home);
    Some(HOME_POSITION_DATA {
        latitude: place.latitude,
        longitude: place.longitude,
        altitude: (place.altitude * 1e3) as i32,
        x: home.x,
        y: home.y,
        z: home.z,
        q: [1.0, 0.0, 0.0, 0.0],
        ..HOME_POSITION_DATA::DEFAULT
    })
}

/// Where the local frame's origin is.
pub fn origin(origin: &Origin) -> GPS_GLOBAL_ORIGIN_DATA {
    let Origin { latitude, longitude, altitude } = *origin;
    GPS_GLOBAL_ORIGIN_DATA { latitude, longitude, altitude }
}

/// The estimate's health. Ratios are 1 where the estimator would call its poses inconsistent.
pub fn estimator_status(time: u64, report: &Report) -> ESTIMATOR_STATUS_DATA {
    use EstimatorStatusFlags as Flags;
    let Health { faults, pose_age, deviations: (position, ..), nis, .. } = report.health;
    let certain = report.state.is_some() && !faults.contain(Fault::Uncertain);
    let mut flags = Flags::empty();
    flags.set(Flags::ESTIMATOR_ATTITUDE, certain);
    flags.set(Flags::ESTIMATOR_VELOCITY_HORIZ | Flags::ESTIMATOR_VELOCITY_VERT, certain);
    let known = certain && pose_age.is_some_and(|age| age <= COASTING_AFTER_US);
    flags.set(Flags::ESTIMATOR_POS_HORIZ_REL | Flags::ESTIMATOR_POS_HORIZ_ABS, known);
    flags.set(Flags::ESTIMATOR_POS_VERT_ABS | Flags::ESTIMATOR_PRED_POS_HORIZ_REL, known);
    flags.set(Flags::ESTIMATOR_PRED_POS_HORIZ_ABS, known);
    flags.set(Flags::ESTIMATOR_ACCEL_ERROR, faults.contain(Fault::AccelerometerBias));
    let ratio = |nis: f32| math::sqrt(nis / NIS_MEAN_MAX);
    ESTIMATOR_STATUS_DATA {
        time_usec: time,
        pos_horiz_ratio: ratio(nis.0),
        pos_vert_ratio: ratio(nis.0),
        pos_horiz_accuracy: position,
        pos_vert_accuracy: position,
        flags,
        ..ESTIMATOR_STATUS_DATA::DEFAULT
    }
}

/// The time since boot; the time of day is unknown.
pub fn system_time(now: u64) -> SYSTEM_TIME_DATA {
    SYSTEM_TIME_DATA { time_unix_usec: 0, time_boot_ms: milliseconds(now) }
}
