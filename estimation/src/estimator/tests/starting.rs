//! How an estimate begins, and when it does not.

use super::motion::{self, Rig, rest, spin, tumble};
use crate::estimator::candidate::POSES_MIN;
use crate::estimator::{Accepted, COASTING_AFTER_US, Fault, Rejected};
use crate::measurement::Stamped;
use nalgebra::{UnitQuaternion, Vector3};

#[test]
fn it_begins_at_rest_and_in_a_tumble_from_poses_alone() {
    for path in [rest as motion::Path, tumble] {
        let mut rig = Rig::new(path);
        rig.fly(400_000, 20_000);
        assert_eq!(rig.state(), None);
        assert_eq!(rig.estimator.health(rig.now).faults.worst(), Some(Fault::NotStarted));
        assert_eq!(rig.estimator.health(rig.now).last, Some(Ok(Accepted::Aligning)));
        rig.fly(1_600_000, 20_000);
        rig.check("after 2 s");
        let health = rig.estimator.health(rig.now);
        assert!(health.is_good() && health.last == Some(Ok(Accepted::Fused)), "{health:?}");
        assert_eq!(health.counts.1, 0);
    }
}

#[test]
fn it_does_not_begin_where_accelerometer_and_poses_disagree_on_up() {
    // Upside down, on its side, by 10.5 degrees; and an accelerometer that feels nothing. At rest, and tumbling.
    for path in [rest as motion::Path, tumble] {
        for angle in [180.0_f64, 90.0, 10.5] {
            let mut rig = Rig::new(path);
            let turn = UnitQuaternion::from_scaled_axis(Vector3::x() * angle.to_radians());
            let (mut gravity, mut refused) = (0, 0);
            for _ in 0..300 {
                let last =
                    rig.fly_with(10_000, 20_000, |rig, time| motion::pose(&rig.truth(time), &Vector3::zeros(), &turn));
                gravity += u32::from(last == Some(Err(Rejected::Gravity)));
                refused += u32::from(last.is_some_and(|verdict| verdict.is_err()));
                assert_eq!(rig.state(), None, "{angle} degrees");
            }
            assert!(!rig.estimator.health(rig.now).is_good());
            // At rest one pose decides. In motion the candidate does, and may do so by a position before it does by its
            // bias.
            assert!(refused > 0 && (gravity > 0 || path(0.0).velocity != Vector3::zeros()), "{angle} degrees");
        }
    }
    let mut rig = Rig::new(rest);
    rig.biases.1 = Vector3::new(0.0, 0.0, -9.81);
    rig.fly(5_000_000, 20_000);
    assert_eq!(rig.state(), None);
}

#[test]
fn a_candidate_in_motion_finds_up_by_its_accelerometers_bias() {
    for angle in [7.0_f64, 8.5, 10.0, 12.0] {
        let mut rig = Rig::new(spin);
        let turn = UnitQuaternion::from_scaled_axis(Vector3::x() * angle.to_radians());
        let mut gravity = 0;
        for _ in 0..300 {
            let last =
                rig.fly_with(10_000, 20_000, |rig, time| motion::pose(&rig.truth(time), &Vector3::zeros(), &turn));
            gravity += u32::from(last == Some(Err(Rejected::Gravity)));
            assert_eq!(rig.state(), None, "{angle} degrees");
        }
        assert!(gravity > 0, "{angle} degrees");
    }
}

#[test]
fn biases_are_found_and_implausible_ones_are_faults() {
    let mut rig = Rig::new(tumble);
    rig.biases = (Vector3::new(0.004, -0.006, 0.005), Vector3::new(0.2, -0.15, 0.1));
    rig.fly(20_000_000, 20_000);
    rig.check("with biases");
    let nominal = rig.estimator.filter().unwrap().nominal;
    assert!((nominal.gyro_bias.cast::<f64>() - rig.biases.0).norm() < 5e-4, "{nominal:?}");
    assert!((nominal.accelerometer_bias.cast::<f64>() - rig.biases.1).norm() < 2e-2, "{nominal:?}");
    assert!(rig.estimator.health(rig.now).is_good());
    // On a gyro that was calibrated, a drift of three deviations on each axis may be, 1.7 degrees a second may not.
    for (bias, fault) in [(Vector3::repeat(0.0135), None), (Vector3::new(0.0, 0.0, 0.03), Some(Fault::GyroBias))] {
        let mut rig = Rig::new(rest);
        rig.biases.0 = bias;
        rig.fly(10_000_000, 20_000);
        assert_eq!(rig.estimator.health(rig.now).faults.worst(), fault, "{bias}");
    }
}

