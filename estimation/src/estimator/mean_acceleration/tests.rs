//! What is felt between ticks: all of it, once, whatever poses say.

use super::*;

#[test]
fn between_ticks_everything_is_felt_once_whatever_was_ahead_at_the_first() {
    let mut felt = MeanAcceleration::NOTHING;
    felt.add(&Vector3::x());
    assert_eq!(felt.mean(10_000, &Vector3::new(0.0, 0.02, 0.0)), None);
    // 0.02 of the first increment's 0.05 was ahead then; of the third, 0.01 is now.
    for change in [0.05, 0.05] {
        felt.add(&Vector3::new(0.0, change, 0.0));
    }
    let mean = felt.mean(20_000, &Vector3::new(0.0, 0.01, 0.0)).unwrap();
    assert!((mean - Vector3::new(0.0, 9.0, 0.0)).norm() < 1e-5, "{mean}");
    let nothing = felt.mean(30_000, &Vector3::new(0.0, 0.01, 0.0)).unwrap();
    assert!(nothing.norm() < 1e-6, "{nothing}");
}

#[test]
fn without_time_between_there_is_no_mean() {
    let mut felt = MeanAcceleration::NOTHING;
    for now in [10_000, 10_000, 9_000] {
        assert_eq!(felt.mean(now, &Vector3::zeros()), None);
    }
}
