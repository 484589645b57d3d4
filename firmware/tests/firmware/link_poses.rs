//! Poses in: frames, checks, velocities, repetitions.

use crate::support::receiver::{Fed, Local, newest, texts};
use crate::support::{extended, patched, v1, v2};
use core::f32::consts::FRAC_1_SQRT_2;
use estimation::estimator::{PoseMeasurement, Settings};
use firmware::link::pose::SOURCE_TIMEOUT_US;
use flight::Stamped;
use mavlink::dialects::common::{ATT_POS_MOCAP_DATA, MavFrame, ODOMETRY_DATA};
use nalgebra::{Quaternion, Vector3};

/// Facing east, nose level: in the law's world that is no rotation at all.
const EAST: [f32; 4] = [FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2];

pub fn odometry(time: u64) -> ODOMETRY_DATA {
    ODOMETRY_DATA {
        time_usec: time,
        // 1 m north, 2 m east, 3 m up.
        x: 1.0,
        y: 2.0,
        z: -3.0,
        q: EAST,
        // Forward 0.5 (east), right 0.25 (south), down 0.125.
        vx: 0.5,
        vy: 0.25,
        vz: 0.125,
        frame_id: MavFrame::MAV_FRAME_LOCAL_NED,
        child_frame_id: MavFrame::MAV_FRAME_BODY_FRD,
        ..Default::default()
    }
}

pub fn mocap(time: u64, x: f32) -> ATT_POS_MOCAP_DATA {
    ATT_POS_MOCAP_DATA { time_usec: time, q: EAST, x, y: 2.0, z: -3.0 }
}

fn close(a: Vector3<f32>, b: Vector3<f32>) -> bool {
    (a - b).norm() < 1e-5
}

#[test]
fn odometry_comes_out_in_the_laws_frames_with_the_first_ones_time_of_arrival() {
    let shared = Local::new();
    Fed::new(&shared).message(&odometry(1), 77);
    let pose = newest(&shared).unwrap();
    assert_eq!(pose.time, 77);
    assert_eq!(pose.value.position(), Vector3::new(2.0, 1.0, 3.0));
    assert!(close(pose.value.velocity().unwrap(), Vector3::new(0.5, -0.25, -0.125)), "{:?}", pose.value);
    assert!((pose.value.attitude().coords - Quaternion::identity().coords).norm() < 1e-6);
}

#[test]
fn odometrys_velocity_may_also_be_in_the_world() {
    let shared = Local::new();
    let child_frame_id = MavFrame::MAV_FRAME_LOCAL_NED;
    Fed::new(&shared).message(&ODOMETRY_DATA { child_frame_id, ..odometry(1) }, 0);
    assert_eq!(newest(&shared).unwrap().value.velocity(), Some(Vector3::new(0.25, 0.5, -0.125)));
}

#[test]
fn frames_that_are_not_converted_are_refused_in_words() {
    for (frame_id, child_frame_id) in [
        (MavFrame::MAV_FRAME_LOCAL_ENU, MavFrame::MAV_FRAME_BODY_FRD),
        (MavFrame::MAV_FRAME_GLOBAL, MavFrame::MAV_FRAME_BODY_FRD),
        (MavFrame::MAV_FRAME_LOCAL_NED, MavFrame::MAV_FRAME_LOCAL_FRD),
        (MavFrame::MAV_FRAME_LOCAL_NED, MavFrame::MAV_FRAME_GLOBAL),
    ] {
        let shared = Local::new();
        Fed::new(&shared).message(&ODOMETRY_DATA { frame_id, child_frame_id, ..odometry(1) }, 0);
        assert!(newest(&shared).is_none(), "{frame_id:?} {child_frame_id:?}");
        assert_eq!(texts(&shared), ["Pose refused: use LOCAL_NED and BODY_FRD"]);
    }
}

#[test]
fn no_field_that_is_used_may_be_nan_or_infinite() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX] {
        // Position, attitude, velocity, body rates; the covariances behind them are NaN for unknown.
        for field in 0..13 {
            let shared = Local::new();
            Fed::new(&shared).bytes(&patched(&odometry(1), 8 + 4 * field, value), 0);
            let (rate, taken) = (field >= 10, newest(&shared).is_some());
            assert!(!taken || (rate && value == f32::MAX), "ODOMETRY field {field}: {value}");
            let texts = texts(&shared);
            assert!(taken || texts.len() == 1);
            let words = format!(
                "Pose refused: {} is not finite",
                ["position", "attitude", "velocity", "body rate"][[0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 3, 3, 3][field]]
            );
            assert!(value.is_finite() || texts == [words], "ODOMETRY field {field}: {value}: {texts:?}");
        }
        for field in 13..55 {
            let shared = Local::new();
            Fed::new(&shared).bytes(&patched(&odometry(1), 8 + 4 * field, value), 0);
            let is_variance = [0, 6, 11, 15, 18, 20].contains(&(field - 13));
            let is_refused = is_variance && value.is_infinite();
            assert_eq!(newest(&shared).is_none(), is_refused, "ODOMETRY field {field}: {value}");
        }
        for field in 0..7 {
            let shared = Local::new();
            let mut fed = Fed::new(&shared);
            fed.message(&mocap(1_000, 0.0), 0);
            assert!(newest(&shared).is_some());
            fed.bytes(&patched(&mocap(11_000, 0.0), 8 + 4 * field, value), 10_000);
            assert!(newest(&shared).is_none(), "ATT_POS_MOCAP field {field}: {value}");
            assert_eq!(texts(&shared).len(), 1);
        }
    }
}

