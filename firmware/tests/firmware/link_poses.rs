//! Poses in: frames, checks, velocities, repetitions.

use crate::support::receiver::{Fed, Local, newest, texts};
use crate::support::{extended, patched, v1, v2};
use controller_core::estimator::PoseMeasurement;
use controller_core::flight::Stamped;
use core::f32::consts::FRAC_1_SQRT_2;
use firmware::link::pose::SOURCE_SILENCE;
use firmware::link::sender_clock::STEADY;
use firmware::parameters::table::Name;
use mavlink::dialects::common::{ATT_POS_MOCAP_DATA, MavFrame, ODOMETRY_DATA, TIMESYNC_DATA};
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
        // Position, attitude, velocity, body rates; the covariances behind them say NaN for unknown.
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
            assert!(newest(&shared).is_some(), "ODOMETRY field {field}: {value}");
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
fn a_repeated_or_overtaken_pose_is_none_however_long() {
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

/// What becomes of ten messages, 10 ms apart, of a sender whose clock has been set to `start`, us, before the first.
fn set_back(message: impl Fn(u64) -> Vec<u8>, start: u64) -> Vec<Option<u64>> {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    for count in 0..100 {
        fed.bytes(&message(5_000_000 + 10_000 * count), 10_000 * count);
        assert_eq!(newest(&shared).map(|pose| pose.time), Some(10_000 * count));
    }
    let taken = (0..10).map(|count| {
        fed.bytes(&message(start + 10_000 * count), 1_000_000 + 10_000 * count);
        newest(&shared).map(|pose| pose.time)
    });
    taken.collect()
}

#[test]
fn a_clock_set_back_costs_no_more_than_40_ms_of_poses() {
    for start in [1, 1_000_000, 5_900_000] {
        for stamps in [set_back(|time| v2(1, &odometry(time)), start), set_back(|time| v2(1, &mocap(time, 0.0)), start)]
        {
            let lost = usize::from(STEADY) - 1;
            assert!(stamps[..lost].iter().all(Option::is_none), "{stamps:?}");
            let back: Vec<_> = (lost as u64..10).map(|count| Some(1_000_000 + 10_000 * count)).collect();
            assert_eq!(stamps[lost..], back, "from {start}");
        }
    }
}

#[test]
fn what_a_line_takes_longer_than_usual_is_told_by_the_senders_clock() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    for count in 0..50 {
        let late = if count % 2 == 1 { 30_000 } else { 0 };
        fed.message(&odometry(7_000_000 + 20_000 * count), 20_000 * count + late);
        let error = newest(&shared).unwrap().time.abs_diff(20_000 * count);
        assert!(error <= 20, "{error} us");
    }
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
fn a_sender_whose_clock_comes_and_goes_does_not_go_back_in_time() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    let mut stamps = Vec::new();
    // By the clock 5 ms later than the first; by its arrival, without a clock, 10 ms.
    for (time, now) in [(1_000, 0), (0, 10_000), (6_000, 20_000), (31_000, 30_000)] {
        fed.message(&odometry(time), now);
        stamps.extend(newest(&shared).map(|pose| pose.time));
    }
    assert_eq!(stamps, [0, 10_000, 30_000]);
}

/// When poses of a sender were true that is `ahead` us ahead and 30 to 50 ms late, and answers TIMESYNC by a clock that is
/// `answers` us ahead: the error of each stamp, us.
fn late_by_30_ms(shared: &Local, ahead: u64, answers: Option<u64>) -> Vec<i64> {
    let mut fed = Fed::new(shared);
    let truths = (0..100).map(|count| 1_000_000 + 10_000 * count);
    let errors = truths.enumerate().map(|(count, truth)| {
        fed.message(&odometry(truth + ahead), truth + 30_000 + count as u64 % 3 * 3_000);
        let pose = newest(shared).map(|pose| pose.time as i64 - truth as i64);
        if let Some(answers) = answers.filter(|_| count % 20 == 0) {
            // 1 ms there, 3 ms back.
            let asked = truth + 40_000;
            let sent = asked + 1_000 + answers;
            fed.message(&TIMESYNC_DATA { tc1: sent as i64 * 1_000, ts1: asked as i64 * 1_000 }, asked + 4_000);
        }
        pose
    });
    errors.flatten().collect()
}

#[test]
fn a_sender_that_answers_timesync_has_no_delay() {
    for ahead in [0, 77, 1_800_000_000_000_000] {
        let shared = Local::new();
        let errors = late_by_30_ms(&shared, ahead, Some(ahead));
        assert_eq!(errors[0], 30_000);
        // While the stamps are set back nothing goes back in time, and the sender, who did nothing wrong, is not scolded.
        assert_eq!(texts(&shared), [] as [&str; 0]);
        assert!((95..99).contains(&errors.len()), "{}", errors.len());
        assert!(errors[1..].iter().all(|error| error.abs() <= 1_050), "{errors:?}");
    }
}

#[test]
fn timesync_of_another_clock_says_nothing_and_a_delay_that_was_measured_does() {
    for answers in [None, Some(0), Some(10_000_000), Some(4_400_000)] {
        let shared = Local::new();
        let plain = late_by_30_ms(&shared, 5_000_000, answers);
        assert!(plain.iter().all(|error| (30_000..30_200).contains(error)), "{plain:?}");
        shared.parameters.set(Name::PoseDelay, 30.0).unwrap();
        let errors = late_by_30_ms(&shared, 5_000_000, answers);
        assert!(errors.iter().all(|error| (0..200).contains(error)), "{errors:?}");
    }
    // A sender without a clock has that delay as well.
    let shared = Local::new();
    shared.parameters.set(Name::PoseDelay, 30.0).unwrap();
    Fed::new(&shared).message(&odometry(0), 100_000);
    assert_eq!(newest(&shared).unwrap().time, 70_000);
}

