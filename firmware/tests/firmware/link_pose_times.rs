//! The instants that poses in are of: senders' clocks, what a line takes, TIMESYNC.

use crate::link_poses::{mocap, odometry};
use crate::support::receiver::{Fed, Local, newest, texts};
use crate::support::v2;
use firmware::link::sender_clock::TRIAL_FRAMES;
use firmware::parameters::table::Name;
use mavlink::dialects::common::TIMESYNC_DATA;

/// What becomes of ten messages, 10 ms apart, of a sender whose clock has been set to `start`, us, before the first.
fn set_back(message: impl Fn(u64) -> Vec<u8>, start: u64) -> Vec<Option<u64>> {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    for count in 0..100 {
        fed.bytes(&message(5_000_000 + 10_000 * count), 10_000 * count);
        assert_eq!(newest(&shared).map(|pose| pose.time), Some(10_000 * count));
    }
    let taken = (0..10).map(|count| {
        fed.bytes(&message(start + 10_000 * count), 1_000_000 + 10_000 * count);
        newest(&shared).map(|pose| pose.time)
    });
    taken.collect()
}

#[test]
fn a_clock_set_back_costs_no_more_than_40_ms_of_poses() {
    for start in [1, 1_000_000, 5_900_000] {
        for stamps in [set_back(|time| v2(1, &odometry(time)), start), set_back(|time| v2(1, &mocap(time, 0.0)), start)]
        {
            let lost = usize::from(TRIAL_FRAMES) - 1;
            assert!(stamps[..lost].iter().all(Option::is_none), "{stamps:?}");
            let back: Vec<_> = (lost as u64..10).map(|count| Some(1_000_000 + 10_000 * count)).collect();
            assert_eq!(stamps[lost..], back, "from {start}");
        }
    }
}

#[test]
fn extra_delay_of_the_line_shows_on_the_senders_clock() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    for count in 0..50 {
        let late = if count % 2 == 1 { 30_000 } else { 0 };
        fed.message(&odometry(7_000_000 + 20_000 * count), 20_000 * count + late);
        let error = newest(&shared).unwrap().time.abs_diff(20_000 * count);
        assert!(error <= 20, "{error} us");
    }
}

#[test]
fn a_sender_without_a_clock_is_believed() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    for now in [0, 10_000, 20_000] {
        fed.message(&odometry(0), now);
        assert_eq!(newest(&shared).unwrap().time, now);
    }
}

#[test]
fn a_sender_whose_clock_comes_and_goes_does_not_go_back_in_time() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    let mut stamps = Vec::new();
    // By the clock 5 ms later than the first; by its arrival, without a clock, 10 ms.
    for (time, now) in [(1_000, 0), (0, 10_000), (6_000, 20_000), (31_000, 30_000)] {
        fed.message(&odometry(time), now);
        stamps.extend(newest(&shared).map(|pose| pose.time));
    }
    assert_eq!(stamps, [0, 10_000, 30_000]);
}

/// When poses of a sender were true that is `ahead` us ahead and 30 to 50 ms late, and answers TIMESYNC by a clock that
/// is `answers` us ahead: the error of each stamp, us.
fn late_by_30_ms(shared: &Local, ahead: u64, answers: Option<u64>) -> Vec<i64> {
    let mut fed = Fed::new(shared);
    let truths = (0..100).map(|count| 1_000_000 + 10_000 * count);
    let errors = truths.enumerate().map(|(count, truth)| {
        fed.message(&odometry(truth + ahead), truth + 30_000 + count as u64 % 3 * 3_000);
        let pose = newest(shared).map(|pose| pose.time as i64 - truth as i64);
        if let Some(answers) = answers.filter(|_| count % 20 == 0) {
            // 1 ms there, 3 ms back.
            let asked = truth + 40_000;
            let sent = asked + 1_000 + answers;
            fed.message(&TIMESYNC_DATA { tc1: sent as i64 * 1_000, ts1: asked as i64 * 1_000 }, asked + 4_000);
        }
        pose
    });
    errors.flatten().collect()
}

