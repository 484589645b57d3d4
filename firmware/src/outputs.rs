//! From what a tick decided to what the motors are told.
//!
//! A rotor's thrust follows the square of its speed, and an electronic speed controller's command sets the speed:
//! command = sqrt(f / f_max) (`controller_core::allocation::curve` with a = 0), 1 at the thrust the scenario calls greatest.

use crate::hardware::{MOTORS, MotorCommand};
use controller_core::allocation::{Rotor, Rotors, ThrustCurve};
use controller_core::error::{ParameterError, Reason};
use controller_core::flight::Output;

/// V_0 / V of the battery: nothing is compensated for. The scenario's greatest thrust is that of the battery as it is.
const RATIO: f32 = 1.0;

/// The thrust curves of a vehicle's motors.
#[derive(Debug, Clone, PartialEq)]
pub struct Outputs([ThrustCurve; MOTORS]);

impl Outputs {
    /// For `rotors`, one to each motor.
    ///
    /// # Errors
    /// Names `rotors` if there are not [`MOTORS`] of them.
    pub fn new(rotors: &Rotors) -> Result<Self, ParameterError> {
        let curve = |rotor: &Rotor| ThrustCurve::new(rotor.thrust_max, 0.0);
        match &rotors[..] {
            [a, b, c, d] => Ok(Self([curve(a)?, curve(b)?, curve(c)?, curve(d)?])),
            fewer if fewer.len() < MOTORS => Err(ParameterError { field: "rotors", reason: Reason::TooFew(MOTORS) }),
            _ => Err(ParameterError { field: "rotors", reason: Reason::TooMany(MOTORS) }),
        }
    }

    /// What the motors are told for `output`.
    #[must_use]
    pub fn command(&self, output: &Output) -> MotorCommand {
        match output {
            Output::Stop => MotorCommand::Stop,
            Output::Test { rotor, level } => MotorCommand::One { motor: *rotor, level: *level },
            Output::Thrusts(thrusts) => {
                let mut commands = [0.0; MOTORS];
                for ((command, curve), thrust) in commands.iter_mut().zip(&self.0).zip(thrusts) {
                    *command = curve.command(*thrust, RATIO);
                }
                MotorCommand::Run(commands)
            }
        }
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
        Outputs::new(&Rotors::quad_x(quad).unwrap()).unwrap()
    }

    #[test]
    fn half_the_greatest_speed_is_half_a_command() {
        let thrusts = Thrusts::from_slice(&[5.57e-6 * 400.0 * 400.0; 4]).unwrap();
        let MotorCommand::Run(commands) = outputs().command(&Output::Thrusts(thrusts)) else { panic!() };
        assert!(commands.iter().all(|command| (command - 0.5).abs() < 1e-6), "{commands:?}");
    }

    #[test]
    fn a_motor_test_turns_one_motor_and_a_stop_none() {
        let test = Output::Test { rotor: 2, level: 0.1 };
        assert_eq!(outputs().command(&test), MotorCommand::One { motor: 2, level: 0.1 });
        assert_eq!(outputs().command(&Output::Stop), MotorCommand::Stop);
    }
}
