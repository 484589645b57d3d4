//! The rotor geometry of a PX4 vehicle: `CA_ROTOR…` parameters, of an airframe script (`param set-default NAME VALUE`)
//! or of a parameter file as QGroundControl saves it (vehicle, component, name, value, type).
//!
//! PX4's body axes are x forward, y right, z down: y and z change their signs. `CA_ROTORi_KM` is positive for a rotor
//! that turns counter-clockwise; left out it is 0.05. Positions and spins are all that is taken: PX4 needs neither mass
//! nor thrust, and its coefficients `CT` and `KM` count only in proportion to each other, so they are not measured as a
//! rule.

use super::numbers::{Actuation, RotorNumbers, Thrust, VehicleNumbers};
use controller_core::allocation::Spin;
use nalgebra::Vector3;
use std::collections::HashMap;

const ROTOR_PARAMETER_PREFIX: &str = "CA_ROTOR";
/// PX4's `CA_ROTORi_KM` where it is left out.
const DEFAULT_KM: f64 = 0.05;
/// As PX4 has it.
const ROTORS_MAX: f64 = 12.0;

/// Reads an airframe script or a parameter file.
///
/// # Errors
/// Names the line or the parameter.
pub fn read(text: &str) -> Result<VehicleNumbers, String> {
    let parameters = parameters(text)?;
    let known = |name: &str| parameters.get(name).copied();
    let count = match known("CA_ROTOR_COUNT") {
        Some(count) if count.fract() == 0.0 && (1.0..=ROTORS_MAX).contains(&count) => count as usize,
        Some(count) => {
            return Err(format!("CA_ROTOR_COUNT: must be a whole number from 1 to {ROTORS_MAX}, found {count}"));
        }
        None => return Err("CA_ROTOR_COUNT: missing: without it PX4 has no rotors; add how many there are".to_owned()),
    };
    let mut position = Vec::new();
    let mut spin = Vec::new();
    for index in 0..count {
        let of =
            |what: &str, otherwise: f64| known(&format!("{ROTOR_PARAMETER_PREFIX}{index}_{what}")).unwrap_or(otherwise);
        let axis = Vector3::new(of("AX", 0.0), of("AY", 0.0), of("AZ", -1.0));
        if !(axis.z < 0.0 && axis.xy().norm() <= 1e-3 * axis.norm()) {
            return Err(format!(
                "{ROTOR_PARAMETER_PREFIX}{index}_AX, _AY, _AZ: must point up, (0, 0, -1), found ({}, {}, {}): rotors push along body \
                 z, and a tilted one cannot be described",
                axis.x, axis.y, axis.z
            ));
        }
        if of("PX", 0.0) == 0.0 && of("PY", 0.0) == 0.0 {
            return Err(format!(
                "{ROTOR_PARAMETER_PREFIX}{index}_PX, _PY: missing: CA_ROTOR_COUNT says {count} rotors, and rotor {index} has no place: \
                 add it, or set CA_ROTOR_COUNT to the rotors that are there"
            ));
        }
        position.push(Vector3::new(of("PX", 0.0), 0.0 - of("PY", 0.0), 0.0 - of("PZ", 0.0)));
        spin.push(match of("KM", DEFAULT_KM) {
            km if km > 0.0 => Spin::CounterClockwise,
            km if km < 0.0 => Spin::Clockwise,
            _ => {
                return Err(format!(
                    "{ROTOR_PARAMETER_PREFIX}{index}_KM: must not be zero: its sign says which way the rotor turns"
                ));
            }
        });
    }
    let thrust = Thrust::Greatest { thrust_min: 0.0, thrust_max: None, torque_per_thrust: None };
    let rotors = RotorNumbers { position: Some(position), spin: Some(spin), thrust, lag: None };
    let mut vehicle = VehicleNumbers::new("PX4 parameters: rotor geometry alone", Actuation::Rotors(rotors));
    vehicle.notes.push(("rotors.position", "turned from PX4's forward, right, down to forward, left, up".to_owned()));
    if let Some(km) = known("CA_ROTOR0_KM") {
        let note = format!("CA_ROTOR0_KM is {km}: PX4 flies with any value, so it is taken for its sign alone");
        vehicle.notes.push(("rotors.torque_per_thrust", note));
    }
    Ok(vehicle)
}

/// Every `CA_ROTOR…` parameter; the last line of a name counts, as in a script. A parameter file may hold those of
/// several vehicles and components, which must not be mixed.
fn parameters(text: &str) -> Result<HashMap<&str, f64>, String> {
    let mut found = HashMap::new();
    let mut owner: Option<[&str; 2]> = None;
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let mut words = line.split_whitespace().skip_while(|word| !word.starts_with(ROTOR_PARAMETER_PREFIX));
        let before: Vec<&str> =
            line.split_whitespace().take_while(|word| !word.starts_with(ROTOR_PARAMETER_PREFIX)).collect();
        let Some(name) = words.next() else { continue };
        let value = words.next().unwrap_or_default();
        let number = value.parse().ok().filter(|number: &f64| number.is_finite());
        let shown: String = value.chars().take(40).collect();
        let place = || format!("line {}: {}", index + 1, name.chars().take(40).collect::<String>());
        let number = number.ok_or_else(|| format!("{}: must be a finite number, found {shown:?}", place()))?;
        if let [vehicle, component] = before[..]
            && before.iter().all(|word| word.parse::<u8>().is_ok())
        {
            let first = *owner.get_or_insert([vehicle, component]);
            if first != [vehicle, component] {
                return Err(format!(
                    "{}: is of vehicle {vehicle}, component {component}, and others above are of vehicle {}, component \
                     {}: keep the lines of one",
                    place(),
                    first[0],
                    first[1]
                ));
            }
        }
        found.insert(name, number);
    }
    Ok(found)
}
