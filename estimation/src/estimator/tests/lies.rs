//! Poses that lie: none of them moves the state, each is rejected by name, and the truth is found again.

use super::motion::{self, Rig, rest, tumble};
use crate::estimator::{Accepted, Fault, PoseMeasurement, Rejected};
use crate::measurement::Stamped;
use nalgebra::{UnitQuaternion, Vector3};

const STRAIGHT: UnitQuaternion<f64> = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(1.0, 0.0, 0.0, 0.0));

/// Two seconds of truth, then of a lie; the state stays within what coasting leaves. Returns what became of the last.
fn rejection(rig: &mut Rig, seconds: f64, lie: impl Fn(&Rig, f64, u64) -> PoseMeasurement) -> Rejected {
    rig.fly(3_000_000, 20_000);
    let began = rig.now;
    let last = rig
        .fly_with((seconds * 1e6) as u64, 20_000, |rig, time| lie(rig, time.saturating_sub(began) as f64 * 1e-6, time));
    let (p, v, q) = rig.errors();
    assert!(p < 0.03 && v < 0.05 && q < 0.01, "{p} m, {v} m/s, {q} rad");
    let health = rig.estimator.health(rig.now);
    assert!(health.faults.contain(Fault::NoPose), "{health:?}");
    assert_eq!(health.jumps, 0);
    last.unwrap().unwrap_err()
}

#[test]
fn permanent_jumps_are_reported_and_not_followed() {
    for path in [rest as motion::Path, tumble] {
        for distance in [0.3, 5.0, 100.0] {
            let mut rig = Rig::new(path);
            let offset = Vector3::new(distance, 0.0, 0.0);
            let lie = |rig: &Rig, _, time| motion::pose(&rig.truth(time), &offset, &STRAIGHT);
            assert_eq!(rejection(&mut rig, 0.7, lie), Rejected::Jump, "{distance} m");
            // Back, it is believed at once.
            let pose =
                Stamped { value: motion::pose(&rig.truth(rig.now), &Vector3::zeros(), &STRAIGHT), time: rig.now };
            assert_eq!(rig.estimator.pose(&pose, rig.now), Ok(Accepted::Fused));
        }
    }
}

#[test]
fn those_who_know_better_follow_a_jump() {
    let mut rig = Rig::new(tumble);
    let offset = Vector3::new(5.0, 0.0, 0.0);
    let lie = |rig: &Rig, _, time| motion::pose(&rig.truth(time), &offset, &STRAIGHT);
    assert!(!rig.estimator.adopt());
    rejection(&mut rig, 0.7, lie);
    assert!(rig.estimator.adopt());
    assert!(!rig.estimator.adopt());
    let position = rig.state().unwrap().state.position.cast::<f64>();
    assert!((position - rig.truth(rig.now).position - offset).norm() < 2e-3);
    assert_eq!(rig.estimator.health(rig.now).jumps, 1);
    let made = |rig: &Rig, time| motion::pose(&rig.truth(time), &offset, &STRAIGHT);
    assert_eq!(rig.fly_with(100_000, 20_000, made), Some(Ok(Accepted::Fused)));
}

#[test]
fn flips_are_reported() {
    let half_turn = |axis: Vector3<f64>| UnitQuaternion::from_scaled_axis(axis * core::f64::consts::PI);
    for path in [rest as motion::Path, tumble] {
        for (axis, names) in [
            // About the vertical, gravity says nothing against it: but the gyro has felt no turn.
            (Vector3::z(), [Rejected::Turned, Rejected::Attitude]),
            (Vector3::x(), [Rejected::Gravity, Rejected::Attitude]),
        ] {
            let mut rig = Rig::new(path);
            let lie = |rig: &Rig, _, time| motion::pose(&rig.truth(time), &Vector3::zeros(), &half_turn(axis));
            let reason = rejection(&mut rig, 0.7, lie);
            assert!(names.contains(&reason), "{reason:?}");
        }
    }
}

#[test]
fn a_turn_that_the_gyro_has_not_felt_is_detected_from_a_few_degrees_on() {
    for angle in [0.15, 0.5, -1.0] {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * angle);
        let lie = |rig: &Rig, _, time| motion::pose(&rig.truth(time), &Vector3::zeros(), &turn);
        assert_eq!(rejection(&mut Rig::new(rest), 0.7, lie), Rejected::Turned, "{angle} rad");
    }
}

#[test]
fn a_frozen_stream_is_detected_by_the_accelerometer_alone() {
    for sign in [1.0, -1.0] {
        let mut rig = Rig::new(rest);
        rig.fly(3_000_000, 20_000);
        // Heavier, or lighter.
        rig.biases.1 = Vector3::new(0.0, 0.0, sign);
        let last = rig.fly_with(200_000, 20_000, |rig, _| motion::pose(&rig.truth(0), &Vector3::zeros(), &STRAIGHT));
        assert_eq!(last, Some(Err(Rejected::Frozen)), "{sign} m/s^2");
    }
}

