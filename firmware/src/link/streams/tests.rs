use super::*;

/// How often each message comes in `seconds` of a line that takes one every 2 ms.
fn counts(schedule: &mut Schedule, seconds: u64) -> Vec<(Kind, usize)> {
    let sent: Vec<Kind> = (0..seconds * 500).filter_map(|step| schedule.next_due(40_000, step * 2_000)).collect();
    STREAMS.iter().map(|(kind, _)| (*kind, sent.iter().filter(|other| *other == kind).count())).collect()
}

fn count(counts: &[(Kind, usize)], kind: Kind) -> usize {
    counts.iter().find(|(other, _)| *other == kind).unwrap().1
}

#[test]
fn each_message_comes_at_its_rate_and_those_on_request_do_not() {
    for (kind, count) in counts(&mut Schedule::new(0), 10) {
        let rate = STREAMS.iter().find(|(other, _)| *other == kind).unwrap().1;
        let expected = match rate {
            Rate::OnRequest | Rate::Bench(_) => 0,
            Rate::Every(interval) => 10_000_000 / interval as usize,
            Rate::Telemetry => 250,
        };
        assert!(count.abs_diff(expected) <= 1, "{kind:?}: {count}, {expected} expected");
    }
}

#[test]
fn rates_are_changed_stopped_and_put_back() {
    let mut schedule = Schedule::new(0);
    schedule.set_interval(Kind::Odometry, 20_000, 0);
    schedule.set_interval(Kind::Attitude, -1, 0);
    schedule.set_interval(Kind::GlobalOrigin, 1_000_000, 0);
    schedule.set_interval(Kind::Position, 1, 0);
    let changed = counts(&mut schedule, 2);
    assert!(count(&changed, Kind::Odometry).abs_diff(100) <= 1);
    assert_eq!((count(&changed, Kind::Attitude), count(&changed, Kind::GlobalOrigin)), (0, 2));
    // No faster than a hundred a second.
    assert!(count(&changed, Kind::Position).abs_diff(200) <= 1);
    assert_eq!(schedule.interval_of(Kind::Attitude, 40_000), None);
    schedule.set_interval(Kind::Attitude, 0, 0);
    assert_eq!(schedule.interval_of(Kind::Attitude, 40_000), Some(100_000));
}

#[test]
fn messages_of_the_bench_come_until_there_is_an_estimate_and_then_on_request() {
    let mut schedule = Schedule::new(0);
    schedule.set_bench(true);
    let bench = counts(&mut schedule, 10);
    assert_eq!(
        (count(&bench, Kind::Imu), count(&bench, Kind::Vibration), count(&bench, Kind::NamedValue)),
        (50, 10, 40)
    );
    schedule.set_bench(false);
    schedule.set_interval(Kind::Vibration, 500_000, 0);
    let flying = counts(&mut schedule, 10);
    assert_eq!((count(&flying, Kind::Imu), count(&flying, Kind::Vibration)), (0, 20));
    assert_eq!((count(&flying, Kind::NamedValue), schedule.interval_of(Kind::Imu, 40_000)), (0, None));
}

#[test]
fn every_message_is_known_by_its_number() {
    for (kind, _) in STREAMS {
        assert_eq!(Kind::from_number(kind.number()).unwrap().number(), kind.number());
    }
    assert_eq!(Kind::from_number(148), Some(Kind::AutopilotVersion));
    assert_eq!(Kind::from_number(9_999), None);
}

#[test]
fn the_default_rates_fit_a_slow_line() {
    let bytes = |signature: usize| -> u64 {
        let of_one = |(kind, rate): &(Kind, Rate)| {
            let interval = match rate {
                Rate::OnRequest | Rate::Bench(_) => return 0,
                Rate::Every(interval) => *interval,
                Rate::Telemetry => 40_000,
            };
            (kind.bytes_max() + signature) as u64 * 1_000_000 / interval
        };
        STREAMS.iter().map(of_one).sum()
    };
    assert!(bytes(0) < 4_600, "{} bytes a second", bytes(0));
    assert!(bytes(13) < 5_700, "{} bytes a second, signed", bytes(13));
}
