//! Numbers in other units than the file's, and the vehicles that must pass.

use crate::Scenario;
use crate::section::MISSING;
use std::path::Path;

/// A quadrotor of 0.62 kg; each line can be replaced.
const QUADROTOR: &str = "name = \"quadrotor\"
[vehicle]
mass = 0.62
inertia = [0.0025, 0.0029, 0.0048]
[rotors]
position = [[0.08, 0.08, 0.0], [0.08, -0.08, 0.0], [-0.08, -0.08, 0.0], [-0.08, 0.08, 0.0]]
spin = [\"cw\", \"ccw\", \"cw\", \"ccw\"]
thrust_max = 11.0
torque_per_thrust = 0.013
lag = 0.025
";

/// The same with rotors by their speeds.
fn by_speeds() -> String {
    let speeds = "thrust_coefficient = 1.1e-5\ndrag_coefficient = 1.43e-7\nspeed = [0.0, 1000.0]";
    changed(&changed(QUADROTOR, "thrust_max", speeds), "torque_per_thrust", "")
}

/// `text` with another line in place of that of `key`.
fn changed(text: &str, key: &str, line: &str) -> String {
    let found = text.lines().find(|line| line.starts_with(key)).unwrap();
    text.replacen(found, line, 1)
}

fn read(text: &str) -> Result<Scenario, String> {
    Scenario::parse(text, "f").map_err(|error| error.what)
}

fn assert_refused(text: &str, field: &str, words: &[&str]) {
    let refused = read(text).err().unwrap_or_else(|| panic!("is read: {text}"));
    assert!(refused.starts_with(&format!("{field}: ")), "{field}: {refused}");
    for word in words {
        assert!(refused.contains(word), "{word}: {refused}");
    }
    assert!(refused.lines().count() == 1 && !refused.contains("gains."), "{refused}");
}

#[test]
fn each_slip_of_units_is_refused_with_the_value_that_would_be_right() {
    const INERTIA_LIST: &str = "[0.0025, 0.0029, 0.0048]";
    for (line, field, words) in [
        ("inertia = [25000, 29000, 48000]", "vehicle.inertia", ["in g cm^2", INERTIA_LIST]),
        ("inertia = [2500, 2900, 4800]", "vehicle.inertia", ["in kg mm^2", INERTIA_LIST]),
        ("inertia = [25, 29, 48]", "vehicle.inertia", ["in kg cm^2", INERTIA_LIST]),
        ("inertia = [2.5, 2.9, 4.8]", "vehicle.inertia", ["in g m^2", INERTIA_LIST]),
        ("inertia = [2.5e6, 2.9e6, 4.8e6]", "vehicle.inertia", ["in g mm^2", INERTIA_LIST]),
        ("mass = 620.0", "rotors.thrust_max", ["cannot hover", "if vehicle.mass is in g, write 0.62"]),
        (
            "position = [[80, 80, 0], [80, -80, 0], [-80, -80, 0], [-80, 80, 0]]",
            "rotors.position",
            ["in mm", "[[0.08,"],
        ),
        ("position = [[8, 8, 0], [8, -8, 0], [-8, -8, 0], [-8, 8, 0]]", "rotors.position", ["in cm", "[[0.08, 0.08"]),
        ("thrust_max = 1100", "rotors.thrust_max", ["in grams-force", "write 10.78"]),
        ("thrust_max = 1.1", "rotors.thrust_max", ["in kilograms-force", "write 10.78"]),
        ("torque_per_thrust = 13", "rotors.torque_per_thrust", ["in mm", "write 0.013"]),
        ("torque_per_thrust = 1.3", "rotors.torque_per_thrust", ["in cm", "write 0.013"]),
        ("lag = 25", "rotors.lag", ["from 0 to 1 s", "in ms, write 0.025"]),
    ] {
        let (key, _) = line.split_once(" = ").unwrap();
        assert_refused(&changed(QUADROTOR, key, line), field, &words);
    }
    assert_refused(
        &changed(&by_speeds(), "speed", "speed = [0, 9549]"),
        "rotors.speed",
        &["in rpm, write [0.0, 999.96"],
    );
    let per_rpm = changed(&by_speeds(), "thrust_coefficient", "thrust_coefficient = 1.206e-7");
    let per_rpm = changed(&per_rpm, "drag_coefficient", "drag_coefficient = 1.568e-9");
    let words = ["cannot hover", "if rotors.thrust_coefficient is in N/rpm^2 (and drag", "write 1.0997"];
    assert_refused(&per_rpm, "rotors.speed", &words);
}

#[test]
fn sizes_that_no_vehicle_has_are_refused_without_a_guess_where_no_slip_explains_them() {
    for (line, field) in [
        ("position = [[5e-3, 0, 0], [0, 5e-3, 0], [-5e-3, 0, 0], [0, -5e-3, 0]]", "rotors.position"),
        ("position = [[50, 0, 0], [0, 50, 0], [-50, 0, 0], [0, -50, 0]]", "rotors.position"),
        ("inertia = [1e-9, 1e-9, 1.5e-9]", "vehicle.inertia"),
        ("torque_per_thrust = 1.43e-7", "rotors.torque_per_thrust"),
    ] {
        let (key, _) = line.split_once(" = ").unwrap();
        assert_refused(&changed(QUADROTOR, key, line), field, &["no vehicle has this"]);
    }
}

#[test]
fn a_vehicle_without_rotors_has_an_inertia_of_its_mass_too() {
    let paper = |inertia: &str| crate::PAPER.replace("inertia = [2.24e-3, 2.9e-3, 5.3e-3]", inertia);
    assert_eq!(read(&paper("inertia = [2.24e-3, 2.9e-3, 5.3e-3]")).unwrap().unusual, Vec::<String>::new());
    assert_refused(&paper("inertia = [22400, 29000, 53000]"), "vehicle.inertia", &["in g cm^2", "0.00224"]);
    assert_refused(&paper("inertia = [2.24, 2.9, 5.3]"), "vehicle.inertia", &["in g m^2", "0.00224"]);
}

#[test]
fn limits_of_a_vehicle_without_rotors_are_in_newtons_and_newton_metres() {
    let paper = |from: &str, to: &str| {
        assert!(crate::PAPER.contains(from));
        crate::PAPER.replace(from, to)
    };
    let grams = paper("thrust_max = 7.0", "thrust_max = 714");
    assert_refused(&grams, "limits.thrust_max", &["158 times the weight", "in grams-force, write 7.00"]);
    let thousandths = paper("torque_max = [0.5, 0.5, 0.5]", "torque_max = [500, 500, 500]");
    assert_refused(&thousandths, "limits.torque_max", &["in mN m, write [0.5, 0.5, 0.5]"]);
    // What is not a number is named as well.
    for wrong in ["thrust_max = nan", "thrust_max = \"7\"", "thrust_max = -7"] {
        assert!(!read(&paper("thrust_max = 7.0", wrong)).err().unwrap().contains("weight"), "{wrong}");
    }
}

#[test]
fn what_is_unusual_but_possible_is_read_and_said() {
    for (line, words) in [
        ("inertia = [0.02, 0.02, 0.03]", "vehicle.inertia makes a radius of gyration"),
        ("thrust_max = 44.0", "rotors.thrust_max makes a thrust of all rotors together of 28.9 times"),
        ("torque_per_thrust = 0.1", "rotors.torque_per_thrust makes a yaw torque of 0.1 N m"),
        ("lag = 0", "rotors.lag is 0 s: rotors that respond at once"),
        ("lag = 0.3", "rotors.lag is 0.3 s, where"),
    ] {
        let (key, _) = line.split_once(" = ").unwrap();
        let unusual = read(&changed(QUADROTOR, key, line)).unwrap().unusual;
        assert!(unusual.len() == 1 && unusual[0].contains(words), "{line}: {unusual:?}");
    }
    let rpm = by_speeds().replace("1.1e-5", "1.2e-7").replace("1.43e-7", "1.6e-9").replace("1000.0]", "9549.3]");
    let unusual = read(&rpm).unwrap().unusual;
    assert!(unusual.len() == 1 && unusual[0].contains("if it is in rpm"), "{unusual:?}");
    assert_eq!(read(QUADROTOR).unwrap().unusual, Vec::<String>::new());
    assert_eq!(read(&by_speeds()).unwrap().unusual, Vec::<String>::new());
}

#[test]
fn a_missing_lag_is_no_zero() {
    assert_refused(&changed(QUADROTOR, "lag", ""), "rotors.lag", &["missing", "begin with 0.03", "docs/identify.md"]);
    let marked = format!("lag = \"{MISSING}\"");
    assert_refused(&changed(QUADROTOR, "lag", &marked), "rotors.lag", &["marked \"missing\""]);
}

#[test]
fn published_vehicles_are_usual_but_for_simulators_that_know_no_lag() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vehicles");
    let mut read = 0;
    for folder in [folder.join("published"), folder] {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "toml") {
                let unusual = Scenario::load(&path).unwrap_or_else(|error| panic!("{error}")).unusual;
                assert!(unusual.iter().all(|unusual| unusual.starts_with("rotors.lag is 0")), "{path:?}: {unusual:?}");
                read += 1;
            }
        }
    }
    assert!(read >= 18, "{read}");
}
