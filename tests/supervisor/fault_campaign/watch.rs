//! What must hold in every tick, whatever has failed.

use controller_core::certificate::Certificate;
use controller_core::certificate::certified::Certified;
use controller_core::certificate::form::Interval;
use firmware::hardware::MotorCommand;
use flight::rules::{MOTOR_TEST_LEVEL_MAX, TABLE};
use flight::{Flown, Mode, Outcome, Output, Transition};

/// Tolerance for the rounding of a wrench's components against a bound.
const ROUNDING_SHARE: f64 = 1e-6;

/// What is wrong with a tick's answer by itself, in words. Once a rotor is `lost`, no bound is certified; ranges and
/// limits hold.
pub fn complaints(
    before: Mode,
    outcome: &Outcome,
    command: MotorCommand,
    certified: &Certified,
    lost: Option<usize>,
) -> Vec<String> {
    let mut said = Vec::new();
    let mut must = |holds: bool, words: &str| {
        if !holds {
            said.push(format!("{words}: {:?}, {command:?}, {:?}", outcome.mode, outcome.output));
        }
    };
    must(fits(outcome.mode, command), "motors do not fit the mode");
    must(is_explained(before, outcome), "a change of mode that is no row of the table");
    if let Some(estimated) = &outcome.estimated {
        let state = &estimated.state;
        let numbers = state.position.iter().chain(&state.velocity).chain(&state.angular_velocity);
        must(numbers.chain(state.attitude.coords.iter()).all(|number| number.is_finite()), "an estimate of no numbers");
    }
    if let Output::Thrusts(thrusts) = &outcome.output {
        must(outcome.flown.is_some(), "thrusts of nothing that was flown");
        let rotors = certified.configuration().rotors().unwrap();
        let within = rotors.iter().zip(thrusts).enumerate().all(|(index, (rotor, thrust))| {
            let may_stand = lost == Some(index);
            let least = if may_stand { 0.0 } else { rotor.thrust_min };
            *thrust >= least * (1.0 - 1e-6) && *thrust <= rotor.thrust_max * (1.0 + 1e-6)
        });
        must(within && thrusts.len() == rotors.len(), "a rotor out of its range");
        must(lost.is_some() || rotors_are_proven(thrusts, certified), "a rotor beyond its certified bound");
    }
    if let Some(Ok(flown)) = &outcome.flown {
        must(
            if lost.is_some() { is_within_limits(flown, certified) } else { is_proven(flown, certified.certificate()) },
            "a wrench beyond its certified bound",
        );
    }
    must(!matches!(outcome.flown, Some(Err(_))), "the law refused its input");
    said
}

/// The least command of a motor that turns: `idle` of a file that says nothing of it.
const MOTOR_IDLE: f32 = 0.055;

/// The motor commands that each mode may send.
fn fits(mode: Mode, command: MotorCommand) -> bool {
    match (mode, command) {
        (Mode::Boot | Mode::Locked | Mode::Checks | Mode::Ready | Mode::Stopped, command) => {
            command == MotorCommand::Stop
        }
        (Mode::MotorTest, MotorCommand::One { level, .. }) => (0.0..=MOTOR_TEST_LEVEL_MAX).contains(&level),
        (Mode::Idling, MotorCommand::Run(commands)) => commands.iter().all(|command| *command == MOTOR_IDLE),
        (mode, MotorCommand::Run(commands)) => {
            // A rotor that is lost is stopped.
            mode.flies() && commands.iter().all(|command| *command == 0.0 || (MOTOR_IDLE..=1.0).contains(command))
        }
        _ => false,
    }
}

/// Whether the mode is the one before, or one row leads from there to here.
fn is_explained(before: Mode, outcome: &Outcome) -> bool {
    match outcome.transition {
        None => outcome.mode == before,
        Some(Transition { from, to, reason }) => {
            let row = TABLE.iter().any(|row| (row.from, row.to, row.reason) == (from, to, reason));
            row && from == before && to == outcome.mode && from != to && !reason.text().is_empty()
        }
    }
}

fn is_proven(flown: &Flown, certificate: &Certificate) -> bool {
    let (wrench, raised) = (&flown.wrench, 1.0 + ROUNDING_SHARE);
    let Interval { min: least, max: greatest } = certificate.thrust();
    let torque = wrench.torque.map(|torque| f64::from(torque.abs()));
    (least / raised..=greatest * raised).contains(&f64::from(wrench.thrust))
        && torque.iter().zip(certificate.torque().iter()).all(|(asked, proven)| *asked <= proven * raised)
}

fn is_within_limits(flown: &Flown, certified: &Certified) -> bool {
    let limits = certified.configuration().limits();
    let torque = limits.torque_max - flown.wrench.torque.abs();
    flown.wrench.thrust <= limits.thrust_max && torque.min() >= 0.0
}

/// While they are brought up from idle, rotors are between their least thrust and the law's.
fn rotors_are_proven(thrusts: &[f32], certified: &Certified) -> bool {
    let rotors = certified.configuration().rotors().unwrap();
    thrusts.iter().enumerate().all(|(rotor, thrust)| {
        let (thrust, least) = (f64::from(*thrust), f64::from(rotors[rotor].thrust_min));
        certified.certificate().rotor(rotor).is_some_and(|proven| {
            thrust <= proven.max * (1.0 + ROUNDING_SHARE) && thrust >= least.min(proven.min) - ROUNDING_SHARE
        })
    })
}
