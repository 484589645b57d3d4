//! The two forms of a rotor's thrust and torque, and mixtures of them.

use crate::{PAPER, Scenario};
use controller_core::allocation::Rotor;

const POSITIONS_AND_SPINS: &str = "
[rotors]
position = [[0.12, 0.12, 0.0], [-0.12, 0.12, 0.0], [-0.12, -0.12, 0.0], [0.12, -0.12, 0.0]]
spin = [\"cw\", \"ccw\", \"cw\", \"ccw\"]
lag = 0.02
idle = 0
";

fn read(keys: &str) -> Result<Rotor, String> {
    let scenario = Scenario::parse(&format!("{PAPER}{POSITIONS_AND_SPINS}{keys}"), "f").map_err(|error| error.what)?;
    Ok(scenario.configuration.rotors().unwrap()[0])
}

#[test]
fn thrusts_stand_in_for_unknown_speeds() {
    let rotor = read("thrust_max = 4.0\nthrust_min = 0.1\ntorque_per_thrust = 0.0244").unwrap();
    assert_eq!((rotor.thrust_min, rotor.thrust_max), (0.1, 4.0));
    assert!((rotor.speed_at(4.0) / super::NOMINAL_SPEED_RAD_PER_S as f32 - 1.0).abs() < 1e-6);
    assert!((rotor.drag_coefficient / rotor.thrust_coefficient / 0.0244 - 1.0).abs() < 1e-6);
    assert_eq!(read("thrust_max = 4\ntorque_per_thrust = 0.0244").unwrap(), Rotor { thrust_min: 0.0, ..rotor });
    // The same rotor by its speeds.
    let speeds = read("thrust_coefficient = 4e-6\ndrag_coefficient = 9.76e-8\nspeed = [0, 1000]").unwrap();
    for (one, other) in [
        (rotor.thrust_coefficient, speeds.thrust_coefficient),
        (rotor.drag_coefficient, speeds.drag_coefficient),
        (rotor.thrust_max, speeds.thrust_max),
    ] {
        assert!((one / other - 1.0).abs() < 1e-6, "{one} {other}");
    }
}

#[test]
fn each_unusable_field_is_named_with_the_reason() {
    const EITHER_FORM: &str =
        "these belong together: thrust_coefficient, drag_coefficient, speed, or thrust_max, torque_per_thrust";
    for (keys, field, words) in [
        (
            "",
            "rotors.thrust_max",
            "missing, and so is every other key that says what a rotor delivers: give thrust_coeff",
        ),
        (
            "thrust_max = 4",
            "rotors.torque_per_thrust",
            "missing, must be the propeller's drag torque over its thrust, m",
        ),
        ("torque_per_thrust = 0.02", "rotors.thrust_max", "missing, must be a number"),
        ("thrust_min = 0.1", "rotors.thrust_max", "missing, must be a number"),
        ("thrust_coefficient = 4e-6", "rotors.drag_coefficient", "missing, must be a number"),
        ("speed = [0, 1000]\nthrust_max = 4", "rotors.thrust_max", EITHER_FORM),
        ("thrust_coefficient = 4e-6\ntorque_per_thrust = 0.02", "rotors.torque_per_thrust", EITHER_FORM),
        ("thrust_coefficient = 4e-6\nthrust_min = 0", "rotors.thrust_min", "cannot stand beside thrust_coefficient"),
        ("thrust_max = 0\ntorque_per_thrust = 0.02", "rotors.thrust_max", "greater than zero, found 0"),
        ("thrust_max = -4\ntorque_per_thrust = 0.02", "rotors.thrust_max", "greater than zero, found -4"),
        ("thrust_max = 2e6\ntorque_per_thrust = 0.02", "rotors.thrust_max", "below 1000000, found 2000000"),
        ("thrust_max = 1\ntorque_per_thrust = 0.02", "rotors.thrust_max", "cannot hover: must let the rotors' thrust"),
        ("thrust_max = 1\ntorque_per_thrust = 0.02", "rotors.thrust_max", "above 4.5126004 N, found 1 N: 0 to 4 N"),
        ("thrust_max = 4\nthrust_min = 2\ntorque_per_thrust = 0.02", "rotors.thrust_min", "cannot hover"),
        ("thrust_max = 4\nthrust_min = 4\ntorque_per_thrust = 0.02", "rotors.thrust_min", "must be below 4, found 4"),
        ("thrust_max = 4\nthrust_min = -1\ntorque_per_thrust = 0.02", "rotors.thrust_min", "not be negative, found -1"),
        ("thrust_max = 4\ntorque_per_thrust = 0", "rotors.torque_per_thrust", "greater than zero, found 0"),
        ("thrust_max = 4\ntorque_per_thrust = 200", "rotors.torque_per_thrust", "below 100, found 200"),
        ("thrust_max = 4\ntorque_per_thrust = nan", "rotors.torque_per_thrust", "finite"),
        ("thrust_max = 4\ntorque_per_thrst = 0.02", "rotors.torque_per_thrst", "did you mean \"torque_per_thrust\"?"),
    ] {
        let what = read(keys).err().unwrap_or_else(|| panic!("{keys} was accepted"));
        assert!(what.starts_with(&format!("{field}: ")) && what.contains(words), "{keys}: {what}");
        assert_eq!(what.lines().count(), 1, "{what}");
    }
}
