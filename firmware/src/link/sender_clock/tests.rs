use super::*;

/// 100 messages a second from a clock that is ahead by `offset`, us, with delays; the stamps' errors against the least
/// delay.
fn errors(offset: u64, drift: f64, delay: impl Fn(u64) -> u64) -> Vec<i64> {
    let mut clock: Option<SenderClock> = None;
    let mut errors = Vec::new();
    for k in 0..6_000_u64 {
        let truth = 1_000_000 + 10_000 * k;
        let (time, arrived) = (offset + truth + (drift * (10_000 * k) as f64) as u64, truth + delay(k));
        let stamp = match &mut clock {
            Some(clock) => clock.stamp(time, arrived),
            None => {
                clock = Some(SenderClock::new(time, arrived));
                Some(arrived)
            }
        };
        let stamp = stamp.unwrap();
        assert!(stamp <= arrived);
        errors.push(stamp as i64 - truth as i64);
    }
    errors
}

#[test]
fn a_line_whose_delay_varies_leaves_stamps_that_do_not() {
    for offset in [0, 5, 1_800_000_000_000_000, u64::MAX / 2] {
        // 2 ms to 21 ms, scattered; from the hundredth message on the least has been seen.
        let errors = errors(offset, 0.0, |k| 2_000 + k * 7_919 % 20 * 1_000);
        assert!(errors[100..].iter().all(|error| (2_000..=2_100).contains(error)), "{:?}", &errors[100..120]);
    }
}

#[test]
fn clocks_that_part_are_followed() {
    for drift in [1e-4, -1e-4] {
        let errors = errors(1_000, drift, |k| 2_000 + k * 7_919 % 20 * 1_000);
        assert!(
            errors[100..].iter().all(|error| (1_900..=2_200).contains(error)),
            "{drift}: {:?}",
            &errors[5_900..5_920]
        );
    }
}

#[test]
fn a_time_that_does_not_advance_is_refused_however_long() {
    let mut clock = SenderClock::new(5_000_000, 0);
    for k in 1..1_000_000 {
        // The same frame, for hours; or two of them in turn.
        assert_eq!(clock.stamp(5_000_000 - 10_000 * (k % 2), 10_000 * k), None);
    }
    // Nor does it do to count a little.
    assert!((1..4).all(|k| clock.stamp(5_000_000 + k, 10_000_000_000 + 10_000 * k).is_none()));
}

#[test]
fn a_clock_that_is_set_costs_four_frames_back_or_forward() {
    let mut clock = SenderClock::new(5_000_000, 0);
    let stamps: Vec<_> = (1..8).map(|k| clock.stamp(3_000 + 10_000 * k, 10_000 * k)).collect();
    assert_eq!(stamps, [None, None, None, None, Some(50_000), Some(60_000), Some(70_000)]);
    let stamps: Vec<_> = (8..14).map(|k| clock.stamp(9_000_000 + 10_000 * k, 10_000 * k)).collect();
    assert_eq!(stamps, [None, None, None, None, Some(120_000), Some(130_000)]);
}

#[test]
fn forging_every_fourth_message_stops_no_other_sender() {
    for forged in [50_000_i64, 150_000, 2_000_000, -600_000, -3_000_000] {
        let mut clock = SenderClock::new(5_000_000, 0);
        let mut refused = 0;
        for k in 1..10_000_u64 {
            let (time, arrived) = (5_000_000 + 10_000 * k, 10_000 * k + 2_000);
            if k.is_multiple_of(4) {
                clock.stamp(time.saturating_add_signed(forged), arrived - 1_000);
            }
            match clock.stamp(time, arrived) {
                // Nor is what it says taken for older than the line may be quicker.
                Some(stamp) => assert!(stamp <= arrived && arrived - stamp <= LEAD_MAX_US + 2_000, "{forged} {k}"),
                None => refused += 1,
            }
        }
        assert!(refused < 10, "{forged}: {refused}");
    }
}

#[test]
fn a_line_whose_first_message_was_slow_is_believed_again_however_its_delay_varies() {
    let mut clock = SenderClock::new(5_000_000, 400_000);
    // 0 to 60 ms late, in order.
    let late = |k: u64| (k % 20).abs_diff(10) * 6_000;
    let taken = (40..140_u64).filter(|&k| clock.stamp(5_000_000 + 10_000 * k, 10_000 * k + late(k)).is_some());
    assert!(taken.count() >= 90);
}

#[test]
fn a_clock_that_does_not_keep_time_is_not_believed() {
    let mut clock = SenderClock::new(5_000_000, 0);
    // Ten times too fast.
    assert!((1..40).all(|k| clock.stamp(100_000 * k, 10_000 * k).is_none()));
}

#[test]
fn messages_that_a_line_held_back_are_not_taken_as_fresh() {
    let mut clock = SenderClock::new(0, 0);
    assert_eq!(clock.stamp(10_000, 10_000), Some(10_000));
    // A second of frames in a moment: the last half of it may still be flown.
    for k in 2..100 {
        let stamp = clock.stamp(10_000 * k, 1_000_000);
        let late = 1_000_000 - 10_000 * k;
        assert_eq!(stamp.is_some(), late <= LATE_MAX_US, "{k}");
        assert!(stamp.is_none_or(|stamp| stamp.abs_diff(10_000 * k) <= 250));
    }
}

#[test]
fn a_clock_that_stood_still_is_believed_again() {
    let mut clock = SenderClock::new(0, 0);
    let taken: Vec<_> = (1..8).map(|k| clock.stamp(10_000 * k, 3_600_000_000 + 10_000 * k)).collect();
    assert_eq!(taken[4], Some(3_600_050_000));
    assert!(taken[..4].iter().all(Option::is_none) && taken[5..].iter().all(Option::is_some), "{taken:?}");
}

#[test]
fn what_one_early_message_brought_down_comes_back_to_the_least_that_it_can_be() {
    let mut clock = SenderClock::new(1_000_000, 0);
    for k in 1..1_000_u64 {
        // Each tenth comes 60 ms early: the vehicle's clock stalled.
        let (time, arrived) = (1_000_000 + 100_000 * k, 100_000 * k - if k % 10 == 0 { 60_000 } else { 0 });
        clock.restore(-1_000_500, time, arrived);
        let stamp = clock.stamp(time, arrived).unwrap();
        assert!(stamp <= arrived && arrived - stamp <= 500, "{k}: {stamp} {arrived}");
    }
    // A message that does not keep to the bound is of another clock: nothing is brought back for it.
    let mut clock = SenderClock::new(1_000_000, 0);
    clock.restore(-500_000, 1_010_000, 10_000);
    assert_eq!(clock.offset(), -1_000_000);
}
