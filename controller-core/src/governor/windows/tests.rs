use super::super::tests::TYPICAL;
use super::*;

#[test]
fn the_windows_satisfy_both_bounds_with_less_than_two_ticks_to_spare() {
    let windows = Windows::design(&TYPICAL, &GovernorLimits::default(), 0.01).unwrap();
    let diameter = 2.0 * (TYPICAL.horizontal_acceleration.powi(2) + TYPICAL.vertical_acceleration.powi(2)).sqrt();
    let [first, second, _] = windows.lengths.map(|length| length as f32 * 0.01);
    assert!(diameter / first <= TYPICAL.jerk && diameter / (first - 0.02) > TYPICAL.jerk);
    assert!(2.0 * diameter / (first * second) <= TYPICAL.snap);
    assert!(2.0 * diameter / (first * (second - 0.02)) > TYPICAL.snap);
}

#[test]
fn windows_too_long_for_the_memory_cost_authority_instead() {
    let windows = Windows::design(&TYPICAL, &GovernorLimits::default(), 0.002).unwrap();
    assert!(windows.lengths.iter().sum::<usize>() < HISTORY_TICKS);
    let authority = windows.horizontal / windows.per_metre / 0.002 / 0.002;
    assert!(authority < 0.9 * TYPICAL.horizontal_acceleration && authority > 0.1);
}
