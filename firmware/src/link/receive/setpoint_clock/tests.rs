use super::*;

#[test]
fn setpoints_that_come_unevenly_are_as_far_apart_as_their_sender_says() {
    let mut clock = SetpointClock::default();
    let delays = [9, 3, 12, 3, 5, 14, 4, 8];
    let stamps: Vec<u64> = (0..8)
        .zip(delays)
        .map(|(number, delay)| clock.stamp(700 + 20 * number, 5_000_000 + 20_000 * u64::from(number) + 1_000 * delay))
        .collect();
    // The second was the quickest.
    for pair in stamps[1..].windows(2) {
        assert!((pair[1] - pair[0]).abs_diff(20_000) <= 20, "{stamps:?}");
    }
}

#[test]
fn a_sender_without_times_counts_from_when_its_setpoints_come() {
    let mut clock = SetpointClock::default();
    for arrived in [1_000, 21_000, 45_000] {
        assert_eq!(clock.stamp(0, arrived), arrived);
        assert_eq!(SetpointClock::default().stamp(77, arrived), arrived);
    }
}

#[test]
fn a_clock_that_was_set_or_began_anew_is_learnt_anew() {
    let mut clock = SetpointClock::default();
    clock.stamp(50_000, 1_000_000);
    assert_eq!(clock.stamp(50_020, 1_023_000), 1_020_004);
    // Begun anew, then stood still for a second.
    assert_eq!(clock.stamp(20, 1_040_000), 1_040_000);
    assert_eq!(clock.stamp(40, 2_060_000), 2_060_000);
    assert_eq!(clock.stamp(60, 2_080_000), 2_080_000);
    // A time far ahead is believed, and never leads a setpoint to the future.
    assert_eq!(clock.stamp(4_000_000_000, 2_100_000), 2_100_000);
}
