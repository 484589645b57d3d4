//! The mean acceleration between two ticks.

use super::motion::{Rig, increment, pose, tumble};
use nalgebra::{UnitQuaternion, Vector3};

/// Ticks 10 ms apart and 2 ms after an increment each, the first of them under way, while poses jump to and fro by a
/// centimetre.
#[test]
fn what_is_felt_between_ticks_is_the_motions_whatever_poses_say() {
    let mut rig = Rig::new(tumble);
    rig.fly(1_000_000, 20_000);
    let (mut worst, mut velocities, mut side) = (0.0_f64, 0.0_f32, 0.01);
    let mut before = None;
    for _ in 0..200 {
        rig.fly_with(10_000, 20_000, |rig, time| {
            side = -side;
            pose(&rig.truth(time), &Vector3::repeat(side), &UnitQuaternion::identity())
        });
        let now = rig.now + 2_000;
        let under_way = increment(tumble, rig.now, rig.now + 1_000, &rig.biases);
        let felt = rig.estimator.mean_acceleration(now, Some(&under_way));
        let state = rig.state_at(now).unwrap().state;
        if let (Some((last, velocity)), Some(felt)) = (before.replace((now, state.velocity)), felt) {
            let truly = (rig.truth(now).velocity - rig.truth(last).velocity) / 0.01;
            worst = worst.max((felt.cast() - truly).norm());
            let differs = (state.velocity - velocity) / 0.01 - truly.cast();
            velocities = velocities.max(differs.norm());
        }
    }
    assert!(worst < 0.15 && velocities > 1.0, "{worst} m/s^2; by differences of velocity {velocities}");
}

#[test]
fn nothing_is_felt_at_the_first_tick_and_after_a_gap() {
    let mut rig = Rig::new(tumble);
    rig.fly(1_000_000, 20_000);
    assert_eq!(rig.estimator.mean_acceleration(rig.now, None), None);
    rig.fly(10_000, 20_000);
    assert!(rig.estimator.mean_acceleration(rig.now, None).is_some());
    // Beyond what is extrapolated there is no state, either.
    assert_eq!(rig.estimator.mean_acceleration(rig.now + 30_000, None), None);
    rig.fly(10_000, 20_000);
    assert_eq!(rig.estimator.mean_acceleration(rig.now, None), None);
}
