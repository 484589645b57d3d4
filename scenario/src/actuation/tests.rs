//! `[rotors]` and `[sampling]` as users may write them, and as they must not.

use super::*;
use crate::{PAPER, Scenario};
use nalgebra::Vector3;

const ROTORS: &str = "
[rotors]
position = [[0.12, 0.12, 0.0], [-0.12, 0.12, 0.0], [-0.12, -0.12, 0.0], [0.12, -0.12, 0.0]]
spin = [\"cw\", \"ccw\", \"cw\", \"ccw\"]
thrust_coefficient = 5.57e-6
drag_coefficient = 1.36e-7
speed = [100, 1500.0]
lag = 0.005

[sampling]
delay = 0.01
";

fn read(sections: &str) -> Result<Scenario, String> {
    Scenario::parse(&format!("{PAPER}{sections}"), "f").map_err(|error| error.what)
}

#[test]
fn rotors_and_delay_become_what_the_file_says() {
    let scenario = read(ROTORS).unwrap();
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
    assert_eq!(read(&ROTORS.replace("lag = 0.005", "")).unwrap().rotor_lag, 0.0);
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
        ("position", aligned, "rotors", "cannot produce thrust and all three torques"),
        ("spin", "spin = [\"cw\", \"cw\", \"cw\", \"cw\"]", "rotors", "cannot produce thrust and all three torques"),
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
        ("lag", "lag = 5.0", "rotors.lag", "from 0 to 1 s, found 5"),
        ("lag", "lagg = 0.005", "rotors.lagg", "did you mean \"lag\"?"),
        ("delay", "delay = 0.0105", "sampling.delay", "whole number of plant steps, found 0.0105 s (nearest:"),
        ("delay", "delay = -0.01", "sampling.delay", "from 0 to 1 s"),
        ("delay", "delay = 0.65", "sampling.delay", "at most 64 control periods, 0.64 s, found 0.65"),
        ("delay", "delay = nan", "sampling.delay", "finite"),
        ("delay", "dealy = 0.01", "sampling.dealy", "did you mean \"delay\"?"),
        ("[sampling]", "[samplings]", "samplings", "did you mean \"sampling\"?"),
    ] {
        assert_eq!(ROTORS.lines().filter(|found| found.starts_with(line)).count(), 1, "{line}");
        let swap = |found| if str::starts_with(found, line) { replacement } else { found };
        let text = ROTORS.lines().map(swap).collect::<Vec<_>>().join("\n");
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