/// A sender that answers TIMESYNC once a second, the first time more quickly than ever again; a pose each 10 ms for as long as there are
/// `ticks`; what its clock says of a true time and how late its poses are is `line`'s to say. What became of each.
fn synchronised(shared: &Local, ticks: u64, line: impl Fn(u64) -> (u64, u64)) -> Vec<(u64, Option<u64>)> {
    let mut fed = Fed::new(shared);
    let mut answered = 0;
    let truths = (0..ticks).map(|count| 1_000_000 + 10_000 * count);
    let stamps = truths.map(|truth| {
        let (says, late) = line(truth);
        let arrived = truth + late;
        fed.message(&odometry(says), arrived);
        let stamp = newest(shared).map(|pose| pose.time);
        if arrived >= answered + 1_000_000 {
            let way = if answered == 0 { 500 } else { 3_000 };
            answered = arrived;
            let asked = arrived - 2 * way;
            let sent = line(asked + way).0;
            fed.message(&TIMESYNC_DATA { tc1: sent as i64 * 1_000, ts1: asked as i64 * 1_000 }, arrived);
        }
        (truth, stamp)
    });
    stamps.collect()
}

/// Greatest error of the stamps of poses from `from` on, us.
fn worst(stamps: &[(u64, Option<u64>)], from: u64) -> u64 {
    let errors = stamps.iter().filter(|(truth, _)| *truth >= from);
    errors.filter_map(|(truth, stamp)| stamp.map(|stamp| stamp.abs_diff(*truth))).max().unwrap()
}

#[test]
fn what_timesync_said_of_a_clock_does_not_count_once_it_was_set_back() {
    for back in [100_000, 200_000, 450_000, 5_000_000] {
        let shared = Local::new();
        let clock = |truth: u64| 1_700_000_000_000_000 + truth - if truth >= 5_500_000 { back } else { 0 };
        let stamps = synchronised(&shared, 1_500, |truth| (clock(truth), 20_000));
        assert!(worst(&stamps, 2_500_000) <= 3_500, "{back}: {} us", worst(&stamps, 2_500_000));
        let lost = stamps.iter().filter(|(truth, stamp)| *truth >= 2_500_000 && stamp.is_none()).count();
        assert!(lost <= usize::from(STEADY), "{lost}");
    }
}

#[test]
fn a_stream_that_timesync_knows_to_be_late_is_never_fresh() {
    let shared = Local::new();
    let late = |truth: u64| if truth < 5_000_000 { 20_000 } else { 620_000 };
    let stamps = synchronised(&shared, 2_000, |truth| (1_700_000_000_000_000 + truth, late(truth)));
    let taken = stamps.iter().filter(|(truth, _)| *truth >= 2_500_000);
    assert!(taken.into_iter().all(|(truth, stamp)| stamp.is_some() == (*truth < 5_000_000)));
    assert!(texts(&shared).contains(&"Pose refused: more than 0.5 s late".to_owned()));
}

#[test]
fn a_late_stream_without_timesync_is_refused_with_the_remedy() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&odometry(1_000), 0);
    // 0.6 s late from now on, and too unsteady to be a clock that was set.
    for count in 1..200 {
        fed.message(&odometry(1_000 + 10_000 * count), 600_000 + 10_000 * count + count % 3 * 25_000);
    }
    let texts = texts(&shared);
    assert!(texts.iter().all(|text| text == "Pose refused: 0.5 s late; let it answer TIMESYNC"), "{texts:?}");
    assert!(!texts.is_empty());
    // A time that does not advance is another matter.
    fed.message(&odometry(1_000), 9_000_000);
    assert_eq!(self::texts(&shared), ["Pose refused: its time does not advance"]);
}

#[test]
fn a_clock_that_stood_still_is_believed_once_timesync_has_said_so() {
    let shared = Local::new();
    let clock = |truth: u64| if truth < 5_000_000 { truth } else { truth.saturating_sub(900_000).max(5_000_000) };
    let stamps = synchronised(&shared, 1_500, |truth| (1_700_000_000_000_000 + clock(truth), 20_000));
    let back = stamps.iter().find(|(truth, stamp)| *truth > 6_000_000 && stamp.is_some()).unwrap().0;
    assert!(back < 8_000_000 && worst(&stamps, back) <= 25_000, "{back}, {} us", worst(&stamps, back));
    assert!(worst(&stamps, back + 1_500_000) <= 3_500);
}

#[test]
fn one_source_is_listened_to_at_a_time() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&odometry(1_000), 0);
    fed.message(&mocap(20_000, 0.0), 10_000);
    fed.message(&mocap(30_000, 0.0), 20_000);
    assert_eq!(newest(&shared).unwrap().time, 0);
    fed.message(&mocap(2_000_000, 0.0), SOURCE_SILENCE);
    assert!(newest(&shared).is_none());
    fed.message(&mocap(2_010_000, 0.0), SOURCE_SILENCE + 1);
    assert_eq!(newest(&shared).unwrap().time, SOURCE_SILENCE + 1);
    assert_eq!(texts(&shared), ["Pose refused: another source is in use"]);
}

/// What the sender says of an ODOMETRY message besides the pose.
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
