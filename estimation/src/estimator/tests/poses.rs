//! Poses that are right, but late, seldom, out of order, or from a frame that moved.

use super::motion::{self, Rig, rest, tumble};
use crate::estimator::{Accepted, Estimator, EstimatorParameters, Rejected, Settings};
use crate::measurement::Stamped;
use nalgebra::{UnitQuaternion, Vector3};

fn exact(rig: &Rig, time: u64) -> Stamped<crate::estimator::PoseMeasurement> {
    Stamped { value: motion::pose(&rig.truth(time), &Vector3::zeros(), &UnitQuaternion::identity()), time }
}

#[test]
fn late_poses_give_the_state_of_now() {
    for late in [0, 1_000, 20_000, 77_300, 150_000, 200_000] {
        let mut rig = Rig::new(tumble);
        rig.fly(8_000_000, late);
        rig.check("late");
        // Position and attitude as they were would be off by 0.1 m and 0.9 rad at 150 ms.
        assert_eq!(rig.estimator.health(rig.now).counts.1, 0, "{late} us late");
    }
}

#[test]
fn ten_poses_a_second_are_enough() {
    let mut rig = Rig::new(tumble);
    for n in 1..=2_000_u64 {
        rig.step();
        if n % 20 == 0 && rig.now > 150_000 {
            let pose = exact(&rig, rig.now - 150_000);
            assert!(rig.estimator.pose(&pose, rig.now).is_ok());
        }
    }
    rig.check("10 Hz, 150 ms late");
}

#[test]
fn poses_out_of_order_leave_the_same_bits_as_in_order() {
    let run = |order: [u64; 6]| {
        let mut rig = Rig::new(tumble);
        rig.fly(2_000_000, 20_000);
        for _ in 0..20 {
            (0..12).for_each(|_| rig.step());
            for place in order {
                let pose = exact(&rig, rig.now - 60_000 + place * 7_300);
                assert_eq!(rig.estimator.pose(&pose, rig.now), Ok(Accepted::Fused), "{place}");
            }
        }
        (*rig.estimator.filter().unwrap(), rig.state(), rig)
    };
    let (filter, state, rig) = run([0, 1, 2, 3, 4, 5]);
    rig.check("in order");
    for order in [[1, 0, 3, 2, 5, 4], [5, 4, 3, 2, 1, 0], [2, 0, 5, 1, 4, 3]] {
        let (other, its_state, rig) = run(order);
        rig.check("out of order");
        assert_eq!(other, filter, "{order:?}");
        assert_eq!(its_state, state, "{order:?}");
    }
}

#[test]
fn a_pose_that_is_too_late_among_others_is_refused_and_changes_nothing() {
    let mut rig = Rig::new(tumble);
    rig.fly(2_000_000, 20_000);
    let (before, state) = (*rig.estimator.filter().unwrap(), rig.state());
    let late = exact(&rig, rig.now - 20_000 - 95_000);
    assert_eq!(rig.estimator.pose(&late, rig.now), Err(Rejected::TooOld));
    assert_eq!((*rig.estimator.filter().unwrap(), rig.state()), (before, state));
}

#[test]
fn a_late_pose_is_judged_by_itself_and_not_by_those_after_it() {
    let mut rig = Rig::new(tumble);
    rig.fly(2_000_000, 20_000);
    (0..12).for_each(|_| rig.step());
    let later = exact(&rig, rig.now - 10_000);
    assert_eq!(rig.estimator.pose(&later, rig.now), Ok(Accepted::Fused));
    let time = rig.now - 30_000;
    let away = motion::pose(&rig.truth(time), &(Vector3::x() * 5.0), &UnitQuaternion::identity());
    let lie = Stamped { value: away, time };
    assert_eq!(rig.estimator.pose(&lie, rig.now), Err(Rejected::Position));
    rig.check("without the lie");
}