#[test]
fn poses_that_stand_still_are_frozen_in_the_air_and_true_once_the_vehicle_may_stand() {
    let still = |rig: &Rig, _| motion::pose(&rig.truth(0), &Vector3::zeros(), &STRAIGHT);
    let mut rig = Rig::new(rest);
    rig.fly(3_000_000, 20_000);
    rig.estimator.may_stand(false);
    // What noise there is at rest as well.
    rig.biases.1 = Vector3::new(0.0, 0.0, 0.1);
    assert_eq!(rig.fly_with(100_000, 20_000, still), Some(Err(Rejected::Frozen)));
    rig.estimator.may_stand(true);
    assert_eq!(rig.fly_with(100_000, 20_000, still), Some(Ok(Accepted::Fused)));
    // Carried about, it moves beyond any noise; then it does not matter that it is put down.
    rig.biases.1.z = 1.0;
    assert_eq!(rig.fly_with(50_000, 20_000, still), Some(Err(Rejected::Frozen)));
    rig.biases.1.z = 0.0;
    rig.estimator.may_stand(true);
    assert_eq!(rig.fly_with(100_000, 20_000, still), Some(Err(Rejected::Frozen)));
}

#[test]
fn a_drift_is_reported_and_not_followed() {
    for path in [rest as motion::Path, tumble] {
        let mut rig = Rig::new(path);
        let lie = |rig: &Rig, t: f64, time| motion::pose(&rig.truth(time), &(Vector3::x() * (0.5 * t)), &STRAIGHT);
        let reason = rejection(&mut rig, 0.9, lie);
        assert!(reason == Rejected::Drift, "{reason:?}");
    }
}

#[test]
fn a_frozen_stream_is_detected_in_motion() {
    let mut rig = Rig::new(tumble);
    let lie = |rig: &Rig, _, _| motion::pose(&rig.truth(3_000_000), &Vector3::zeros(), &STRAIGHT);
    assert_eq!(rejection(&mut rig, 0.7, lie), Rejected::Frozen);
}

#[test]
fn a_resent_frame_is_as_good_as_silence() {
    let mut rig = Rig::new(tumble);
    rig.fly(3_000_000, 20_000);
    let frame = Stamped { value: motion::pose(&rig.truth(rig.now), &Vector3::zeros(), &STRAIGHT), time: rig.now };
    assert_eq!(rig.estimator.pose(&frame, rig.now), Ok(Accepted::Fused));
    for n in 0..1_000_u64 {
        rig.step();
        assert_eq!(rig.estimator.pose(&frame, rig.now), Err(Rejected::Repeated));
        assert_eq!(rig.estimator.health(rig.now).pose_age, Some((n + 1) * 5_000));
    }
}

#[test]
fn however_uncertain_the_estimate_a_pose_metres_away_is_never_just_fused() {
    let mut rig = Rig::new(tumble);
    rig.fly(3_000_000, 20_000);
    (0..8_000).for_each(|_| rig.step());
    let before = rig.state().unwrap().state.position;
    // Five metres would be within the gate now.
    assert!(rig.estimator.health(rig.now).deviations.0 > 1.0);
    let away = before.cast::<f64>() - rig.truth(rig.now).position + Vector3::new(5.0, 0.0, 0.0);
    let pose = Stamped { value: motion::pose(&rig.truth(rig.now), &away, &STRAIGHT), time: rig.now };
    assert_eq!(rig.estimator.pose(&pose, rig.now), Err(Rejected::Position));
    assert_eq!(rig.state().unwrap().state.position, before);
}

#[test]
fn single_outliers_cost_nothing() {
    let mut rig = Rig::new(tumble);
    rig.fly(3_000_000, 20_000);
    let mut n = 0;
    rig.fly_with(3_000_000, 20_000, |rig, time| {
        n += 1;
        let offset = if n % 7 == 0 { Vector3::new(0.0, 0.2, 0.0) } else { Vector3::zeros() };
        motion::pose(&rig.truth(time), &offset, &STRAIGHT)
    });
    rig.check("outliers");
    let health = rig.estimator.health(rig.now);
    assert_eq!(health.counts.1, 300 / 7);
    assert!(!health.faults.contain(Fault::NoPose));
}

#[test]
fn a_body_lost_and_found_where_coasting_led_is_followed_and_one_elsewhere_is_not() {
    for (offset, found) in [(0.1, true), (3.0, false)] {
        let mut rig = Rig::new(tumble);
        rig.fly(3_000_000, 20_000);
        (0..200).for_each(|_| rig.step());
        let away = Vector3::new(0.0, offset, 0.0);
        let mut refound = 0;
        for _ in 0..100 {
            let made = |rig: &Rig, time| motion::pose(&rig.truth(time), &away, &STRAIGHT);
            refound += u32::from(rig.fly_with(10_000, 20_000, made) == Some(Ok(Accepted::Refound)));
        }
        assert_eq!((refound == 1, rig.estimator.health(rig.now).is_good()), (found, found), "{offset} m");
        let position = rig.state().unwrap().state.position.cast::<f64>();
        let expected = rig.truth(rig.now).position + if found { away } else { Vector3::zeros() };
        assert!((position - expected).norm() < 0.05);
    }
}
