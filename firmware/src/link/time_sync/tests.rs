use super::*;

/// A sender whose clock is `ahead` us ahead answers a question of `asked`; its way back takes `back` us.
fn exchange(sync: &mut TimeSync, asked: u64, ahead: u64, there: u64, back: u64) {
    let message = TIMESYNC_DATA { tc1: nanoseconds(asked + there + ahead), ts1: question(asked).ts1 };
    sync.take(&message, asked + there + back);
}

#[test]
fn a_symmetric_line_leaves_no_error_and_another_no_more_than_it_says() {
    for (there, back) in [(1_000, 1_000), (9_000, 1_000), (100, 19_900), (0, 0)] {
        for ahead in [0, 7, 1_800_000_000_000_000] {
            let mut sync = TimeSync::default();
            exchange(&mut sync, 5_000_000, ahead, there, back);
            let Offset { value, error } = sync.offset(5_000_000).unwrap();
            let found = value + i128::from(ahead);
            assert_eq!(found, (i128::from(back) - i128::from(there)) / 2);
            assert!(found.unsigned_abs() <= error.into() && error == (there + back).div_ceil(2));
        }
    }
}

#[test]
fn the_quickest_answer_counts_until_its_clock_has_parted() {
    let mut sync = TimeSync::default();
    exchange(&mut sync, 0, 50, 500, 500);
    exchange(&mut sync, 1_000_000, 9_000, 4_000, 4_000);
    assert_eq!(sync.offset(1_000_000).unwrap().value, -50);
    // 200 ppm: after 20 s the first is as doubtful as the second.
    exchange(&mut sync, 20_000_000, 9_000, 4_000, 4_000);
    assert_eq!(sync.offset(20_008_000), Some(Offset { value: -9_000, error: 4_000 }));
}

#[test]
fn a_clock_that_was_set_is_known_by_its_second_answer() {
    let mut sync = TimeSync::default();
    exchange(&mut sync, 0, 700_000, 500, 500);
    exchange(&mut sync, 1_000_000, 900_000, 4_000, 4_000);
    assert_eq!(sync.offset(1_000_000).unwrap().value, -700_000);
    // A single one may be of another clock.
    exchange(&mut sync, 2_000_000, 700_000, 4_000, 4_000);
    exchange(&mut sync, 3_000_000, 900_000, 4_000, 4_000);
    assert_eq!(sync.offset(3_000_000).unwrap().value, -700_000);
    assert!(sync.recent(5_008_000).is_some() && sync.recent(5_008_001).is_none());
    exchange(&mut sync, 4_000_000, 900_000, 4_000, 4_000);
    assert_eq!(sync.recent(4_008_000), Some(Offset { value: -900_000, error: 4_000 }));
}

#[test]
fn the_presumed_delay_gives_way_to_any_answer() {
    let mut sync = TimeSync::presumed(-3, 0);
    assert_eq!((sync.offset(0).unwrap().value, sync.recent(0)), (-3, None));
    exchange(&mut sync, 1_000_000, 9_000, 10_000, 90_000);
    assert!(sync.recent(1_100_000).unwrap().value > 0);
}

#[test]
fn an_answer_to_no_question_or_an_old_one_is_ignored() {
    let mut sync = TimeSync::default();
    for (ts1, arrived) in
        [(2_000_001_000, 2_000_000), (-1_000, 5), (i64::MIN, 5), (i64::MAX, u64::MAX), (0, ANSWER_DELAY_MAX_US + 1)]
    {
        sync.take(&TIMESYNC_DATA { tc1: i64::MIN, ts1 }, arrived);
        assert_eq!(sync.offset(arrived), None, "{ts1} {arrived}");
    }
    // Numbers at their limits are numbers.
    sync.take(&TIMESYNC_DATA { tc1: i64::MIN, ts1: 0 }, 0);
    assert!(sync.offset(u64::MAX).is_some());
}