#[test]
fn a_gap_of_the_imu_ends_it_and_numbers_that_cannot_be_too() {
    let mut rig = Rig::new(rest);
    rig.fly(2_000_000, 20_000);
    assert!(rig.estimator.health(rig.now).is_good());
    assert!(rig.state_at(rig.now + 22_000).is_some());
    assert_eq!(rig.state_at(rig.now + 22_001), None);
    assert_eq!(rig.estimator.state(rig.now, &Vector3::new(0.0, f32::NAN, 0.0), None), None);
    assert_eq!(rig.estimator.health(rig.now + 22_001).faults.worst(), Some(Fault::ImuStale));
    rig.now += 1;
    rig.step();
    assert_eq!(rig.estimator.health(rig.now).faults.worst(), Some(Fault::NotStarted));
    rig.fly(1_000_000, 20_000);
    assert!(rig.estimator.health(rig.now).is_good());
    let mut broken = motion::increment(rest, rig.now, rig.now + 5_000, &rig.biases);
    broken.delta_velocity.y = f32::NAN;
    rig.estimator.imu(&broken);
    assert_eq!(rig.state(), None);
}

#[test]
fn without_poses_it_coasts_and_reports_it() {
    let mut rig = Rig::new(tumble);
    rig.fly(5_000_000, 20_000);
    let began = rig.now;
    for _ in 0..400 {
        rig.step();
    }
    let (p, v, q) = rig.errors();
    assert!(p < 0.05 && v < 0.05 && q < 0.01, "{p} m, {v} m/s, {q} rad");
    let health = rig.estimator.health(rig.now);
    assert!(health.faults.contain(Fault::NoPose));
    assert_eq!(health.pose_age, Some(rig.now - began + 20_000));
    assert!(!rig.estimator.health(began + COASTING_AFTER_US - 20_000).faults.contain(Fault::NoPose));
    rig.fly(500_000, 20_000);
    rig.check("found again");
    assert!(rig.estimator.health(rig.now).is_good());
}

#[test]
fn poses_before_the_imu_and_after_it_are_refused() {
    let mut rig = Rig::new(rest);
    let pose = |rig: &Rig| motion::pose(&rig.truth(0), &Vector3::zeros(), &UnitQuaternion::identity());
    let early = Stamped { value: pose(&rig), time: 0 };
    assert_eq!(rig.estimator.pose(&early, 0), Err(Rejected::NoImu));
    rig.now = 1_000_000;
    (0..10).for_each(|_| rig.step());
    let old = Stamped { value: pose(&rig), time: 999_999 };
    assert_eq!(rig.estimator.pose(&old, rig.now), Err(Rejected::TooOld));
    let ahead = Stamped { value: pose(&rig), time: rig.now + 22_001 };
    assert_eq!(rig.estimator.pose(&ahead, rig.now + 30_000), Err(Rejected::NoImu));
}

#[test]
fn few_poses_prove_nothing_however_long_they_take() {
    let mut rig = Rig::new(rest);
    for count in 1..=POSES_MIN {
        assert_eq!(rig.state(), None, "{count} poses");
        (0..40).for_each(|_| rig.step());
        let pose = motion::pose(&rig.truth(rig.now), &Vector3::zeros(), &UnitQuaternion::identity());
        rig.estimator.pose(&Stamped { value: pose, time: rig.now }, rig.now).unwrap();
    }
    assert!(rig.state().is_some());
}
