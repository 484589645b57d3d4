use super::*;

#[test]
fn a_tick_in_time_is_followed_a_period_later() {
    for period in [20_000, 10_000, 1_000] {
        let mut timing = Timing { period, ..Timing::default() };
        assert!(timing.record(20_000, 20_030, 20_400));
        assert_eq!(timing, Timing { period, worst_duration: 370, worst_jitter: 30, missed: 0, gaps: 0 });
        assert_eq!(next_due(20_000, 20_400, period), 20_000 + period);
    }
}

#[test]
fn an_overrun_is_missed_and_not_caught_up_with() {
    let mut timing = Timing { period: 10_000, ..Timing::default() };
    assert!(!timing.record(20_000, 20_000, 30_000));
    assert_eq!(timing.missed, 1);
    assert_eq!(next_due(20_000, 30_000, 10_000), 40_000);
    assert_eq!(next_due(20_000, 45_000, 10_000), 50_000);
    assert_eq!(next_due(20_000, 22_500, 1_000), 23_000);
}
