use super::*;
use crate::shared::Shared;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;

const POLE_COUNT: f32 = 14.0;

/// Takes the answers to frames a millisecond apart, from 1 ms on.
fn after(frames: &[[Option<Answer>; MOTOR_COUNT]]) -> Shared<NoopRawMutex> {
    let (shared, mut controllers) = (Shared::new(), Controllers::default());
    for (answers, time) in frames.iter().zip((1_000..).step_by(1_000)) {
        controllers.take(*answers, POLE_COUNT, time, shared.for_motors());
    }
    shared
}

#[test]
fn controllers_that_never_answer_publish_nothing() {
    let shared = after(&[[None; MOTOR_COUNT]; 50]);
    assert!(shared.rotor_speeds.get().is_none() && shared.controllers.get().is_none());
}

#[test]
fn a_speed_counts_for_20_ms_and_what_a_controller_says_of_itself_for_good() {
    let (turns, warm) = (Some(Answer::Period(1000)), Some(Answer::Temperature(31)));
    let mut frames = vec![[turns, Some(Answer::AtRest), None, None], [warm, turns, None, None]];
    frames.extend([[None, turns, None, None]; 18]);
    let speed = Answer::Period(1000).speed(POLE_COUNT);
    let shared = after(&frames);
    assert_eq!(shared.rotor_speeds.get().unwrap().value, [speed, speed, None, None]);
    frames.push([None, turns, None, None]);
    let shared = after(&frames);
    assert_eq!(shared.rotor_speeds.get(), Some(Stamped { value: [None, speed, None, None], time: 21_000 }));
    let [first, second, third, _] = shared.controllers.get().unwrap().value;
    assert_eq!((first.temperature, first.answered, first.missed), (Some(31), 2, 19));
    assert_eq!((second.temperature, second.answered, second.missed), (None, 21, 0));
    assert_eq!(third, Controller::default());
}

#[test]
fn everything_that_a_controller_says_is_kept() {
    let answers = [
        Answer::Voltage(15.25),
        Answer::Current(7),
        Answer::Stress(3),
        Answer::Status(Answer::STALLED),
        Answer::Debug(0, 1),
    ];
    let frames: Vec<_> = answers.into_iter().map(|answer| [Some(answer), None, None, None]).collect();
    let [first, ..] = after(&frames).controllers.get().unwrap().value;
    let expected = Controller {
        voltage: Some(15.25),
        current: Some(7),
        stress: Some(3),
        status: Some(Answer::STALLED),
        answered: 5,
        ..Controller::default()
    };
    assert_eq!(first, expected);
}
