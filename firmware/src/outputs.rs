//! From a tick's decision to the motors' command.
//!
//! A rotor's thrust follows the square of its speed. A speed controller that holds its command's speed makes it a
//! square of the command, a = 0 in `controller_core::allocation::curve`; most lie between that and a line, and
//! `docs/thrust-stand.md` describes how a is measured. A full command is the scenario's greatest thrust, at the voltage
//! where it was measured.

use crate::hardware::{MOTOR_COUNT, MotorCommand};
use controller_core::allocation::curve::Battery;
use controller_core::allocation::{Rotor, Rotors, ThrustCurve};
use controller_core::error::{ParameterError, Reason};
use flight::{Output, Stamped};

/// The outputs that the rotors' controllers are wired to, from 0: the first digit of `order` is the first rotor's
/// output, from 1. None unless each of the outputs is there once.
#[must_use]
pub fn wiring(order: f32) -> Option<[usize; MOTOR_COUNT]> {
    let order = order as usize;
    let outputs = [1_000, 100, 10, 1].map(|place| (order / place % 10).wrapping_sub(1));
    (0..MOTOR_COUNT).all(|output| outputs.contains(&output)).then_some(outputs)
}

/// The thrust curves of a vehicle's motors.
#[derive(Debug, Clone, PartialEq)]
pub struct Outputs([ThrustCurve; MOTOR_COUNT]);

impl Outputs {
    /// For `rotors`, one to each motor, whose curves have the part `linear` in [0, 1] that grows with the command
    /// itself.
    ///
    /// # Errors
    /// Names `rotors` if there are not [`MOTORS`] of them, `rotors.curve` if there is no such curve.
    pub fn new(rotors: &Rotors, linear: f32) -> Result<Self, ParameterError> {
        let curve = |rotor: &Rotor| ThrustCurve::new(rotor.thrust_max, linear);
        match &rotors[..] {
            [a, b, c, d] => Ok(Self([curve(a)?, curve(b)?, curve(c)?, curve(d)?])),
            fewer if fewer.len() < MOTOR_COUNT => {
                Err(ParameterError { field: "rotors", reason: Reason::TooFew(MOTOR_COUNT) })
            }
            _ => Err(ParameterError { field: "rotors", reason: Reason::TooMany(MOTOR_COUNT) }),
        }
    }

    /// The motors' command for `output` at V_0 / V = `ratio`, from [`voltage_ratio`], where `idle` is what they
    /// idle at.
    #[must_use]
    pub fn command(&self, output: &Output, ratio: f32, idle: f32) -> MotorCommand {
        match output {
            Output::Stop => MotorCommand::Stop,
            Output::Idle => MotorCommand::Run([idle; MOTOR_COUNT]),
            Output::Test { rotor, level } => MotorCommand::One { motor: *rotor, level: *level },
            Output::Word { rotor, word } => MotorCommand::Word { motor: *rotor, word: *word },
            Output::Thrusts(thrusts) => {
                let mut commands = [0.0; MOTOR_COUNT];
                for ((command, curve), thrust) in commands.iter_mut().zip(&self.0).zip(thrusts) {
                    *command = curve.command(*thrust, ratio);
                }
                MotorCommand::Run(commands)
            }
        }
    }
}

/// V_0 / V for the curves, at `now`, us: one where no `nominal` voltage is set (0), and without a recent, plausible
/// reading.
#[must_use]
pub fn voltage_ratio(nominal: f32, voltage: Option<Stamped<f32>>, now: u64) -> f32 {
    match (Battery::new(nominal), voltage) {
        (Ok(battery), Some(voltage)) => battery.ratio(voltage.value, voltage.age(now)),
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use controller_core::allocation::QuadX;
    use controller_core::allocation::Thrusts;

    fn outputs() -> Outputs {
        let (thrust_coefficient, drag_coefficient) = (5.57e-6, 1.36e-7);
        let quad = QuadX { arm: 0.17, thrust_coefficient, drag_coefficient, speed_min: 100.0, speed_max: 800.0 };
        Outputs::new(&Rotors::quad_x(quad).unwrap(), 0.0).unwrap()
    }

    #[test]
    fn half_the_greatest_speed_is_half_a_command() {
        let thrusts = Thrusts::from_slice(&[5.57e-6 * 400.0 * 400.0; 4]).unwrap();
        let MotorCommand::Run(commands) = outputs().command(&Output::Thrusts(thrusts), 1.0, 0.03) else { panic!() };
        assert!(commands.iter().all(|command| (command - 0.5).abs() < 1e-6), "{commands:?}");
    }

    #[test]
    fn a_motor_test_turns_one_motor_and_a_stop_none() {
        let test = Output::Test { rotor: 2, level: 0.1 };
        assert_eq!(outputs().command(&test, 1.0, 0.03), MotorCommand::One { motor: 2, level: 0.1 });
        assert_eq!(outputs().command(&Output::Stop, 1.0, 0.03), MotorCommand::Stop);
        assert_eq!(outputs().command(&Output::Idle, 1.0, 0.03), MotorCommand::Run([0.03; MOTOR_COUNT]));
    }

    #[test]
    fn a_battery_that_sags_is_made_up_for_while_its_reading_is_recent_and_plausible() {
        let reading = |value, time| Some(Stamped { value, time });
        assert!((voltage_ratio(12.6, reading(10.5, 5), 100) - 1.2).abs() < 1e-6);
        for (nominal, voltage, now) in [
            (0.0, reading(10.5, 5), 100),
            (12.6, None, 100),
            (12.6, reading(10.5, 5), 2_000_000),
            (12.6, reading(f32::NAN, 5), 100),
            (12.6, reading(1.0, 5), 100),
        ] {
            assert_eq!(voltage_ratio(nominal, voltage, now), 1.0, "{nominal} {voltage:?}");
        }
        let thrusts = Thrusts::from_slice(&[1.0; 4]).unwrap();
        let at = |ratio| match outputs().command(&Output::Thrusts(thrusts.clone()), ratio, 0.03) {
            MotorCommand::Run(commands) => commands[0],
            _ => panic!(),
        };
        assert!((at(1.2) / at(1.0) - 1.2).abs() < 1e-6);
    }
}
