//! The light, the battery and the queues.

use crate::support::Simulated;
use crate::support::receiver::{Local, report, texts};
use controller_core::error::InputError;
use core::future::pending;
use firmware::hardware::{Battery, Light};
use firmware::parameters::table::Name;
use firmware::shared::{Event, Flag, Severity, TEXT_MAX, Text};
use firmware::status::{LIGHT_STEP_US, is_lit, run};
use flight::{Mode, Reason, Refusal};
use std::cell::RefCell;

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
    (0..1_000_000 / LIGHT_STEP_US).map(|step| if is_lit(mode, step * LIGHT_STEP_US) { '#' } else { '.' }).collect()
}

#[test]
fn every_state_that_bystanders_must_see_has_its_own_light_pattern() {
    assert_eq!(pattern(Some(Mode::Ready)), "#...................");
    assert_eq!(pattern(Some(Mode::MotorTest)), "#...#...............");
    assert_eq!(pattern(Some(Mode::Stopped)), "#...#...#...........");
    assert_eq!(pattern(Some(Mode::Idling)), "##########..........");
    assert_eq!(pattern(Some(Mode::Flying)), "####################");
    assert_eq!(pattern(Some(Mode::Descending)), "##..##..##..##..##..");
    assert_eq!(pattern(None), "#.#.#.#.#.#.#.#.#.#.");
}

#[test]
fn the_light_shows_the_pattern_at_its_pace_and_flickers_without_a_report() {
    let (clock, shared, lamp) = (Simulated::default(), Local::new(), RefCell::default());
    report(&shared, Mode::Flying, 0);
    clock.run(3_000_000, run(Lamp(&lamp), Cell(Some(12.0)), &clock, shared.for_status()), |_| ());
    let shown: String = lamp.borrow().iter().map(|&on| if on { '#' } else { '.' }).collect();
    assert_eq!(shown.len(), 60);
    assert_eq!(&shown[..20], "####################");
    assert_eq!(&shown[40..], "#.#.#.#.#.#.#.#.#.#.");
}

#[test]
fn the_battery_is_read_and_warned_of_when_low() {
    let (clock, shared, lamp) = (Simulated::default(), Local::new(), RefCell::default());
    shared.parameters.set(Name::BatteryLow, 10.5).unwrap();
    clock.run(15_000_000, run(Lamp(&lamp), Cell(Some(10.4)), &clock, shared.for_status()), |_| ());
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
        clock.run(1_000_000, run(Lamp(&lamp), Cell(cell), &clock, shared.for_status()), |_| ());
        assert!(shared.voltage.get().is_none());
        assert_eq!(lamp.borrow().len(), 20);
    }
}

#[test]
fn texts_are_cut_at_whole_characters() {
    let long = "x".repeat(TEXT_MAX - 1);
    assert_eq!(Text::new(format_args!("{long}äb")).as_str(), long);
    assert_eq!(Text::new(format_args!("{long}ab")).as_str(), format!("{long}a"));
    // Nothing is sent behind a gap.
    assert_eq!(Text::new(format_args!("{long}{}{}", 'ä', 'b')).as_str(), long);
}

#[test]
fn every_event_fits_its_text_and_matters_as_it_should() {
    let words = |event: &Event| Text::new(event).as_str().to_owned();
    for reason in Reason::ALL {
        let event = Event::Mode(reason);
        assert_eq!(words(&event), reason.to_string());
        assert_eq!(event.severity() == Severity::Critical, reason.is_own_doing(), "{reason}");
    }
    // Commanded transitions and recoveries are information; a stop or landing by itself is critical.
    let own = [Reason::ImuLost, Reason::PoseLost, Reason::GroundStationLost, Reason::BatteryLow, Reason::Crashed];
    let others = [Reason::Armed, Reason::Disarmed, Reason::Landed, Reason::PoseRegained, Reason::TakenOff];
    assert!(own.iter().all(|reason| reason.is_own_doing()) && !others.iter().any(|reason| reason.is_own_doing()));
    let refused = Event::Refused(Refusal::Setpoint("setpoint.position"));
    assert_eq!(words(&refused), "Refused: setpoint.position out of range");
    assert_eq!(refused.severity(), Severity::Warning);
    let input = Event::Input(InputError::NotFinite { field: "state.position" });
    assert_eq!((words(&input).as_str(), input.severity()), ("state.position: must be finite", Severity::Critical));
    assert_eq!(
        (Event::MotorsLost.severity(), Event::MotorsRegained.severity()),
        (Severity::Critical, Severity::Information)
    );
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
        shared.announce(Event::new(Severity::Critical, "again"));
    }
    assert_eq!(shared.lost_events.get(), 20 - firmware::shared::EVENTS_CAPACITY as u32);
}