#[test]
fn a_sender_that_answers_timesync_has_no_delay() {
    for ahead in [0, 77, 1_800_000_000_000_000] {
        let shared = Local::new();
        let errors = late_by_30_ms(&shared, ahead, Some(ahead));
        assert_eq!(errors[0], 30_000);
        // While the stamps are set back nothing goes back in time, and the sender, who did nothing wrong, is not
        // scolded.
        assert_eq!(texts(&shared), [] as [&str; 0]);
        assert!((95..99).contains(&errors.len()), "{}", errors.len());
        assert!(errors[1..].iter().all(|error| error.abs() <= 1_050), "{errors:?}");
    }
}

#[test]
fn timesync_of_another_clock_does_not_count_and_a_measured_delay_does() {
    for answers in [None, Some(0), Some(10_000_000), Some(4_400_000)] {
        let shared = Local::new();
        let plain = late_by_30_ms(&shared, 5_000_000, answers);
        assert!(plain.iter().all(|error| (30_000..30_200).contains(error)), "{plain:?}");
        shared.parameters.set(Name::PoseDelay, 30.0).unwrap();
        let errors = late_by_30_ms(&shared, 5_000_000, answers);
        assert!(errors.iter().all(|error| (0..200).contains(error)), "{errors:?}");
    }
    // A sender without a clock has that delay as well.
    let shared = Local::new();
    shared.parameters.set(Name::PoseDelay, 30.0).unwrap();
    Fed::new(&shared).message(&odometry(0), 100_000);
    assert_eq!(newest(&shared).unwrap().time, 70_000);
}

/// A sender that answers TIMESYNC once a second, the first time more quickly than ever again; a pose each 10 ms for as
/// long as there are `ticks`; `line` gives its clock at a true time and the delay of its poses. What became of each.
fn synchronised(shared: &Local, ticks: u64, line: impl Fn(u64) -> (u64, u64)) -> Vec<(u64, Option<u64>)> {
    let mut fed = Fed::new(shared);
    let mut answered = 0;
    let truths = (0..ticks).map(|count| 1_000_000 + 10_000 * count);
    let stamps = truths.map(|truth| {
        let (stamp, late) = line(truth);
        let arrived = truth + late;
        fed.message(&odometry(stamp), arrived);
        let stamp = newest(shared).map(|pose| pose.time);
        if arrived >= answered + 1_000_000 {
            let way = if answered == 0 { 500 } else { 3_000 };
            answered = arrived;
            let asked = arrived - 2 * way;
            let sent = line(asked + way).0;
            fed.message(&TIMESYNC_DATA { tc1: sent as i64 * 1_000, ts1: asked as i64 * 1_000 }, arrived);
        }
        (truth, stamp)
    });
    stamps.collect()
}

/// Greatest error of the stamps of poses from `from` on, us.
fn worst(stamps: &[(u64, Option<u64>)], from: u64) -> u64 {
    let errors = stamps.iter().filter(|(truth, _)| *truth >= from);
    errors.filter_map(|(truth, stamp)| stamp.map(|stamp| stamp.abs_diff(*truth))).max().unwrap()
}

#[test]
fn timesync_answers_of_a_clock_do_not_count_once_it_was_set_back() {
    for back in [100_000, 200_000, 450_000, 5_000_000] {
        let shared = Local::new();
        let clock = |truth: u64| 1_700_000_000_000_000 + truth - if truth >= 5_500_000 { back } else { 0 };
        let stamps = synchronised(&shared, 1_500, |truth| (clock(truth), 20_000));
        assert!(worst(&stamps, 2_500_000) <= 3_500, "{back}: {} us", worst(&stamps, 2_500_000));
        let lost = stamps.iter().filter(|(truth, stamp)| *truth >= 2_500_000 && stamp.is_none()).count();
        assert!(lost <= usize::from(TRIAL_FRAMES), "{lost}");
    }
}

#[test]
fn a_stream_that_timesync_knows_to_be_late_is_never_fresh() {
    let shared = Local::new();
    let late = |truth: u64| if truth < 5_000_000 { 20_000 } else { 620_000 };
    let stamps = synchronised(&shared, 2_000, |truth| (1_700_000_000_000_000 + truth, late(truth)));
    let taken = stamps.iter().filter(|(truth, _)| *truth >= 2_500_000);
    assert!(taken.into_iter().all(|(truth, stamp)| stamp.is_some() == (*truth < 5_000_000)));
    assert!(texts(&shared).contains(&"Pose refused: more than 0.5 s late".to_owned()));
}

