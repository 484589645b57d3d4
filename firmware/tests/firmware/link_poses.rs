//! Poses in: frames, checks, velocities, repetitions.

use crate::support::receiver::{Fed, Local, newest, texts};
use crate::support::{patched, v1, v2};
use core::f32::consts::FRAC_1_SQRT_2;
use firmware::link::pose::{GAP_MAX, SOURCE_SILENCE};
use mavlink::dialects::common::{ATT_POS_MOCAP_DATA, MavFrame, ODOMETRY_DATA};
use nalgebra::{Quaternion, Vector3};

/// Facing east, nose level: in the law's world that is no rotation at all.
const EAST: [f32; 4] = [FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2];

fn odometry(time: u64) -> ODOMETRY_DATA {
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

fn mocap(time: u64, x: f32) -> ATT_POS_MOCAP_DATA {
    ATT_POS_MOCAP_DATA { time_usec: time, q: EAST, x, y: 2.0, z: -3.0 }
}

fn close(a: Vector3<f32>, b: Vector3<f32>) -> bool {
    (a - b).norm() < 1e-5
}

#[test]
fn odometry_comes_out_in_the_laws_frames_with_its_time_of_arrival() {
    let shared = Local::new();
    Fed::new(&shared).message(&odometry(1), 77);
    let pose = newest(&shared).unwrap();
    assert_eq!(pose.time, 77);
    assert_eq!(pose.value.position(), Vector3::new(2.0, 1.0, 3.0));
    assert!(close(pose.value.velocity(), Vector3::new(0.5, -0.25, -0.125)), "{:?}", pose.value);
    assert!((pose.value.attitude().coords - Quaternion::identity().coords).norm() < 1e-6);
}

#[test]
fn odometrys_velocity_may_also_be_in_the_world() {
    let shared = Local::new();
    let child_frame_id = MavFrame::MAV_FRAME_LOCAL_NED;
    Fed::new(&shared).message(&ODOMETRY_DATA { child_frame_id, ..odometry(1) }, 0);
    assert_eq!(newest(&shared).unwrap().value.velocity(), Vector3::new(0.25, 0.5, -0.125));
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
        // Position, attitude, velocity, body rates; the covariances behind them say NaN for unknown.
        for field in 0..13 {
            let shared = Local::new();
            Fed::new(&shared).bytes(&patched(&odometry(1), 8 + 4 * field, value), 0);
            let rate = field >= 10;
            assert!(newest(&shared).is_none() || (rate && value == f32::MAX), "ODOMETRY field {field}: {value}");
            let texts = texts(&shared);
            assert!(newest(&shared).is_some() || texts.len() == 1);
            let words = format!(
                "Pose refused: {} is not finite",
                ["position", "attitude", "velocity", "body rate"][[0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 3, 3, 3][field]]
            );
            assert!(value.is_finite() || texts == [words], "ODOMETRY field {field}: {value}: {texts:?}");
        }
        for field in 13..55 {
            let shared = Local::new();
            Fed::new(&shared).bytes(&patched(&odometry(1), 8 + 4 * field, value), 0);
            assert!(newest(&shared).is_some(), "ODOMETRY field {field}: {value}");
        }
        for field in 0..7 {
            let shared = Local::new();
            let mut fed = Fed::new(&shared);
            fed.message(&mocap(1_000, 0.0), 0);
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
        assert_eq!(newest(&shared).is_some(), taken, "{scale}");
        assert!(newest(&shared).is_none_or(|pose| (pose.value.attitude().norm() - 1.0).abs() < 1e-6));
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
fn a_jump_of_a_position_becomes_no_velocity_now_or_later() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    // Ten metres away for one message: a thousand metres a second, there and back.
    for (count, x) in [(1, 0.0), (2, 0.0), (3, 10.0), (4, 0.0), (5, 0.0)] {
        fed.message(&mocap(10_000 * count, x), 10_000 * count);
        let pose = newest(&shared);
        assert_eq!(pose.is_some(), [2, 5].contains(&count), "message {count}");
        assert!(pose.is_none_or(|pose| pose.value.velocity().norm() < 1e-6), "message {count}: {pose:?}");
    }
}

#[test]
fn a_repeated_or_overtaken_pose_does_not_become_a_fresh_one() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    let (first, second) = (v2(1, &odometry(100)), v2(2, &odometry(200)));
    fed.bytes(&first, 1_000);
    fed.bytes(&second, 2_000);
    fed.bytes(&second, 3_000);
    fed.bytes(&first, 4_000);
    assert_eq!(newest(&shared).unwrap().time, 2_000);
    // A sender that starts again is believed once it has been silent.
    fed.message(&odometry(5), 2_000 + SOURCE_SILENCE);
    assert_eq!(newest(&shared).unwrap().time, 2_000);
    fed.message(&odometry(5), 2_001 + SOURCE_SILENCE);
    assert_eq!(newest(&shared).unwrap().time, 2_001 + SOURCE_SILENCE);
}

#[test]
fn a_sender_without_a_clock_is_believed() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    for now in [0, 10_000, 20_000] {
        fed.message(&odometry(0), now);
        assert_eq!(newest(&shared).unwrap().time, now);
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
    assert_eq!(texts(&shared), ["Pose refused: another source is in use"]);
}

#[test]
fn positions_alone_become_velocities_by_their_differences() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&mocap(1_000, 0.0), 0);
    assert!(newest(&shared).is_none(), "one position has no velocity");
    // 2 m/s north; the line delivers unevenly, the sender's clock counts.
    for k in 1..=40_u64 {
        fed.message(&mocap(1_000 + 10_000 * k, 0.02 * k as f32), 10_000 * k + 3_000 * (k % 3));
    }
    let pose = newest(&shared).unwrap();
    assert!((pose.value.velocity() - Vector3::new(0.0, 2.0, 0.0)).norm() < 1e-3, "{:?}", pose.value);
    assert_eq!(pose.time, 10_000 * 40 + 3_000);
}

