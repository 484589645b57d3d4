//! `[rotors]` and `[sampling]` as users may write them, and as they must not.

use super::*;
use crate::verdict::Verdict;
use crate::{PAPER, Scenario};
use controller_core::allocation::Mixer;
use controller_core::state::Wrench;
use nalgebra::Vector3;

const ROTORS_SECTION: &str = "
[rotors]
position = [[0.12, 0.12, 0.0], [-0.12, 0.12, 0.0], [-0.12, -0.12, 0.0], [0.12, -0.12, 0.0]]
spin = [\"cw\", \"ccw\", \"cw\", \"ccw\"]
thrust_coefficient = 5.57e-6
drag_coefficient = 1.36e-7
speed = [100, 1500.0]
lag = 0.005
idle = 0

[sampling]
delay = 0.01
";

fn read(sections: &str) -> Result<Scenario, String> {
    Scenario::parse(&format!("{PAPER}{sections}"), "f").map_err(|error| error.what)
}

#[test]
fn rotors_and_delay_become_what_the_file_says() {
    let scenario = read(ROTORS_SECTION).unwrap();
    let rotors = scenario.configuration.rotors().unwrap();
    assert_eq!((rotors.len(), scenario.rotor_lag, scenario.delay_steps), (4, 0.005, 10));
    assert_eq!(rotors[1].position, Vector3::new(-0.12, 0.12, 0.0));
    assert_eq!((rotors[0].spin, rotors[1].spin), (Spin::Clockwise, Spin::CounterClockwise));
    assert!((rotors[2].thrust_min - 0.0557).abs() < 1e-6 && (rotors[2].thrust_max - 12.5325).abs() < 1e-5);
    assert!(!scenario.is_papers());
}

#[test]
fn left_out_there_are_neither_rotors_nor_delay() {
    let scenario = read("").unwrap();
    assert!(scenario.configuration.rotors().is_none() && scenario.rotor_lag == 0.0 && scenario.delay_steps == 0);
    assert_eq!(read("[sampling]").unwrap().delay_steps, 0);
}

#[test]
fn each_unusable_field_is_named_with_the_reason() {
    let three = "position = [[0.12, 0.12, 0.0], [-0.12, 0.12, 0.0], [-0.12, -0.12, 0.0]]";
    let aligned = "position = [[0.12, 0.0, 0.0], [-0.12, 0.0, 0.0], [-0.12, 0.0, 0.0], [0.12, 0.0, 0.0]]";
    for (line, replacement, field, words) in [
        ("position", "", "rotors.position", "missing, must be a list of positions"),
        ("position", "position = 4", "rotors.position", "must be a list"),
        ("position", "position = [[0.1, 0.1], [0, 0, 0], [0, 0, 0], [0, 0, 0]]", "rotors.position[0]", "three numbers"),
        ("position", "position = [[0.1, nan, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]", "rotors.position[0][1]", "finite"),
        ("position", three, "rotors.spin", "one element for each of 3 positions, found 4"),
        ("position", aligned, "rotors.position", "cannot produce thrust and all three torques"),
        ("spin", "spin = [\"cw\", \"cw\", \"cw\", \"cw\"]", "rotors.spin", "all rotors turn the same way"),
        (
            "spin",
            "spin = [\"cw\", \"cw\", \"ccw\", \"ccw\"]",
            "rotors.spin",
            "rotors 1 and 2, which are neighbours, turn the same way, so that yaw comes with roll or pitch; neighbours \
             must turn opposite ways: at these positions [\"cw\", \"ccw\", \"cw\", \"ccw\"] can yaw",
        ),
        ("spin", "spin = [\"cw\", \"left\", \"cw\", \"ccw\"]", "rotors.spin[1]", "\"cw\" or \"ccw\""),
        ("spin", "spin = [\"cw\", \"ccw\"]", "rotors.spin", "found 2"),
        ("thrust_coefficient", "thrust_coefficient = 0.0", "rotors.thrust_coefficient", "greater than zero, found 0"),
        ("thrust_coefficient", "thrust_coefficent = 1e-6", "rotors.thrust_coefficent", "did you mean \"thrust_coeffic"),
        ("drag_coefficient", "drag_coefficient = -1e-7", "rotors.drag_coefficient", "greater than zero, found -"),
        ("drag_coefficient", "drag_coefficient = inf", "rotors.drag_coefficient", "finite"),
        ("speed", "speed = [1500.0, 100.0]", "rotors.speed", "least < greatest, found [1500.0, 100.0]"),
        ("speed", "speed = [-1, 1500.0]", "rotors.speed", "0 <= least"),
        ("speed", "speed = [100.0]", "rotors.speed", "[least, greatest]"),
        ("speed", "speed = [100.0, nan]", "rotors.speed", "[least, greatest]"),
        ("speed", "speed = [100.0, 1e30]", "rotors.speed", "must be a finite number"),
        ("speed", "speed = [0.0, 400.0]", "rotors.speed", "cannot hover: must let the rotors' thrust together reach"),
        ("speed", "speed = [500.0, 800.0]", "rotors.speed", "cannot hover"),
        ("lag", "lag = -0.005", "rotors.lag", "from 0 to 1 s, found -0.005"),
        ("lag", "lag = 5.0", "rotors.lag", "from 0 to 1 s, found 5; if it is in ms, write 0.005"),
        ("lag", "", "rotors.lag", "missing"),
        ("lag", "lagg = 0.005", "rotors.lagg", "did you mean \"lag\"?"),
        ("delay", "delay = 0.0105", "sampling.delay", "whole number of plant steps, found 0.0105 s (nearest:"),
        ("delay", "delay = -0.01", "sampling.delay", "from 0 to 1 s"),
        ("delay", "delay = 0.65", "sampling.delay", "at most 64 control periods, 0.64 s, found 0.65"),
        ("delay", "delay = nan", "sampling.delay", "finite"),
        ("delay", "dealy = 0.01", "sampling.dealy", "did you mean \"delay\"?"),
        ("[sampling]", "[samplings]", "samplings", "did you mean \"sampling\"?"),
    ] {
        assert_eq!(ROTORS_SECTION.lines().filter(|found| found.starts_with(line)).count(), 1, "{line}");
        let swap = |found| if str::starts_with(found, line) { replacement } else { found };
        let text = ROTORS_SECTION.lines().map(swap).collect::<Vec<_>>().join("\n");
        let what = read(&text).err().unwrap_or_else(|| panic!("{replacement} was accepted"));
        assert!(what.starts_with(&format!("{field}: ")) && what.contains(words), "{replacement}: {what}");
        assert_eq!(what.lines().count(), 1, "{what}");
    }
}

#[test]
fn more_than_eight_and_fewer_than_four_rotors_are_refused() {
    for (count, words) in [(3, "at least 4"), (9, "at most 8")] {
        let list = |element: &str| vec![element; count].join(", ");
        let text = format!(
            "[rotors]\nposition = [{}]\nspin = [{}]\nthrust_coefficient = 1e-6\ndrag_coefficient = 1e-7\nspeed = [0, 9]\n",
            list("[0.1, 0.1, 0.0]"),
            list("\"cw\"")
        );
        let what = read(&text).err().unwrap();
        assert!(what.starts_with("rotors: ") && what.contains(words), "{what}");
    }
}

/// Files of six to eight rotors, even ones clockwise; the coaxial have two on each arm, one above the other, that spin
/// against each other.
fn multirotors() -> [(&'static str, String); 5] {
    let ring = |count: usize, phase: f64| -> Vec<([f64; 3], usize)> {
        let angle = |k: usize| (k as f64 + phase) * std::f64::consts::TAU / count as f64;
        (0..count).map(|k| ([0.25 * angle(k).cos(), 0.25 * angle(k).sin(), 0.0], k)).collect()
    };
    let coaxial = |arms: Vec<([f64; 3], usize)>| -> Vec<([f64; 3], usize)> {
        arms.into_iter().flat_map(|([x, y, _], k)| [([x, y, 0.03], k), ([x, y, -0.03], k + 1)]).collect()
    };
    let file = |rotors: Vec<([f64; 3], usize)>| {
        let places: Vec<String> = rotors.iter().map(|(place, _)| format!("{place:?}")).collect();
        let spins = rotors.iter().map(|(_, k)| if k % 2 == 0 { "\"cw\"" } else { "\"ccw\"" }).collect::<Vec<_>>();
        let gains = &PAPER[PAPER.find("[gains]").unwrap()..PAPER.find("[control]").unwrap()];
        format!(
            "name = \"many\"\n[vehicle]\nmass = 1.5\ninertia = [0.035, 0.046, 0.08]\n{gains}\n[rotors]\n\
             position = [{}]\nspin = [{}]\nthrust_max = 6.0\nthrust_min = 0.2\n\
             torque_per_thrust = 0.016\nlag = 0.025\n",
            places.join(", "),
            spins.join(", ")
        )
    };
    [
        ("hexacopter +", file(ring(6, 0.0))),
        ("hexacopter X", file(ring(6, 0.5))),
        ("octocopter", file(ring(8, 0.5))),
        ("coaxial X8", file(coaxial(ring(4, 0.5)))),
        ("coaxial Y6", file(coaxial(ring(3, 0.0)))),
    ]
}

#[test]
fn six_to_eight_rotors_deliver_what_they_can_deliver() {
    for (name, text) in multirotors() {
        let scenario = Scenario::parse(&text, name).unwrap();
        let rotors = scenario.configuration.rotors().unwrap();
        assert_eq!(rotors.len(), if name.contains('8') || name.contains("octo") { 8 } else { 6 }, "{name}");
        let (mixer, limits) = (Mixer::new(rotors), scenario.configuration.limits());
        assert!((limits.thrust_max - 6.0 * rotors.len() as f32).abs() < 1e-4);
        let hover = Wrench { thrust: 1.5 * 9.81, torque: Vector3::zeros() };
        let given = mixer.allocate(&hover).unwrap();
        assert!(given.is_exact() && given.thrusts.iter().all(|f| (f - given.thrusts[0]).abs() < 1e-4), "{name}");
        // All patterns of rotors at a third and at two thirds of their range: every wrench among them can be had.
        for pattern in 0..1_u32 << rotors.len() {
            let thrusts: Vec<f32> = (0..rotors.len()).map(|k| if pattern >> k & 1 == 1 { 4.0 } else { 2.0 }).collect();
            let commanded = mixer.wrench(&thrusts);
            let given = mixer.allocate(&commanded).unwrap();
            let delivered = mixer.wrench(&given.thrusts);
            let error = (delivered.torque - commanded.torque).norm().max((delivered.thrust - commanded.thrust).abs());
            assert!(given.is_exact() && error < 1e-4, "{name}: {commanded:?} {delivered:?}");
        }
        // The certificate reaches every rotor, whatever it says of these gains.
        let verdict = Verdict::judge(&scenario).unwrap();
        let last = format!("rotor {}", rotors.len());
        assert!(verdict.certificate().inequalities().any(|inequality| inequality.name.contains(&last)), "{name}");
    }
}

#[test]
fn the_limits_are_the_rotors_where_the_file_has_none() {
    let (before, rest) = PAPER.split_once("[limits]").unwrap();
    let after = &rest[rest.find("\n[").unwrap()..];
    let scenario = Scenario::parse(&format!("{before}{after}{ROTORS_SECTION}"), "f").unwrap();
    let limits = scenario.configuration.limits();
    let (least, greatest) = (5.57e-6 * 100.0_f32.powi(2), 5.57e-6 * 1500.0_f32.powi(2));
    // Two rotors at their greatest thrust and two at their least.
    let tilt = 2.0 * 0.12 * (greatest - least);
    let yaw = 2.0 * 1.36e-7 / 5.57e-6 * (greatest - least);
    assert!((limits.thrust_max / (4.0 * greatest) - 1.0).abs() < 1e-5);
    let apart = (limits.torque_max - Vector3::new(tilt, tilt, yaw)).component_div(&limits.torque_max);
    assert!(apart.amax() < 1e-5, "{limits:?}");
    // One of the two keys alone.
    let thrust = Scenario::parse(&format!("{before}[limits]\nthrust_max = 9.0{after}{ROTORS_SECTION}"), "f").unwrap();
    assert_eq!(thrust.configuration.limits().thrust_max, 9.0);
    assert_eq!(thrust.configuration.limits().torque_max, limits.torque_max);
    // Not without rotors.
    for (limits, field) in
        [("", "limits"), ("[limits]\nthrust_max = 9.0", "limits.torque_max"), ("[limits]", "limits.thrust_max")]
    {
        let what = Scenario::parse(&format!("{before}{limits}{after}"), "f").err().unwrap().what;
        assert!(
            what.starts_with(&format!("{field}: missing, must be a")) && what.contains("beside [rotors]"),
            "{what}"
        );
    }
    let what =
        Scenario::parse(&format!("{before}[limits]\nthrust = 9.0{after}{ROTORS_SECTION}"), "f").err().unwrap().what;
    assert!(what.starts_with("limits.thrust: unknown key, did you mean \"thrust_max\"?"), "{what}");
}

#[test]
fn rotors_that_do_not_surround_the_centre_of_mass_are_refused() {
    let (before, rest) = PAPER.split_once("[limits]").unwrap();
    let after = &rest[rest.find("\n[").unwrap()..];
    let ahead = ROTORS_SECTION.replace("[0.12,", "[0.52,").replace("[-0.12,", "[0.28,");
    let what = Scenario::parse(&format!("{before}{after}{ahead}"), "f").err().unwrap().what;
    assert!(what.starts_with("rotors.position: ") && what.contains("must lie amid the rotors"), "{what}");
    // With limits of its own the extended law refuses it: its thrust floor could not lift the rotors behind.
    let extended = include_str!("../../../vehicles/hummingbird.toml");
    let (_, rotors) = extended.split_once("[rotors]").unwrap();
    let ahead = rotors.replacen("[0.120208, 0.120208", "[0.9, 0.120208", 1).replacen(
        "[0.120208, -0.120208",
        "[0.9, -0.120208",
        1,
    );
    let ahead = ahead.replace("[-0.120208, ", "[0.1, ");
    let what = Scenario::parse(&extended.replace(rotors, &ahead), "f").err().unwrap().what;
    assert!(what.starts_with("rotors.position: leaves rotor 1 without a share of the thrust"), "{what}");
}

#[test]
fn only_a_file_with_coefficients_knows_its_rotors_speeds() {
    let rotors = |text: &str| Scenario::parse(text, "f").unwrap().configuration.rotors().unwrap().clone();
    let by_speed = include_str!("../../../vehicles/hummingbird.toml");
    assert!(!rotors(by_speed).are_of_nominal_speed());
    let by_thrust = format!(
        "{}\n[rotors]{}",
        "name = \"mine\"\n[vehicle]\nmass = 1.28\ninertia = [0.0123, 0.0126, 0.0224]",
        "\nposition = [[0.163, 0.163, 0.0], [0.163, -0.163, 0.0], [-0.163, -0.163, 0.0], [-0.163, 0.163, 0.0]]\n\
         spin = [\"cw\", \"ccw\", \"cw\", \"ccw\"]\nthrust_max = 7.8\ntorque_per_thrust = 0.014\nlag = 0.03\n"
    );
    assert!(rotors(&by_thrust).are_of_nominal_speed());
}
