//! Shocks beyond the sensors' ranges: what they left out is soon known again, from poses that are believed all the
//! while.

use super::motion::{self, Path, Rig, increment, rest, tumble};
use crate::estimator::{Accepted, Clipped, Increment, Rejected};
use crate::measurement::Stamped;
use nalgebra::{UnitQuaternion, Vector3};

/// How many of the poses of the second after a shock are refused, whose increment lacks these, m/s and rad; late by 20
/// ms.
fn refused_after(path: Path, clipped: Clipped, push: &Vector3<f32>, turn: &Vector3<f32>) -> usize {
    let mut rig = Rig::new(path);
    rig.fly(3_000_000, 20_000);
    let end = rig.now + 5_000;
    let truth = increment(path, rig.now, end, &rig.biases);
    let (delta_velocity, delta_angle) = (truth.delta_velocity - push, truth.delta_angle - turn);
    rig.estimator.imu(&Increment { delta_velocity, delta_angle, clipped, ..truth });
    rig.now = end;
    let mut refused = 0;
    for _ in 0..100 {
        (0..2).for_each(|_| rig.step());
        let time = rig.now - 20_000;
        let pose = motion::pose(&rig.truth(time), &Vector3::zeros(), &UnitQuaternion::identity());
        let taken: Result<Accepted, Rejected> = rig.estimator.pose(&Stamped { value: pose, time }, rig.now);
        refused += usize::from(taken != Ok(Accepted::Fused));
    }
    let (p, v, q) = rig.errors();
    assert!(refused > 0 || p < 3e-3 && v < 0.01 && q < 3e-3, "{p} m, {v} m/s, {q} rad");
    refused
}

#[test]
fn a_velocity_that_a_shock_left_out_is_known_again_and_costs_no_pose() {
    let (clipped, zero) = (Clipped { accelerometer: true, ..Clipped::NEITHER }, Vector3::zeros());
    for path in [rest as Path, tumble] {
        for missed in [Vector3::new(0.0, 0.0, 0.3), Vector3::new(-0.2, 0.3, 1.0), Vector3::new(1.0, 2.0, 3.0)] {
            assert_eq!(refused_after(path, clipped, &missed, &zero), 0, "{missed}");
            assert!(refused_after(path, Clipped::NEITHER, &missed, &zero) > 5, "{missed}");
        }
    }
}

#[test]
fn a_turn_that_a_whirl_left_out_is_known_again_and_costs_no_pose() {
    let (clipped, zero) = (Clipped { gyro: true, ..Clipped::NEITHER }, Vector3::zeros());
    for path in [rest as Path, tumble] {
        for missed in [Vector3::new(0.17, 0.0, 0.0), Vector3::new(-0.1, 0.2, 0.3)] {
            assert_eq!(refused_after(path, clipped, &zero, &missed), 0, "{missed}");
            assert!(refused_after(path, Clipped::NEITHER, &zero, &missed) > 5, "{missed}");
        }
    }
}

#[test]
fn in_whichever_attitude_a_shock_finds_it_the_estimate_keeps_its_numbers() {
    let sets: [[f32; 3]; 5] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0; 3]];
    for (phase, missed) in (0..40).flat_map(|phase| sets.map(|missed| (phase, Vector3::from(missed)))) {
        let mut rig = Rig::new(tumble);
        // Poses that say they are good to a tenth of a millimetre leave the least variances beside the greatest doubt.
        let sure = |rig: &Rig, time| {
            motion::pose(&rig.truth(time), &Vector3::zeros(), &UnitQuaternion::identity()).deviations(1e-4, 1e-3)
        };
        rig.fly_with(2_000_000 + phase * 25_000, 20_000, sure);
        let (end, clipped) = (rig.now + 5_000, Clipped { gyro: true, accelerometer: true });
        let truth = increment(tumble, rig.now, end, &rig.biases);
        rig.estimator.imu(&Increment { delta_velocity: truth.delta_velocity - missed * 4.0, clipped, ..truth });
        rig.now = end;
        for _ in 0..30 {
            let verdict = rig.fly_with(10_000, 20_000, sure);
            assert_ne!(verdict, Some(Err(Rejected::NotFinite)), "{phase} {missed}");
            assert!(rig.estimator.filter().unwrap().covariance.is_positive());
        }
    }
}
