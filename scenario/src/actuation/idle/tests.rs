//! Where the least thrust comes from, and what is said of it.

use crate::{PAPER, Scenario};

const ROTORS: &str = "
[rotors]
position = [[0.12, 0.12, 0.0], [-0.12, 0.12, 0.0], [-0.12, -0.12, 0.0], [0.12, -0.12, 0.0]]
spin = [\"cw\", \"ccw\", \"cw\", \"ccw\"]
lag = 0.02
";
const SPEEDS: &str = "thrust_coefficient = 4e-6\ndrag_coefficient = 9.76e-8\nspeed = [0, 1000]\n";
const THRUSTS: &str = "thrust_max = 4.0\ntorque_per_thrust = 0.0244\n";

fn scenario(keys: &str) -> Result<Scenario, String> {
    Scenario::parse(&format!("{PAPER}{ROTORS}{keys}"), "f").map_err(|error| error.what)
}

/// Least thrust of the rotors, N, and what `certify` and others say.
fn read(keys: &str) -> (f32, String, Option<String>) {
    let scenario = scenario(keys).unwrap();
    let least = scenario.least_command.unwrap();
    let rotors = scenario.configuration.rotors().unwrap();
    assert!(rotors.iter().all(|rotor| rotor.thrust_min == least.thrust_min), "{keys}");
    (least.thrust_min, least.to_string(), least.doubt())
}

#[test]
fn without_a_word_the_least_thrust_is_that_of_what_motor_controllers_hold() {
    for keys in [SPEEDS, THRUSTS] {
        let (thrust, says, _) = read(keys);
        assert!((thrust - 4.0 * 0.06875 * 0.06875).abs() < 1e-6, "{keys}: {thrust}");
        assert_eq!(
            says,
            "at least 6.9 % of a full command, 0.0189 N each: rotors.idle = 0.055 (default) with a battery 25 % above \
             nominal"
        );
    }
}

#[test]
fn the_greater_of_idle_and_the_files_range_counts() {
    let (thrust, says, doubt) = read(&format!("{THRUSTS}thrust_min = 0.1"));
    assert_eq!((thrust, doubt), (0.1, None));
    assert_eq!(says, "at least 15.8 % of a full command, 0.1000 N each: rotors.thrust_min");
    let (thrust, says, doubt) = read(&format!("{THRUSTS}thrust_min = 0.1\nidle = 0.2"));
    assert!((thrust - 0.25).abs() < 1e-6 && doubt.is_none(), "{thrust}");
    assert!(says.starts_with("at least 25.0 % of a full command, 0.2500 N each: rotors.idle = 0.2 with"), "{says}");
    // The range alone, where the user says so.
    let (thrust, says, _) = read(&format!("{SPEEDS}idle = 0"));
    assert_eq!((thrust, says.as_str()), (0.0, "at least 0.0 % of a full command, 0.0000 N each: rotors.speed"));
}

#[test]
fn a_straighter_curve_pushes_more_at_idle() {
    let (thrust, _, _) = read(&format!("{THRUSTS}thrust_curve = 0.3"));
    assert!((thrust - 4.0 * (0.3 * 0.06875 + 0.7 * 0.06875 * 0.06875)).abs() < 1e-6, "{thrust}");
}

#[test]
fn what_no_motor_controller_holds_is_doubted_in_one_line_with_a_remedy() {
    assert_eq!(read(THRUSTS).2, None);
    assert_eq!(read(&SPEEDS.replace("[0,", "[100,")).2, None);
    let zero = read(SPEEDS).2.unwrap();
    assert_eq!(
        zero,
        "rotors.speed begins at 0, where no motor turns: idle = 0.055 raises it to 6.9 % of a full command, 0.019 N; \
         measure the lowest at which the motor turns reliably (docs/thrust-stand.md) and write it there"
    );
    assert!(read(&format!("{THRUSTS}thrust_min = 0")).2.unwrap().starts_with("rotors.thrust_min begins at 0"));
    for keys in [format!("{SPEEDS}idle = 0.02"), format!("{THRUSTS}idle = 0.0")] {
        let low = read(&keys).2.unwrap();
        assert!(low.starts_with("rotors.idle is 0") && low.contains("motors may stall below 0.055"), "{low}");
    }
    // A file whose range is above that may say what it wants of idle.
    assert_eq!(read(&format!("{THRUSTS}thrust_min = 0.1\nidle = 0.01")).2, None);
}

#[test]
fn idles_that_cannot_be_are_refused_by_name() {
    for (keys, refused) in [
        ("idle = 0.31", "rotors.idle: must be from 0 to 0.3, found 0.31"),
        ("idle = -0.1", "rotors.idle: must be from 0 to 0.3, found -0.1"),
        ("thrust_curve = 1.1", "rotors.thrust_curve: must be from 0 to 1, found 1.1"),
        (
            "idle = 0.3\nthrust_curve = 1",
            "rotors.idle: lifts the vehicle: the rotors' least thrusts together must be below",
        ),
    ] {
        let what = scenario(&format!("{THRUSTS}{keys}")).err().unwrap_or_else(|| panic!("{keys} was accepted"));
        assert!(what.starts_with(refused), "{keys}: {what}");
    }
    let what = scenario("idle = 0.3\nthrust_curve = 1\nthrust_max = 3.2\ntorque_per_thrust = 0.02").err().unwrap();
    assert!(what.contains("found 4.8") && what.contains("idle = 0.3 and thrust_curve = 1; lower it"), "{what}");
}
