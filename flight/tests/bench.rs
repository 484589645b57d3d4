//! One motor on the bench: turned slowly, or its controller given a word, while nothing else turns; and what is refused
//! there.

use crate::support::{Flight, Handed, PERIOD_US, at_rest, pilot};
use flight::{Mode, MotorSetting, MotorTest, Output, Reason, Refusal, Request, Setting, Word};

const NOW_US: u64 = 5_000_000;

#[test]
fn a_motor_test_turns_one_motor_slowly_and_ends_by_itself_or_by_any_request() {
    let test = MotorTest { rotor: 2, level: 0.15, duration: 500_000 };
    let mut flight = Flight::settled();
    flight.inputs.request = Some(Request::MotorTest(test));
    let begin = flight.tick();
    assert_eq!((begin.answer, begin.mode), (Some(Ok(())), Mode::MotorTest));
    assert_eq!(begin.output, Output::Test { rotor: 2, level: 0.15 });
    for _ in 1..50 {
        assert_eq!(flight.tick().output, Output::Test { rotor: 2, level: 0.15 });
    }
    let end = flight.tick();
    assert_eq!(end.transition.map(|transition| transition.reason), Some(Reason::MotorTestOver));
    assert_eq!(end.output, Output::Stop);
    for request in [Request::Arm, Request::MotorTest(test)] {
        flight.inputs.request = Some(Request::MotorTest(test));
        flight.tick();
        flight.inputs.request = Some(request);
        let interrupted = flight.tick();
        assert_eq!(interrupted.answer, Some(Err(Refusal::MotorTestRunning)));
        assert_eq!((interrupted.output, interrupted.mode), (Output::Stop, Mode::Checks));
        flight.tick();
    }
}

/// The motors' commands, tick by tick, when a controller's setting is changed; the stop command where it is left
/// out.
fn words(setting: Setting) -> Vec<(usize, Word)> {
    let mut flight = Flight::settled();
    flight.inputs.request = Some(Request::MotorSetting(MotorSetting { rotor: 2, setting }));
    let begin = flight.tick();
    assert_eq!((begin.answer, begin.mode), (Some(Ok(())), Mode::MotorTest));
    let mut outcomes = vec![begin];
    while outcomes.last().unwrap().mode == Mode::MotorTest {
        outcomes.push(flight.tick());
    }
    assert_eq!(outcomes.len(), 31, "300 ms, and the tick after them");
    assert_eq!(outcomes[30].transition.map(|transition| transition.reason), Some(Reason::MotorTestOver));
    let words = outcomes.iter().enumerate().filter_map(|(tick, outcome)| match outcome.output {
        Output::Word { rotor: 2, word } => Some((tick, word)),
        ref other => (*other != Output::Stop).then(|| panic!("{other:?}")),
    });
    words.collect()
}

#[test]
fn a_motors_controller_beeps_and_keeps_its_direction_and_turns_nothing_meanwhile() {
    assert_eq!(words(Setting::Beep), [(0, Word::Beep)]);
    assert_eq!(words(Setting::Normal), [(0, Word::Normal), (5, Word::Save)]);
    assert_eq!(words(Setting::Reversed), [(0, Word::Reversed), (5, Word::Save)]);
}

#[test]
fn motor_tests_of_other_rotors_levels_or_durations_are_refused() {
    let good = MotorTest { rotor: 3, level: 0.15, duration: 2_000_000 };
    for (test, refusal) in [
        (MotorTest { rotor: 4, ..good }, Refusal::NoSuchRotor),
        (MotorTest { rotor: usize::MAX, ..good }, Refusal::NoSuchRotor),
        (MotorTest { level: 0.151, ..good }, Refusal::MotorTestLevel),
        (MotorTest { level: 0.0, ..good }, Refusal::MotorTestLevel),
        (MotorTest { level: f32::NAN, ..good }, Refusal::MotorTestLevel),
        (MotorTest { duration: 2_000_001, ..good }, Refusal::MotorTestDuration),
        (MotorTest { duration: 0, ..good }, Refusal::MotorTestDuration),
    ] {
        let mut pilot = pilot();
        at_rest(NOW_US - PERIOD_US).to(&mut pilot);
        let outcome = Handed { request: Some(Request::MotorTest(test)), ..at_rest(NOW_US) }.to(&mut pilot);
        assert_eq!((outcome.answer, outcome.output), (Some(Err(refusal)), Output::Stop));
        let outcome = Handed { request: Some(Request::MotorTest(good)), ..at_rest(NOW_US + PERIOD_US) }.to(&mut pilot);
        assert_eq!((outcome.answer, outcome.mode), (Some(Ok(())), Mode::MotorTest));
        let outcome = Handed { request: Some(Request::Arm), ..at_rest(NOW_US + 2 * PERIOD_US) }.to(&mut pilot);
        assert_eq!((outcome.answer, outcome.mode), (Some(Err(Refusal::MotorTestRunning)), Mode::Checks));
    }
}

#[test]
fn a_motor_controller_gets_no_word_while_motors_turn_nor_does_one_that_is_missing() {
    let set = |rotor| Request::MotorSetting(MotorSetting { rotor, setting: Setting::Reversed });
    assert_eq!(Flight::settled().answer(set(4)), Err(Refusal::NoSuchRotor));
    let mut flight = Flight::settled();
    assert_eq!(flight.answer(Request::Arm), Ok(()));
    assert_eq!(flight.answer(set(1)), Err(Refusal::AlreadyArmed));
    assert_eq!(flight.tick().output, Output::Idle);
}
