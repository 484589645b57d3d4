//! What the firmware can fly of all scenarios: 100 Hz, four rotors, and sampled loops with margin.
//!
//! The firmware's build and `host-sim sitl` ask the same question here, so that whatever flies on a desk can be built for a board.

use crate::file::Scenario;
use crate::verdict::Verdict;

/// The rate of the firmware's control task, Hz.
pub const RATE: f64 = 100.0;

/// Rotors that the boards have outputs for.
pub const ROTORS: usize = 4;

/// Whether the firmware can fly `scenario`, of the file `name`. One that is not certified it boots with, and does not arm: why, if so.
///
/// One whose sampled loops are unstable or without margin is refused: no board works that out, so nothing else would keep it on
/// the ground.
///
/// # Errors
/// One line: the file, the field or the loop, and what is wrong.
pub fn check(scenario: &Scenario, name: &str) -> Result<Option<String>, String> {
    let rate = 1.0 / scenario.timing.period();
    if (rate - RATE).abs() > 1e-9 {
        return Err(format!("{name}: control.rate: the firmware flies at {RATE} Hz, found {rate}"));
    }
    let Some(rotors) = scenario.configuration.rotors() else {
        return Err(format!("{name}: rotors: missing; a board needs to know what its {ROTORS} motors turn"));
    };
    if rotors.len() != ROTORS {
        return Err(format!("{name}: rotors.position: the boards drive {ROTORS} motors, found {}", rotors.len()));
    }
    let verdict = Verdict::of(scenario).map_err(|error| format!("{name}: {error}"))?;
    if let Some(lack) = verdict.lacking() {
        return Err(format!("{name}: {lack}; what cannot be flown is not built"));
    }
    Ok(verdict.refusal().map(|refusal| format!("{name}: {refusal}; this firmware will refuse to arm")))
}
