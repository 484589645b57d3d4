//! From a tick's decision to the motors' command.
//!
//! A rotor's thrust follows the square of its speed. A speed controller that holds its command's speed makes it a
//! square of the command, a = 0 in `controller_core::allocation::curve`; most lie between that and a line, and
//! `docs/thrust-stand.md` describes how a is measured. A full command is the scenario's greatest thrust, at the voltage
//! where it was measured.
//!
//! No motor that turns is commanded below what it idles at, on the ground or in flight: it would stall. One stops with
//! all others, or because it is lost.

use crate::hardware::{MOTOR_COUNT, MotorCommand};
use controller_core::allocation::curve::Battery;
use controller_core::allocation::{Motor, Rotor, Rotors, ThrustCurve};
use controller_core::error::{ParameterError, Reason};
use flight::{Output, Stamped};

/// The outputs that the rotors' controllers are wired to, from 0: the first digit of `order` is the first rotor's
/// output, from 1. None unless each of the outputs is there once.
pub fn wiring(order: f32) -> Option<[usize; MOTOR_COUNT]> {
    let order = order as usize;
    let outputs = [1_000, 100, 10, 1].map(|place| (order / place % 10).wrapping_sub(1));
    (0..MOTOR_COUNT).all(|output| outputs.contains(&output)).then_some(outputs)
}

/// The thrust curves of a vehicle's motors.
#[derive(Debug, Clone, PartialEq)]
pub struct Outputs([ThrustCurve; MOTOR_COUNT]);

impl Outputs {
    /// For `rotors`, one to each `motor`, which are alike.
    /// An error names `rotors` if there are not [`MOTOR_COUNT`] of them, `rotors.thrust_curve` or `rotors.idle` if
    /// there is no such motor.
    pub fn new(rotors: &Rotors, motor: Motor) -> Result<Self, ParameterError> {
        let curve = |rotor: &Rotor| ThrustCurve::new(rotor.thrust_max, motor);
        match &rotors[..] {
            [a, b, c, d] => Ok(Self([curve(a)?, curve(b)?, curve(c)?, curve(d)?])),
            fewer if fewer.len() < MOTOR_COUNT => {
                Err(ParameterError { field: "rotors", reason: Reason::TooFew(MOTOR_COUNT) })
            }
            _ => Err(ParameterError { field: "rotors", reason: Reason::TooMany(MOTOR_COUNT) }),
        }
    }

    /// The motors' command for `output` at V_0 / V = `ratio`, from [`voltage_ratio`].
    pub fn command(&self, output: &Output, ratio: f32) -> MotorCommand {
        match output {
            Output::Stop => MotorCommand::Stop,
            Output::Idle => MotorCommand::Run(self.0.each_ref().map(ThrustCurve::idle)),
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
pub fn voltage_ratio(nominal: f32, voltage: Option<Stamped<f32>>, now: u64) -> f32 {
    match (Battery::new(nominal), voltage) {
        (Ok(battery), Some(voltage)) => battery.ratio(voltage.value, voltage.age(now)),
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests;
