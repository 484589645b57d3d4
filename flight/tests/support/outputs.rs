//! What an output may be.

use controller_core::allocation::Rotors;
use flight::rules::MOTOR_TEST_LEVEL_MAX;
use flight::{Mode, Outcome, Output};

/// The motors' share of an outcome: within their ranges in armed modes, stopped in all others.
pub fn check_output(outcome: &Outcome, rotors: &Rotors) {
    match &outcome.output {
        Output::Stop => {}
        Output::Idle => assert_eq!(outcome.mode, Mode::Idling),
        Output::Thrusts(thrusts) => {
            assert!(outcome.mode.flies());
            assert_eq!(thrusts.len(), rotors.len());
            for (thrust, rotor) in thrusts.iter().zip(rotors.iter()) {
                assert!((rotor.thrust_min..=rotor.thrust_max).contains(thrust), "{thrust}");
            }
        }
        Output::Test { rotor, level } => {
            assert_eq!(outcome.mode, Mode::MotorTest);
            assert!(*rotor < rotors.len() && *level > 0.0 && *level <= MOTOR_TEST_LEVEL_MAX);
        }
        Output::Word { rotor, .. } => assert!(outcome.mode == Mode::MotorTest && *rotor < rotors.len()),
    }
}
