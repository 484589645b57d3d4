//! The light, the battery and the queues.

mod support;

use controller_core::flight::Mode;
use core::future::pending;
use firmware::hardware::{Battery, Light};
use firmware::parameters::table::Name;
use firmware::shared::{Flag, Severity, TEXT_MAX, Text};
use firmware::status::{STEP, is_lit, run};
use std::cell::RefCell;
use support::Simulated;
use support::receiver::{Local, report, texts};

struct Lamp<'a>(&'a RefCell<Vec<bool>>);

impl Light for Lamp<'_> {
    fn set(&mut self, on: bool) {
        self.0.borrow_mut().push(on);
    }
}

/// A battery that reads so many volts; without any, the reading never ends.
struct Cell(Option<f32>);

impl Battery for Cell {
    async fn voltage(&mut self) -> Option<f32> {
        if self.0.is_none() {
            pending::<()>().await;
        }
        self.0
    }
}

/// The light over one second, step by step.
fn pattern(mode: Option<Mode>) -> String {
    (0..1_000_000 / STEP).map(|step| if is_lit(mode, step * STEP) { '#' } else { '.' }).collect()
}

#[test]
fn every_mode_has_a_pattern_of_its_own() {
    assert_eq!(pattern(Some(Mode::Disarmed)), "#...................");
    assert_eq!(pattern(Some(Mode::MotorTest)), "#...#...............");
    assert_eq!(pattern(Some(Mode::Flying)), "####################");
    assert_eq!(pattern(Some(Mode::Holding)), "##########..........");
    assert_eq!(pattern(Some(Mode::Levelling)), "##..##..##..##..##..");
    assert_eq!(pattern(None), "#.#.#.#.#.#.#.#.#.#.");
}

#[test]
fn the_light_shows_the_pattern_at_its_pace_and_flickers_without_a_report() {
    let (clock, shared, lamp) = (Simulated::default(), Local::new(), RefCell::default());
    report(&shared, Mode::Flying, 0);
    clock.run(3_000_000, run(Lamp(&lamp), Cell(Some(12.0)), &clock, &shared), |_| ());
    let shown: String = lamp.borrow().iter().map(|&on| if on { '#' } else { '.' }).collect();
    assert_eq!(shown.len(), 60);
    assert_eq!(&shown[..20], "####################");
    assert_eq!(&shown[40..], "#.#.#.#.#.#.#.#.#.#.");
}

#[test]
fn the_battery_is_read_and_warned_of_when_low() {
    let (clock, shared, lamp) = (Simulated::default(), Local::new(), RefCell::default());
    shared.parameters.set(Name::BatteryLow, 10.5).unwrap();
    clock.run(15_000_000, run(Lamp(&lamp), Cell(Some(10.4)), &clock, &shared), |_| ());
    let voltage = shared.voltage.get().unwrap();
    assert!(voltage.value == 10.4 && voltage.time > 14_500_000);
    assert_eq!(texts(&shared), ["Battery low: 10.4 V"; 2]);
    // The log has been emptied of them.
    assert!(shared.log.take().is_none());
}

#[test]
fn a_battery_that_does_not_answer_or_reads_nonsense_stops_nothing() {
    for cell in [None, Some(f32::NAN)] {
        let (clock, shared, lamp) = (Simulated::default(), Local::new(), RefCell::default());
        clock.run(1_000_000, run(Lamp(&lamp), Cell(cell), &clock, &shared), |_| ());
        assert!(shared.voltage.get().is_none());
        assert_eq!(lamp.borrow().len(), 20);
    }
}

#[test]
fn texts_are_cut_at_whole_characters() {
    let long = "x".repeat(TEXT_MAX - 1);
    assert_eq!(Text::new(&[&long, "äb"]).as_str(), long);
    assert_eq!(Text::new(&[&long, "ab"]).as_str(), format!("{long}a"));
    // Nothing is said behind a gap.
    assert_eq!(Text::new(&[&long, "ä", "b"]).as_str(), long);
}

#[test]
fn numbers_are_written_with_one_decimal() {
    let written = [0.0, 0.04, 0.06, 9.96, -1.25, 250.0].map(Text::decimal);
    assert_eq!(written.each_ref().map(Text::as_str), ["0.0", "0.0", "0.1", "10.0", "-1.3", "250.0"]);
}

#[test]
fn counts_are_written_whole() {
    for number in [0, 7, 10, 305, u32::MAX] {
        assert_eq!(Text::count(number).as_str(), number.to_string());
    }
}

#[test]
fn a_flag_is_taken_once() {
    let flag = Flag::new();
    assert!(!flag.take());
    flag.raise();
    flag.raise();
    assert!(flag.is_raised() && flag.take() && !flag.take());
}

#[test]
fn events_without_room_are_counted() {
    let shared = Local::new();
    for _ in 0..20 {
        shared.announce(Severity::Critical, &["again"]);
    }
    assert_eq!(shared.lost_events(), 20 - firmware::shared::EVENTS as u32);
}
