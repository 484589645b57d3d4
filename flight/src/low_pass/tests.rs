extern crate std;
use super::*;
use crate::PERIOD_US;
use nalgebra::Quaternion;
use std::vec::Vec;

/// A state whose every motion is so great.
fn moving(motion: f32, jumps: u32) -> EstimatedState {
    let all = Vector3::repeat(motion);
    let attitude = Quaternion::new(1.0, 0.0, 0.0, 0.0);
    let state = State { position: Vector3::zeros(), velocity: all, attitude, angular_velocity: all };
    EstimatedState { state, acceleration: all, jumps, gained: 0.0 }
}

/// What is left of it: of velocity and rate, and of acceleration.
fn left(smoothed: &mut LowPass, motion: f32, jumps: u32) -> (f32, f32) {
    let EstimatedState { state, acceleration, .. } = smoothed.tick(Some(&moving(motion, jumps))).unwrap();
    assert_eq!(state.velocity, state.angular_velocity);
    (state.velocity.x, acceleration.x)
}

#[test]
fn a_steady_motion_is_known_to_nine_tenths_after_a_tenth_of_a_second_and_an_acceleration_after_two() {
    let mut smoothed = LowPass::new(PERIOD_US);
    assert_eq!(left(&mut smoothed, 0.0, 0), (0.0, 0.0));
    let found: Vec<(f32, f32)> = (0..20).map(|_| left(&mut smoothed, 1.0, 0)).collect();
    assert!((0.88..0.9).contains(&found[9].0), "{found:?}");
    assert!((0.93..0.95).contains(&found[19].1), "{found:?}");
}

#[test]
fn at_any_rate_a_change_is_known_as_far_after_as_long() {
    for period in [1_000, 2_000, 4_000, 10_000, 20_000] {
        let mut smoothed = LowPass::new(period);
        left(&mut smoothed, 0.0, 0);
        let (found, _) = (0..100_000 / period).map(|_| left(&mut smoothed, 1.0, 0)).last().unwrap();
        assert!((0.86..0.93).contains(&found), "{period} us: {found}");
    }
}

#[test]
fn an_eighth_is_left_of_what_swings_at_25_hz_and_a_sixtieth_of_an_acceleration() {
    let mut smoothed = LowPass::new(PERIOD_US);
    let swings = [0.0, 1.0, 0.0, -1.0].into_iter().cycle().take(400);
    let later = swings.map(|motion| left(&mut smoothed, motion, 0)).skip(200);
    let most = later.fold((0.0_f32, 0.0_f32), |most, one| (most.0.max(one.0), most.1.max(one.1)));
    assert!((0.11..0.15).contains(&most.0) && (0.01..0.025).contains(&most.1), "{most:?}");
}

#[test]
fn without_a_state_and_at_a_jump_it_begins_anew() {
    let mut smoothed = LowPass::new(PERIOD_US);
    assert_eq!((left(&mut smoothed, 3.0, 0), left(&mut smoothed, 1.0, 1)), ((3.0, 3.0), (1.0, 1.0)));
    assert_eq!(smoothed.tick(None), None);
    assert_eq!(left(&mut smoothed, 2.0, 1), (2.0, 2.0));
}

#[test]
fn one_tick_of_a_hit_leaves_less_than_wind_may() {
    let mut smoothed = LowPass::new(PERIOD_US);
    assert_eq!(left(&mut smoothed, 0.0, 0), (0.0, 0.0));
    let most = [440.0].into_iter().chain([0.0; 50]).map(|motion| left(&mut smoothed, motion, 0).1).fold(0.0, f32::max);
    assert!((1.0..3.5).contains(&most), "{most} m/s^2");
}
