//! Why the vehicle restarted, kept over the reset and reported.

use crate::support::Simulated;
use crate::support::receiver::{Local, report, texts};
use firmware::last_words::{LastWords, MEMORY_BYTES};
use firmware::shared::CardState;
use firmware::status::{RESTART_REPORT_INTERVAL_US, RestartReport};
use flight::Mode;

const FAULT: &str = "fault at 0x08012344 from 0x08012001, CFSR 0x00008200, HFSR 0x40000000, BFAR 0x00000004";

fn restarted() -> (Local, RestartReport) {
    let shared = Local::new();
    shared.last_words.put(LastWords::new(FAULT), 0);
    (shared, RestartReport::default())
}

#[test]
fn words_survive_the_memory_and_nothing_else_passes_for_words() {
    let words = LastWords::new(FAULT);
    let memory = words.to_bytes();
    assert_eq!(LastWords::from_bytes(&memory).map(|words| words.as_str().to_owned()).as_deref(), Some(FAULT));
    for place in 0..MEMORY_BYTES {
        let mut spoiled = memory;
        spoiled[place] ^= 0x10;
        assert_eq!(LastWords::from_bytes(&spoiled), None, "byte {place}");
    }
    assert_eq!(LastWords::from_bytes(&[0; MEMORY_BYTES]), None);
    assert_eq!(LastWords::from_bytes(&[0xFF; MEMORY_BYTES]), None);
}

#[test]
fn words_without_room_are_cut_at_whole_characters() {
    let long = "ä".repeat(200);
    let words = LastWords::new(&long);
    assert!(long.starts_with(words.as_str()) && words.as_str().chars().count() == 74);
}

#[test]
fn the_first_ground_station_receives_why_the_vehicle_restarted() {
    let (shared, mut reporter) = restarted();
    reporter.tick(shared.for_status(), 0);
    let first = texts(&shared);
    assert_eq!(first.concat(), format!("Restarted: {FAULT}"));
    assert!(first.iter().all(|line| line.len() <= 50));
    reporter.tick(shared.for_status(), 50_000);
    assert!(texts(&shared).is_empty());
    shared.ground_station.put((), 100_000);
    reporter.tick(shared.for_status(), 100_000);
    assert_eq!(texts(&shared), first);
    reporter.tick(shared.for_status(), 150_000);
    assert!(texts(&shared).is_empty());
}

#[test]
fn the_card_is_reported_once_it_is_ready() {
    let (shared, mut reporter) = restarted();
    reporter.tick(shared.for_status(), 0);
    assert!(shared.card_events.take().is_none());
    shared.card.set(CardState::Ready, 3_000_000);
    reporter.tick(shared.for_status(), 3_000_000);
    assert!(shared.card_events.take().is_some());
}

#[test]
fn it_is_repeated_until_the_vehicle_arms() {
    let (shared, mut reporter) = restarted();
    let mut count = |time| {
        reporter.tick(shared.for_status(), time);
        texts(&shared).len()
    };
    assert_eq!(
        [
            count(0),
            count(RESTART_REPORT_INTERVAL_US - 1),
            count(RESTART_REPORT_INTERVAL_US),
            count(RESTART_REPORT_INTERVAL_US + 1)
        ],
        [2, 0, 2, 0]
    );
    report(&shared, Mode::Idling, 2 * RESTART_REPORT_INTERVAL_US);
    assert_eq!(count(2 * RESTART_REPORT_INTERVAL_US), 0);
    report(&shared, Mode::Ready, 3 * RESTART_REPORT_INTERVAL_US);
    assert_eq!(count(3 * RESTART_REPORT_INTERVAL_US), 0);
}

#[test]
fn the_status_task_reports_it() {
    struct Dark;
    impl firmware::hardware::Light for Dark {
        fn set(&mut self, _on: bool) {}
    }
    impl firmware::hardware::Battery for Dark {
        async fn voltage(&mut self) -> Option<f32> {
            None
        }
    }
    let ((shared, _), clock) = (restarted(), Simulated::default());
    clock.run(1_000_000, firmware::status::run(Dark, Dark, &clock, shared.for_status()), |_| ());
    assert_eq!(texts(&shared).concat(), format!("Restarted: {FAULT}"));
}