#[test]
fn only_rotations_are_attitudes() {
    for (scale, taken) in [(0.96, true), (1.04, true), (0.94, false), (1.06, false), (0.0, false)] {
        let shared = Local::new();
        Fed::new(&shared).message(&ODOMETRY_DATA { q: EAST.map(|part| part * scale), ..odometry(1) }, 0);
        let pose = newest(&shared);
        assert_eq!(pose.is_some(), taken, "{scale}");
        assert!(pose.is_none_or(|pose| (pose.value.attitude().norm() - 1.0).abs() < 1e-6));
    }
}

#[test]
fn a_pose_from_the_moon_is_refused() {
    let far = ODOMETRY_DATA { x: 10_001.0, ..odometry(1) };
    let fast = ODOMETRY_DATA { vz: 300.0, ..odometry(1) };
    for (message, field) in [(far, "position"), (fast, "velocity")] {
        let shared = Local::new();
        Fed::new(&shared).message(&message, 0);
        assert!(newest(&shared).is_none());
        assert_eq!(texts(&shared), [format!("Pose refused: {field} is out of range")]);
    }
}

#[test]
fn a_repeated_or_out_of_order_pose_never_counts() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    let (first, second) = (v2(1, &odometry(1_000)), v2(2, &odometry(2_000)));
    fed.bytes(&first, 1_000);
    fed.bytes(&second, 2_000);
    assert_eq!(newest(&shared).unwrap().time, 2_000);
    for count in 0..1_000 {
        fed.bytes(&second, 3_000 + 10_000 * count);
        fed.bytes(&first, 4_000 + 10_000 * count);
        assert!(newest(&shared).is_none());
    }
}

#[test]
fn one_source_is_listened_to_at_a_time() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&odometry(1_000), 0);
    fed.message(&mocap(20_000, 0.0), 10_000);
    fed.message(&mocap(30_000, 0.0), 20_000);
    assert_eq!(newest(&shared).unwrap().time, 0);
    fed.message(&mocap(2_000_000, 0.0), SOURCE_TIMEOUT_US);
    assert!(newest(&shared).is_none());
    fed.message(&mocap(2_010_000, 0.0), SOURCE_TIMEOUT_US + 1);
    assert_eq!(newest(&shared).unwrap().time, SOURCE_TIMEOUT_US + 1);
    assert_eq!(texts(&shared), ["Pose refused: another source is in use"]);
}

/// The fields of an ODOMETRY message besides the pose.
fn sent(message: ODOMETRY_DATA, extensions: [u8; 3]) -> PoseMeasurement {
    let shared = Local::new();
    Fed::new(&shared).bytes(&extended(&message, &extensions), 0);
    let Stamped { value, .. } = newest(&shared).unwrap();
    value
}

#[test]
fn odometrys_quality_reset_counter_and_covariance_go_along() {
    let plain = sent(odometry(1), [0, 0, 0]);
    // Reset counter, kind of estimator, quality.
    assert_eq!(sent(odometry(1), [7, 0, 0]), plain.reset_counter(7));
    assert_eq!(sent(odometry(1), [7, 0, 100]), plain.reset_counter(7).quality(100));
    assert_eq!(sent(odometry(1), [0, 3, 255]), plain.quality(-1));
    assert_ne!(plain.quality(-1), plain);
    let mut covariance = [0.0; 21];
    for (place, variance) in [(0, 1e-4), (6, 4e-4), (11, 1e-6), (15, 1e-6), (18, 1e-6), (20, 9e-6)] {
        covariance[place] = variance;
    }
    let known = sent(ODOMETRY_DATA { pose_covariance: covariance, ..odometry(1) }, [0, 0, 0]);
    assert_eq!(known, plain.deviations(4e-4_f32.sqrt(), 9e-6_f32.sqrt()));
    for place in [0, 6, 11, 15, 18, 20] {
        for unknown in [f32::NAN, 0.0, -1.0] {
            let mut covariance = covariance;
            covariance[place] = unknown;
            assert_eq!(sent(ODOMETRY_DATA { pose_covariance: covariance, ..odometry(1) }, [0, 0, 0]), plain);
        }
    }
}

#[test]
fn a_velocity_and_its_covariance_change_nothing_that_is_flown_as_the_page_says() {
    let plain = sent(odometry(1), [0, 0, 0]);
    for variance in [f32::NAN, f32::INFINITY, 0.0, 1e-9, 1e9] {
        let velocity_covariance = [variance; 21];
        assert_eq!(sent(ODOMETRY_DATA { velocity_covariance, ..odometry(1) }, [0, 0, 0]), plain);
    }
    let vehicle = *firmware::configuration::embedded().unwrap().vehicle();
    assert_eq!(Settings::bmi088(&vehicle).parameters().velocity_noise, 0.0, "no deviation: not fused");
    assert!(include_str!("../../../docs/mocap.md").contains("`velocity_covariance`\nis not read"));
}

#[test]
fn refusals_are_reported_once_a_second() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    for k in 0..250 {
        fed.message(&ODOMETRY_DATA { x: f32::NAN, ..odometry(k + 1) }, 10_000 * k);
    }
    assert_eq!(texts(&shared).len(), 3);
}

#[test]
fn version_1_poses_are_as_good() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.bytes(&v1(2, &mocap(1_000, 0.0)), 0);
    fed.bytes(&v1(3, &mocap(11_000, 0.0)), 10_000);
    assert!(newest(&shared).is_some());
}
