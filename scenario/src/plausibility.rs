//! Whether a vehicle's numbers can be those of a multirotor: what is impossible is refused, what is unusual is said.
//!
//! No proof notices an inertia in g cm^2: the certificate holds for the vehicle that the file describes. But the
//! numbers of one vehicle belong together, whatever its size:
//!
//! | quantity | unit | usual | possible |
//! |---|---|---|---|
//! | longest arm, per cube root of the mass | m/kg^(1/3) | 0.06 to 0.6 | 0.02 to 2 |
//! | maximum radius of gyration sqrt(J / m), per longest arm | | 0.12 to 1.25 | 0.03 to 2 |
//! | the same without rotors, per 0.2 m/kg^(1/3) times the cube root of the mass | | 0.12 to 2.5 | 0.003 to 20 |
//! | without rotors: maximum thrust, per weight | | at most 20 | at most 50 |
//! | without rotors: maximum torque limit, per maximum moment of inertia | rad/s^2 | 0.5 to 5e3 | 0.01 to 5e4 |
//! | maximum thrust, per weight | | 1.2 to 20 | 1 to 50 |
//! | yaw torque per thrust, per longest arm | | 0.02 to 0.8 | 0.001 to 3 |
//! | maximum speed times longest arm | m/s | at most 750 | |
//! | lag | s | 0.001 to 0.15 | 0 to 1 |
//!
//! The published vehicles (`vehicles/published`) have arms of 0.11 to 0.21 m/kg^(1/3), radii of gyration of 0.3 to 1.07
//! arms, thrusts of 1.9 to 13 weights and yaw torques of 0.023 to 0.79 arms. A slip of units moves a number by 9.8 and
//! more. The one that makes all of them usual again is named with the value that would be right.

mod quantities;
mod slips;

use crate::section::{FieldError, Section};
use controller_core::allocation::Rotors;
use controller_core::vehicle::Vehicle;
use quantities::{Judged, Numbers, Range, within};
pub use slips::likely_slip;

/// Longest usual lag of rotors.
const USUAL_LAG_MAX_S: f64 = 0.15;

/// Shortest usual lag.
const USUAL_LAG_MIN_S: f64 = 0.001;

/// Refuses numbers that no vehicle has, and returns those that few have, each in a sentence.
///
/// # Errors
/// Names the field, with the slip that would explain it.
pub fn check(root: &Section, vehicle: &Vehicle, rotors: Option<&Rotors>, lag: f64) -> Result<Vec<String>, FieldError> {
    let judged = Numbers::read(root, vehicle, rotors).judged();
    let beyond = |range: fn(&Range) -> [f64; 2]| judged.iter().filter(move |j| !within(j.value, range(&j.range)));
    if let Some(Judged { field, says, .. }) = beyond(|range| range.possible).next() {
        let problem = format!("{says}: no vehicle has this{}", likely_slip(root, vehicle, rotors));
        return Err(FieldError::new(*field, problem));
    }
    let mut unusual: Vec<String> =
        beyond(|range| range.usual).map(|Judged { field, says, .. }| format!("{field} {says}")).collect();
    if let Some(last) = unusual.last_mut() {
        *last += &likely_slip(root, vehicle, rotors);
    }
    if rotors.is_some() && lag < USUAL_LAG_MIN_S {
        unusual
            .push(format!("rotors.lag is {lag} s: rotors that respond at once are some simulators', and no real ones"));
    }
    if lag > USUAL_LAG_MAX_S {
        unusual.push(format!("rotors.lag is {lag} s, where 0.005 to {USUAL_LAG_MAX_S} s are usual"));
    }
    Ok(unusual)
}

#[cfg(test)]
mod tests;
