extern crate std;
use super::*;
use crate::flight::PERIOD;
use std::vec::Vec;

/// The ticks at which it is told, of a scale over the ticks.
fn told(scale: impl Fn(u64) -> Option<f32>, ticks: u64) -> Vec<u64> {
    let mut check = ThrustCheck::default();
    (0..ticks).filter(|&tick| check.is_doubtful(scale(tick), tick * PERIOD)).collect()
}

#[test]
fn a_scale_that_stays_doubtful_is_told_now_and_then() {
    for scale in [0.84, 1.16, f32::NAN] {
        assert_eq!(told(|_| Some(scale), 2_400), [300, 1_300, 2_300]);
    }
}

#[test]
fn what_is_right_or_passes_or_is_not_flown_is_not_told() {
    assert!(told(|_| Some(0.86), 2_000).is_empty());
    assert!(told(|tick| Some(if tick % 290 == 0 { 1.0 } else { 0.7 }), 2_000).is_empty());
    assert!(told(|_| None, 2_000).is_empty());
}