#[test]
fn a_frame_move_that_is_reported_is_followed_in_one_step() {
    let mut rig = Rig::new(tumble);
    rig.fly(4_000_000, 20_000);
    let (offset, turn) = (Vector3::new(30.0, -5.0, 1.0), UnitQuaternion::from_scaled_axis(Vector3::z() * 2.0));
    // The new frame is the old one, turned about the origin and shifted.
    let made = |rig: &Rig, time: u64| {
        let mut truth = rig.truth(time);
        truth.position = turn * truth.position;
        truth.velocity = turn * truth.velocity;
        motion::pose(&truth, &offset, &turn).reset_counter(1)
    };
    let moved = Stamped { value: made(&rig, rig.now - 5_000), time: rig.now - 5_000 };
    let believed = rig.now - rig.estimator.health(rig.now).pose_age.unwrap();
    assert_eq!(rig.estimator.pose(&moved, rig.now), Ok(Accepted::Rebased));
    // It has yet to be agreed with.
    assert_eq!(rig.estimator.health(rig.now).pose_age, Some(rig.now - believed));
    let (state, truth) = (rig.state().unwrap(), rig.truth(rig.now));
    let position = turn * truth.position + offset;
    assert!((state.state.position.cast::<f64>() - position).norm() < 2e-3);
    assert!((state.state.velocity.cast::<f64>() - turn * truth.velocity).norm() < 2e-2);
    assert_eq!(state.jumps, 1);
    assert_eq!(rig.fly_with(1_000_000, 5_000, made), Some(Ok(Accepted::Fused)));
    assert_eq!(rig.estimator.health(rig.now).counts.1, 0);
    assert_eq!(rig.state().unwrap().jumps, 1);
}

#[test]
fn a_pose_from_before_the_frame_moved_is_too_late() {
    let mut rig = Rig::new(tumble);
    rig.fly(4_000_000, 20_000);
    let away = Vector3::new(30.0, -5.0, 1.0);
    let moved = motion::pose(&rig.truth(rig.now - 5_000), &away, &UnitQuaternion::identity()).reset_counter(1);
    let moved = Stamped { value: moved, time: rig.now - 5_000 };
    assert_eq!(rig.estimator.pose(&moved, rig.now), Ok(Accepted::Rebased));
    let state = rig.state();
    // Between two that were fused before.
    let late = exact(&rig, rig.now - 25_000);
    assert_eq!(rig.estimator.pose(&late, rig.now), Err(Rejected::TooOld));
    assert_eq!(rig.state(), state);
}

#[test]
fn velocities_are_believed_where_the_settings_give_them_a_deviation() {
    let flown = |velocity_noise: f32| {
        let parameters = EstimatorParameters { velocity_noise, ..EstimatorParameters::BMI088 };
        let mut rig = Rig::new(tumble);
        *rig.estimator = Estimator::new(&Settings::new(&parameters).unwrap());
        rig.fly(3_000_000, 20_000);
        rig.check("with velocities");
        let health = rig.estimator.health(rig.now);
        assert_eq!(health.counts.1, 0);
        let mut lie = exact(&rig, rig.now);
        lie.value.velocity = lie.value.velocity.map(|velocity| velocity + Vector3::x());
        (health.deviations.1, rig.estimator.pose(&lie, rig.now))
    };
    let (without, fused) = flown(0.0);
    let (with, refused) = flown(2e-3);
    assert!(with < 0.5 * without, "{with} and {without} m/s");
    assert_eq!((fused, refused), (Ok(Accepted::Fused), Err(Rejected::Velocity)));
}

#[test]
fn a_counter_that_runs_moves_no_frame_and_a_tilted_frame_is_none() {
    let mut rig = Rig::new(rest);
    rig.fly(4_000_000, 20_000);
    let mut count = 0_u8;
    let last = rig.fly_with(2_900_000, 20_000, |rig, time| {
        count = count.wrapping_add(1);
        let away = Vector3::x() * f64::from(count);
        motion::pose(&rig.truth(time), &away, &UnitQuaternion::identity()).reset_counter(count)
    });
    assert!(last.unwrap().is_err(), "{last:?}");
    assert_eq!(rig.estimator.health(rig.now).jumps, 1);
    let mut rig = Rig::new(rest);
    rig.fly(4_000_000, 20_000);
    let tilt = UnitQuaternion::from_scaled_axis(Vector3::x() * 0.3);
    let tilted = motion::pose(&rig.truth(0), &Vector3::zeros(), &tilt).reset_counter(1);
    let tilted = Stamped { value: tilted, time: rig.now };
    assert_eq!(rig.estimator.pose(&tilted, rig.now), Err(Rejected::Gravity));
    rig.check("as before");
}
