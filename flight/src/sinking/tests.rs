use super::*;
use controller_core::state::State;
use nalgebra::{Quaternion, Vector3};

/// The estimate says one speed, and its accelerometer has added another.
fn gained(gained: f32, speed: f32) -> EstimatedState {
    let (zero, attitude) = (Vector3::zeros(), Quaternion::new(1.0, 0.0, 0.0, 0.0));
    let velocity = Vector3::new(0.0, 0.0, speed);
    let state = State { position: zero, velocity, attitude, angular_velocity: zero };
    EstimatedState { state, acceleration: zero, jumps: 0, gained }
}

#[test]
fn what_the_accelerometer_adds_is_summed_up_and_what_poses_say_is_not() {
    let mut sinking = Sinking::at(0.5, false);
    assert_eq!(sinking.advance(&gained(2.0, 0.0), 0.01), 0.5);
    assert_eq!(sinking.advance(&gained(1.75, 7.0), 0.01), 0.25);
    assert_eq!(sinking.advance(&gained(1.75, -9.0), 0.01), 0.25);
    sinking.stop();
    assert_eq!(sinking.advance(&gained(1.5, -9.0), 0.01), -0.25);
}

#[test]
fn what_stays_behind_its_descent_is_summed_up_to_an_end_either_way() {
    let mut sinking = Sinking::at(-0.2, false);
    let mut behind = |wanted: f32, ticks: u32| (0..ticks).fold(0.0, |_, _| sinking.behind(wanted, 0.01));
    assert!((behind(-0.7, 20) - 0.1).abs() < 1e-6);
    assert_eq!(behind(-0.7, 1_000), BEHIND_MAX_M);
    assert!((behind(0.3, 20) - (BEHIND_MAX_M - 0.1)).abs() < 1e-6);
    assert_eq!(behind(0.3, 1_000), -BEHIND_MAX_M);
}

#[test]
fn up_or_down_it_moves_beyond_a_drift_that_grows() {
    for (speed, moves) in [(0.31, true), (-0.31, true), (0.29, false), (-0.29, false)] {
        assert_eq!(Sinking::at(speed, false).is_motion(), moves, "{speed} m/s");
    }
    let mut sinking = Sinking::at(-0.35, false);
    (0..1_000).for_each(|_| _ = sinking.advance(&gained(0.0, 0.0), 0.01));
    assert!(!sinking.is_motion() && (sinking.descent() - 1.1).abs() < 1e-3, "{}", sinking.descent());
}

#[test]
fn after_lies_it_goes_down_faster_and_faster() {
    let mut sinking = Sinking::at(0.0, true);
    (0..1_000).for_each(|_| _ = sinking.advance(&gained(0.0, 0.0), 0.01));
    assert!((sinking.descent() - 2.6).abs() < 1e-3, "{}", sinking.descent());
}

#[test]
fn a_descent_shows_as_motion_from_the_beginning_on_and_after_lies_from_two_seconds_on() {
    assert!(Sinking::at(0.0, false).shows());
    for (ticks, shows) in [(0, false), (199, false), (202, true), (3_000, true)] {
        let mut sinking = Sinking::at(0.0, true);
        (0..ticks).for_each(|_| _ = sinking.advance(&gained(0.0, 0.0), 0.01));
        assert_eq!(sinking.shows(), shows, "{ticks}");
    }
}
