//! What happened, as a table: failures by phases.

use super::failure::Failure;
use super::phase::Phase;
use super::run::Flown;
use flight::Mode;

/// A mode in a letter.
fn letter(mode: Mode) -> char {
    match mode {
        Mode::Boot => 'B',
        Mode::Checks => 'C',
        Mode::Ready => 'R',
        Mode::MotorTest => 'M',
        Mode::Idling => 'I',
        Mode::TakingOff => 'T',
        Mode::Flying => 'F',
        Mode::Holding => 'H',
        Mode::Landing => 'L',
        Mode::Descending => 'D',
        Mode::Stopped => 'S',
        Mode::Locked => 'K',
    }
}

/// The way that a flight took after its failure, a letter a mode, what happened disarmed left out; and when motors
/// stopped, s.
fn way(flown: &Flown) -> String {
    let mut modes: Vec<Mode> = Vec::new();
    let mut off = None;
    for (transition, since) in &flown.path {
        let turns = transition.to.is_armed() || transition.to == Mode::MotorTest;
        if modes.is_empty() {
            modes.push(transition.from);
        }
        modes.push(transition.to);
        if !turns {
            off = Some(since);
            break;
        }
    }
    let letters: String = modes.into_iter().map(letter).collect();
    match off {
        Some(off) => format!("{letters} {off:.1}"),
        None => letters,
    }
}

/// Prints single failures: a row a failure, a column a phase.
pub fn print(flown: &[Flown]) {
    println!(
        "from the failure on: modes, and when the motors stopped, s; Boot Checks Ready MotorTest Idling TakingOff"
    );
    println!("Flying Holding Landing Descending Stopped locKed");
    print!("{:18}", "");
    Phase::ALL.iter().for_each(|phase| print!("{:>12}", format!("{phase:?}")));
    println!();
    for failure in Failure::ALL {
        print!("{:18}", format!("{failure:?}"));
        for phase in Phase::ALL {
            let found = flown.iter().find(|flown| {
                let case = &flown.case;
                case.phase == phase && case.first == failure && case.second.is_none()
            });
            print!("{:>12}", found.map_or_else(String::new, way));
        }
        println!();
    }
}
