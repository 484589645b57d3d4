//! RotorPy's dictionary of a vehicle, from its Python file or as JSON.
//!
//! Its frames are ours. `Ixy`, `Ixz`, `Iyz` are elements of the matrix. `rotor_directions` is the sign of each rotor's
//! torque about z: 1 for a rotor that turns clockwise seen from above.

use super::literal::assignments;
use super::numbers::{Actuation, RotorNumbers, Thrust, VehicleNumbers};
use super::rigid::inertia;
use super::value::Value;
use controller_core::allocation::Spin;
use nalgebra::Vector3;

/// A key that every such dictionary has.
const MARK_KEY: &str = "rotor_pos";
/// What RotorPy calls its dictionaries.
const USUAL_NAME: &str = "quad_params";

/// Reads a Python file.
///
/// # Errors
/// Names the line, or the key of the dictionary.
pub fn read(text: &str) -> Result<VehicleNumbers, String> {
    let assigned = assignments(text);
    let is_vehicle = |value: &Result<Value, String>| value.as_ref().is_ok_and(|value| value.get(MARK_KEY).is_some());
    let vehicles: Vec<_> = assigned.iter().filter(|(_, value)| is_vehicle(value)).collect();
    let usual = vehicles.iter().find(|(name, _)| name == USUAL_NAME);
    match (usual, vehicles.as_slice()) {
        (Some((name, Ok(value))), _) | (None, [(name, Ok(value))]) => of_dictionary(value, name),
        (None, []) => {
            // Whatever could not be worked out is why.
            let refused = assigned.into_iter().find_map(|(name, value)| Some(format!("{name}: {}", value.err()?)));
            Err(refused.unwrap_or_else(|| format!("no dictionary with {MARK_KEY:?} is assigned in it")))
        }
        (_, several) => {
            let names: Vec<&str> = several.iter().map(|(name, _)| name.as_str()).collect();
            Err(format!("has several vehicles, {}: leave one, or call it {USUAL_NAME}", names.join(", ")))
        }
    }
}

/// Reads JSON.
///
/// # Errors
/// Names the place, or the key of the dictionary.
pub fn read_json(text: &str) -> Result<VehicleNumbers, String> {
    let json = serde_json::from_str(text).map_err(|error| format!("not JSON: {error}"))?;
    of_dictionary(&Value::of_json(json), "JSON")
}

/// The vehicle of a dictionary called `name`.
///
/// # Errors
/// Names the key.
pub fn of_dictionary(dictionary: &Value, name: &str) -> Result<VehicleNumbers, String> {
    let Value::Dictionary(_) = dictionary else { return Err(format!("{name}: must be a dictionary")) };
    let number = |key: &str| dictionary.get(key).map(|value| finite(key, value)).transpose();
    let or_zero = |key: &str| number(key).map(Option::unwrap_or_default);
    let [xx, yy, zz] = ["Ixx", "Iyy", "Izz"].map(number);
    let products = [or_zero("Ixy")?, or_zero("Ixz")?, or_zero("Iyz")?];
    let moments = xx?.zip(yy?).zip(zz?);
    let position = dictionary.get(MARK_KEY).map(positions).transpose()?;
    let spin = dictionary.get("rotor_directions").map(spins).transpose()?;
    let count = number("num_rotors")?;
    for (key, found) in [(MARK_KEY, position.as_ref().map(Vec::len)), ("rotor_directions", spin.as_ref().map(Vec::len))]
    {
        if let (Some(count), Some(found)) = (count, found)
            && count != found as f64
        {
            return Err(format!("{key}: must have one element for each of num_rotors = {count}, found {found}"));
        }
    }
    let speed = number("rotor_speed_min")?.zip(number("rotor_speed_max")?);
    let thrust = Thrust::BySpeed {
        thrust_coefficient: number("k_eta")?,
        drag_coefficient: number("k_m")?,
        speed: speed.map(|(least, greatest)| [least, greatest]),
    };
    let rotors = RotorNumbers { position, spin, thrust, lag: number("tau_m")? };
    let mut vehicle = VehicleNumbers::new(format!("RotorPy's dictionary ({name})"), Actuation::Rotors(rotors));
    vehicle.mass = number("mass")?;
    vehicle.inertia = moments.map(|((xx, yy), zz)| inertia([xx, yy, zz, products[0], products[1], products[2]]));
    vehicle.drag.frame = Vector3::new(or_zero("c_Dx")?, or_zero("c_Dy")?, or_zero("c_Dz")?);
    vehicle.drag.rotor_across = or_zero("k_d")?;
    vehicle.drag.rotor_along = or_zero("k_z")?;
    vehicle.drag.translational_lift = or_zero("k_h")?;
    vehicle.drag.flapping = or_zero("k_flap")?;
    Ok(vehicle)
}

fn finite(key: &str, value: &Value) -> Result<f64, String> {
    match value {
        Value::Number(number) if number.is_finite() => Ok(*number),
        Value::Number(number) => Err(format!("{key}: must be a finite number, found {number}")),
        _ => Err(format!("{key}: must be a number")),
    }
}

fn positions(value: &Value) -> Result<Vec<Vector3<f64>>, String> {
    let each: Vec<&Value> = match value {
        Value::Dictionary(entries) => entries.iter().map(|(_, position)| position).collect(),
        Value::List(positions) => positions.iter().collect(),
        _ => return Err(format!("{MARK_KEY}: must be a dictionary of positions [x, y, z]")),
    };
    let position = |(index, value): (usize, &Value)| {
        let place = format!("{MARK_KEY}, position {}", index + 1);
        match value {
            Value::List(list) if list.len() == 3 => {
                let [x, y, z] = [0, 1, 2].map(|axis| finite(&place, &list[axis]));
                Ok(Vector3::new(x?, y?, z?))
            }
            _ => Err(format!("{place}: must be three numbers")),
        }
    };
    each.into_iter().enumerate().map(position).collect()
}

fn spins(value: &Value) -> Result<Vec<Spin>, String> {
    const DIRECTIONS_REFUSAL: &str = "rotor_directions: must be a list of 1 (clockwise) and -1 (counter-clockwise)";
    let Value::List(directions) = value else { return Err(DIRECTIONS_REFUSAL.to_owned()) };
    let spin = |value: &Value| match value {
        Value::Number(1.0) => Ok(Spin::Clockwise),
        Value::Number(-1.0) => Ok(Spin::CounterClockwise),
        _ => Err(DIRECTIONS_REFUSAL.to_owned()),
    };
    directions.iter().map(spin).collect()
}
