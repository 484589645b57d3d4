extern crate std;
use super::*;
use crate::estimator::Clipped;
use crate::estimator::history::slow_force;
use core::f32::consts::TAU;
use nalgebra::{Rotation3, UnitQuaternion};

const H: u64 = 5_000;

fn increment(start: u64, delta_velocity: Vector3<f32>, delta_angle: Vector3<f32>) -> Increment {
    let end = start + H;
    let clipped = Clipped::NEITHER;
    Increment { start, end, delta_angle, delta_velocity, clipped }
}

/// The greatest velocity that is left, and f, of a body that is shaken across with this frequency, Hz, over those of
/// the motion itself.
fn shaken(frequency: f32) -> (f32, f32) {
    let speed = |time: u64| (TAU * frequency * time as f32 * 1e-6).sin();
    let along = |start: u64| increment(start, Vector3::x() * (speed(start + H) - speed(start)), Vector3::zeros());
    let (mut left, mut force) = (0.0_f32, 0.0_f32);
    for start in (0..1_000_000).step_by(1_000) {
        let (before, last) = (along(start), along(start + H));
        let present = PresentMotion::from_increments(&last, Some(&before), &Vector3::zeros());
        left = left.max((speed(last.end) - present.vibration.x).abs());
        force = force.max(present.force.x.abs() / (TAU * frequency));
    }
    (left, force)
}

#[test]
fn a_vibrating_body_is_attenuated_as_the_table_states() {
    for (frequency, left, force) in
        [(10.0, 0.976, 0.984), (70.0, 0.206, 0.368), (100.0, 0.0, 0.0), (130.0, 0.206, 0.198)]
    {
        let found = shaken(frequency);
        assert!((found.0 - left).abs() < 2e-3 && (found.1 - force).abs() < 2e-3, "{frequency} Hz: {found:?}");
    }
}

#[test]
fn the_slow_force_keeps_less_than_a_twentieth_of_a_vibration() {
    for frequency in [70.0, 100.0, 130.0] {
        let speed = |time: u64| (TAU * frequency * time as f32 * 1e-6 + 0.5).sin();
        let (mut slow, mut max) = (None, 0.0_f32);
        for start in (0..2_000_000).step_by(H as usize) {
            let push = Vector3::x() * (speed(start + H) - speed(start));
            slow = Some(slow_force(slow.as_ref(), &increment(start, push, Vector3::zeros())));
            max = if start > 1_000_000 { max.max(slow.unwrap().x.abs()) } else { 0.0 };
        }
        assert!(max < TAU * frequency / 20.0, "{frequency} Hz: {max}");
    }
}

#[test]
fn a_steady_acceleration_passes_the_low_pass_in_full() {
    let (push, still) = (Vector3::new(1.0, -2.0, 9.81) * 5e-3, Vector3::zeros());
    let (before, last) = (increment(0, push, still), increment(H, push, still));
    let slow = slow_force(Some(&slow_force(None, &before)), &last);
    assert!((slow - push / 5e-3).norm() < 1e-5);
    for present in [
        PresentMotion::from_increments(&last, Some(&before), &slow),
        PresentMotion::from_increments(&last, None, &slow),
    ] {
        assert!((present.force - push / 5e-3).norm() < 1e-5 && present.vibration.norm() < 1e-7, "{present:?}");
    }
}

#[test]
fn a_force_that_begins_is_known_to_nine_tenths_after_an_eighth_of_a_second() {
    let push = Vector3::z() * 5e-3;
    let begins = slow_force(None, &increment(0, Vector3::zeros(), Vector3::zeros()));
    let known = (0..24).fold(begins, |slow, _| slow_force(Some(&slow), &increment(0, push, Vector3::zeros())));
    assert!((0.9..0.93).contains(&known.z), "{known}");
}

#[test]
fn a_force_of_the_world_stays_one_while_the_body_turns() {
    // 15 rad/s, begun in any attitude; the force is the world's.
    let (turn, world) = (Vector3::new(0.045, -0.03, 0.052), Vector3::new(3.0, 1.0, 12.0));
    let (whole, half) = (UnitQuaternion::new(turn), UnitQuaternion::new(turn * 0.5));
    let mut attitude = UnitQuaternion::from(Rotation3::from_euler_angles(1.0, -0.4, 2.0));
    let (mut slow, mut before) = (None, None);
    for n in 0..100 {
        // d in the frame at the start, the force as it is half-way.
        let push = half * ((attitude * half).inverse() * world) * 5e-3;
        let last = increment(n * H, push, turn);
        slow = Some(slow_force(slow.as_ref(), &last));
        attitude *= whole;
        let (wanted, found) = (
            attitude.inverse() * world,
            PresentMotion::from_increments(&last, before.as_ref(), slow.as_ref().unwrap()),
        );
        assert!((found.force - wanted).norm() < 0.01 * wanted.norm(), "{} {wanted}", found.force);
        assert!(found.vibration.norm() < 0.1 * wanted.norm() * 5e-3, "{}", found.vibration);
        before = Some(last);
    }
}