#[test]
fn a_late_stream_without_timesync_is_refused_with_the_remedy() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&odometry(1_000), 0);
    // 0.6 s late from now on, and too unsteady to be a clock that was set.
    for count in 1..200 {
        fed.message(&odometry(1_000 + 10_000 * count), 600_000 + 10_000 * count + count % 3 * 25_000);
    }
    let texts = texts(&shared);
    assert!(texts.iter().all(|text| text == "Pose refused: 0.5 s late; let it answer TIMESYNC"), "{texts:?}");
    assert!(!texts.is_empty());
    // A time that does not advance is another matter.
    fed.message(&odometry(1_000), 9_000_000);
    assert_eq!(self::texts(&shared), ["Pose refused: its time does not advance"]);
}

#[test]
fn a_clock_that_stood_still_is_believed_once_timesync_confirms_it() {
    let shared = Local::new();
    let clock = |truth: u64| if truth < 5_000_000 { truth } else { truth.saturating_sub(900_000).max(5_000_000) };
    let stamps = synchronised(&shared, 1_500, |truth| (1_700_000_000_000_000 + clock(truth), 20_000));
    let back = stamps.iter().find(|(truth, stamp)| *truth > 6_000_000 && stamp.is_some()).unwrap().0;
    assert!(back < 8_000_000 && worst(&stamps, back) <= 25_000, "{back}, {} us", worst(&stamps, back));
    assert!(worst(&stamps, back + 1_500_000) <= 3_500);
}

/// A pose each 10 ms, 5 ms late, of a sender that answers TIMESYNC; from 3 s on the vehicle's clock stands still for
/// `stall`, us, and then makes up for it. Each pose's stamp, and whether the delay counts as unknown after it.
fn stalled(shared: &Local, stall: u64) -> Vec<(u64, Option<u64>, bool)> {
    let shown = |truth: u64| match truth {
        3_000_000.. => {
            truth - stall.saturating_sub(2 * (truth - 3_000_000).saturating_sub(stall)).min(truth - 3_000_000)
        }
        _ => truth,
    };
    let mut fed = Fed::new(shared);
    let truths = (0..600).map(|count| 1_000_000 + 10_000 * count);
    let stamps = truths.map(|truth| {
        let ahead = 1_700_000_000_000_000;
        fed.message(&odometry(truth + ahead), shown(truth + 5_000));
        let stamp = newest(shared).map(|pose| pose.time);
        let is_unknown = shared.pose_delay_unknown.is_raised();
        if truth % 1_000_000 == 0 && !(3_000_000..4_000_000).contains(&truth) {
            let (asked, arrived) = (shown(truth + 5_000), shown(truth + 7_000));
            let sent = truth + 6_000 + ahead;
            fed.message(&TIMESYNC_DATA { tc1: sent as i64 * 1_000, ts1: asked as i64 * 1_000 }, arrived);
        }
        (truth, stamp, is_unknown)
    });
    stamps.collect()
}

#[test]
fn a_clock_that_stalls_and_makes_up_for_it_leaves_the_delay_known() {
    for stall in [3_000, 20_000, 90_000] {
        let shared = Local::new();
        let stamps = stalled(&shared, stall);
        let known = stamps.iter().filter(|(truth, ..)| *truth > 1_000_000);
        assert!(known.clone().all(|(.., is_unknown)| !is_unknown), "{stall}");
        // It has made up for it within twice the time.
        let after = known.filter(|(truth, ..)| *truth > 3_000_000 + 2 * stall);
        let errors: Vec<_> = after.map(|(truth, stamp, _)| stamp.unwrap().abs_diff(*truth)).collect();
        assert!(errors.iter().all(|error| *error <= 2_100), "{stall}: {:?}", errors.iter().max());
    }
}

#[test]
fn a_clock_that_was_set_is_not_called_late_where_timesync_answers() {
    let shared = Local::new();
    let clock = |truth: u64| 1_700_000_000_000_000 + truth + if truth >= 5_500_000 { 300_000 } else { 0 };
    synchronised(&shared, 1_500, |truth| (clock(truth), 20_000));
    assert_eq!(texts(&shared), ["Pose refused: its sender's clock was set"]);
}