#[test]
fn noise_of_positions_is_smoothed_to_a_quarter_and_a_ramp_lags_25_ms() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    let (mut sum, count) = (0.0, 4000);
    for k in 1..=count {
        // A millimetre up and down at random (a linear congruence's high bits).
        let noise = if (k * 1_103_515_245 + 12_345) >> 16 & 1 == 0 { 1e-3 } else { -1e-3 };
        fed.message(&mocap(10_000 * k, noise), 10_000 * k);
        sum += newest(&shared).map_or(0.0, |pose| pose.value.velocity().y.powi(2));
    }
    let unsmoothed = 2.0_f32.sqrt() * 1e-3 / 0.01;
    let ratio = (sum / count as f32).sqrt() / unsmoothed;
    assert!((0.2..0.32).contains(&ratio), "{ratio}");

    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    for k in 1..=100 {
        let t = 0.01 * k as f32;
        fed.message(&mocap(10_000 * k, t * t / 2.0), 10_000 * k);
    }
    let lag = 1.0 - newest(&shared).unwrap().value.velocity().y;
    assert!((lag - 0.025).abs() < 2e-3, "{lag}");
}

#[test]
fn no_difference_is_taken_over_a_gap() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&mocap(1_000, 0.0), 0);
    fed.message(&mocap(11_000, 0.0), 10_000);
    assert_eq!(newest(&shared).unwrap().time, 10_000);
    fed.message(&mocap(11_001 + GAP_MAX, 5.0), 10_001 + GAP_MAX);
    assert_eq!(newest(&shared).unwrap().time, 10_000);
    fed.message(&mocap(21_001 + GAP_MAX, 5.0), 20_001 + GAP_MAX);
    let pose = newest(&shared).unwrap();
    assert_eq!((pose.time, pose.value.velocity()), (20_001 + GAP_MAX, Vector3::zeros()));
}

#[test]
fn refusals_are_told_once_a_second() {
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
