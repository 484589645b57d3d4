//! One motor on the bench: turned slowly, or its controller given a word, while nothing else turns; and what is refused
//! there.

use crate::support::{Flight, Handed, PERIOD_US, at_rest, pilot, rotors};
use controller_core::allocation::Spin;
use flight::{Mode, MotorSetting, MotorTest, Outcome, Output, Reason, Refusal, Request, Setting, Stamped, Word};
use nalgebra::Vector3;

const NOW_US: u64 = 5_000_000;

/// The tick that a request is handed to.
fn asked(flight: &mut Flight, request: Request) -> Outcome {
    flight.inputs.request = Some(request);
    flight.tick()
}

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
    let another = MotorTest { rotor: 1, ..test };
    for request in [Request::Arm, Request::MotorTest(another)] {
        flight.inputs.request = Some(Request::MotorTest(test));
        flight.tick();
        flight.inputs.request = Some(request);
        let interrupted = flight.tick();
        assert_eq!(interrupted.answer, Some(Err(Refusal::MotorTestRunning)));
        assert_eq!((interrupted.output, interrupted.mode), (Output::Stop, Mode::Checks));
        flight.tick();
    }
}

#[test]
fn a_test_of_the_motor_that_turns_goes_on_with_the_new_level_for_the_new_time() {
    let test = MotorTest { rotor: 2, level: 0.05, duration: 100_000 };
    let faster = MotorTest { level: 0.1, ..test };
    let mut flight = Flight::settled();
    assert_eq!(flight.answer(Request::MotorTest(test)), Ok(()));
    for _ in 0..6 {
        flight.tick();
    }
    flight.inputs.request = Some(Request::MotorTest(faster));
    for tick in 0..10 {
        let outcome = flight.tick();
        assert_eq!((outcome.output, outcome.mode), (Output::Test { rotor: 2, level: 0.1 }, Mode::MotorTest), "{tick}");
    }
    assert_eq!(flight.tick().output, Output::Stop);
    // What may not begin does not go on either, and stops it.
    for (wrong, refusal) in [
        (MotorTest { level: 0.2, ..test }, Refusal::MotorTestLevel),
        (MotorTest { duration: 2_000_001, ..test }, Refusal::MotorTestDuration),
    ] {
        assert_eq!(flight.answer(Request::MotorTest(test)), Ok(()));
        let stopped = asked(&mut flight, Request::MotorTest(wrong));
        assert_eq!((stopped.answer, stopped.output, stopped.mode), (Some(Err(refusal)), Output::Stop, Mode::Checks));
    }
    // Killed or disarmed it stops, whatever else is requested in that tick.
    assert_eq!(flight.answer(Request::MotorTest(test)), Ok(()));
    flight.inputs.killed = true;
    let killed = asked(&mut flight, Request::MotorTest(test));
    assert_eq!((killed.answer, killed.output), (Some(Err(Refusal::Killed)), Output::Stop));
}

#[test]
fn a_motor_test_is_ended_on_request_and_nothing_else_is() {
    let test = MotorTest { rotor: 0, level: 0.1, duration: 1_000_000 };
    let mut flight = Flight::settled();
    assert_eq!(flight.answer(Request::EndMotorTest), Ok(()));
    assert_eq!(flight.answer(Request::MotorTest(test)), Ok(()));
    let ended = asked(&mut flight, Request::EndMotorTest);
    assert_eq!((ended.answer, ended.output, ended.mode), (Some(Ok(())), Output::Stop, Mode::Checks));
    assert_eq!(flight.answer(Request::Arm), Ok(()));
    let refused = asked(&mut flight, Request::EndMotorTest);
    assert_eq!((refused.answer, refused.mode), (Some(Err(Refusal::AlreadyArmed)), Mode::Idling));
}

#[test]
fn the_rotors_on_the_side_that_is_lowered_would_speed_up() {
    // The force that is felt points to the side that is raised.
    for (x, y) in [(3.0, 0.0), (-3.0, 0.0), (0.0, 3.0), (0.0, -3.0)] {
        let mut pilot = pilot();
        let force = Stamped { value: Vector3::new(x, y, 9.3), time: NOW_US };
        let outcome = Handed { specific_force: Some(force), ..at_rest(NOW_US) }.to(&mut pilot);
        let shares = outcome.levelling.unwrap();
        let lowered: Vec<_> = rotors().iter().map(|rotor| rotor.position.dot(&force.value) < 0.0).collect();
        assert_eq!(lowered.iter().filter(|is| **is).count(), 2);
        assert_eq!(shares.iter().map(|share| *share > 1.0).collect::<Vec<_>>(), lowered, "{force:?}: {shares:?}");
        assert!(shares.iter().all(|share| (share - 1.0).abs() > 0.02), "{shares:?}");
        assert!(outcome.lean.is_some() && outcome.output == Output::Stop);
    }
    // Turning: those that turn the same way as the vehicle would speed up, and brake it by their drag.
    let mut pilot = pilot();
    let turning = Stamped { value: Vector3::new(0.0, 0.0, 0.5), time: NOW_US };
    let level = Stamped { value: Vector3::new(0.0, 0.0, 9.81), time: NOW_US };
    let handed = Handed { specific_force: Some(level), body_rate: Some(turning), ..at_rest(NOW_US) };
    let shares = handed.to(&mut pilot).levelling.unwrap();
    let faster: Vec<_> = rotors().iter().map(|rotor| rotor.spin == Spin::CounterClockwise).collect();
    assert_eq!(shares.iter().map(|share| *share > 1.0).collect::<Vec<_>>(), faster, "{shares:?}");
}

#[test]
fn a_vehicle_that_is_armed_or_not_felt_has_no_lean_and_flies_as_one_that_had() {
    let level = |now| Some(Stamped { value: Vector3::new(0.5, 0.0, 9.8), time: now });
    let (mut with, mut without) = (Flight::settled(), Flight::settled());
    for _ in 0..50 {
        with.inputs.specific_force = level(with.inputs.now);
        assert!(with.tick().lean.is_some() && without.tick().lean.is_none());
    }
    for request in [Request::Arm, Request::TakeOff(None)] {
        with.inputs.specific_force = level(with.inputs.now);
        assert_eq!((with.answer(request), without.answer(request)), (Ok(()), Ok(())));
    }
    for _ in 0..300 {
        with.inputs.specific_force = level(with.inputs.now);
        let (one, other) = (with.tick(), without.tick());
        assert!(one.lean.is_none() && one.levelling.is_none());
        assert_eq!(one.output, other.output);
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
