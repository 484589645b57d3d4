//! Vehicles from the files of other programs: each format becomes a file that is certified and flies upside down back
//! to hover; what a source lacks is marked and refused; nonsense is refused by its place. The files in
//! `tests/numbers/vehicle_import/` are of these formats, with the numbers that their projects publish.

use crate::support::binary::{self, files, host_sim, status, stderr, stdout};
use crate::support::random;
use host_sim::flight::tasks::recovery;
use host_sim::identification::import::written::{Wishes, written};
use host_sim::identification::import::{Format, read};
use rand::RngExt;
use scenario::Scenario;
use std::fs;
use std::path::{Path, PathBuf};

const LAG_SETTING: &str = "rotors.lag=0.05";

fn source(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/numbers/vehicle_import").join(name)
}

/// What the program makes of a source in a directory of its own: its status, what it says, and the directory.
fn imported(test: &str, source: &Path, more: &[&str]) -> (i32, String, PathBuf) {
    let directory = binary::directory("vehicle_import", test);
    let asked = [&["vehicle", source.to_str().unwrap(), "--out", "mine.toml"], more].concat();
    let output = host_sim(&directory, &asked);
    (status(&output), stdout(&output) + &stderr(&output), directory)
}

/// The scenario of a source, with numbers of one's own.
fn scenario(name: &str, given: &[(&str, &str)]) -> Scenario {
    let path = source(name);
    let vehicle = read(&fs::read_to_string(&path).unwrap(), &path, None).unwrap();
    let given = given.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let wishes = Wishes { given, neglect_products: false };
    Scenario::parse(&written(&vehicle, "read", name, &wishes).unwrap().text, name).unwrap()
}

fn published(name: &str) -> Scenario {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vehicles/published");
    Scenario::load(&folder.join(name).with_extension("toml")).unwrap()
}

#[test]
fn every_format_becomes_a_vehicle_that_is_judged_and_comes_back_from_upside_down_where_it_can() {
    let alternate = "rotors.spin=[\"ccw\", \"cw\", \"ccw\", \"cw\"]";
    let measured = ["vehicle.mass=2.064", "vehicle.inertia=[0.0217, 0.0217, 0.04]", "rotors.thrust_max=8.5"];
    let px4 = [&measured[..], &["rotors.torque_per_thrust=0.016", LAG_SETTING]].concat();
    let with = |given: &[&'static str]| given.iter().flat_map(|given| ["--with", given]).collect::<Vec<_>>();
    for (name, format, more) in [
        ("crazyflie.py", "rotorpy", vec![]),
        ("cf2x.urdf", "urdf", with(&[LAG_SETTING])),
        ("racer.urdf", "urdf", with(&[LAG_SETTING])),
        ("x500/model.sdf", "sdf", vec![]),
        ("pelican.sdf", "sdf", vec![]),
        // Its rotors on one side turn the same way, so that it cannot yaw.
        ("x2.xml", "mujoco", [with(&[LAG_SETTING, alternate]), vec!["--neglect-products"]].concat()),
        ("cf2.xml", "mujoco", vec![]),
        ("4001_gz_x500", "px4", with(&px4)),
    ] {
        let (code, said, directory) = imported(&name.replace('/', "-"), &source(name), &more);
        assert_eq!(code, 0, "{name}: {said}");
        assert!(said.contains("next: host-sim certify mine.toml"), "{name}: {said}");
        let (named, ..) = imported("named", &source(name), &[&more[..], &["--format", format]].concat());
        assert_eq!(named, 0, "{name}");
        let output = host_sim(&directory, &["certify", "mine.toml"]);
        // The Crazyflie of cf2.xml is given 1e-5 N m of torque: it holds a hover, and falls for minutes until it is
        // upright.
        let weak = name == "cf2.xml";
        let decision = if weak { "mine: NOT certified: model flight from " } else { "mine: CERTIFIED" };
        assert!(stdout(&output).starts_with(decision), "{name}: {}", stdout(&output) + &stderr(&output));

        let read = Scenario::load(&directory.join("mine.toml")).unwrap();
        let verdict = scenario::verdict::Verdict::judge(&read).unwrap();
        let flown = if weak { read.clone() } else { recovery(&read, 15.0).unwrap() };
        let flight = host_sim::flight::Flight::certified(&flown, verdict.certified().unwrap()).unwrap();
        let course = host_sim::flight::course::Course::fly(&flown, flight, 0.1).unwrap();
        let settled = course.settled.unwrap_or(f64::INFINITY);
        assert!(settled < 8.0 && course.clipped == 0, "{name}: {settled} s, {} clipped", course.clipped);
    }
}

#[test]
fn a_vehicle_that_was_read_hovers_by_the_commands_of_the_page() {
    let (code, said, directory) = imported("hover", &source("crazyflie.py"), &[]);
    assert_eq!(code, 0, "{said}");
    let output = host_sim(&directory, &["fly", "mine.toml", "--out", "flown"]);
    assert_eq!(status(&output), 0, "{}", stdout(&output) + &stderr(&output));
}

#[test]
fn what_is_read_are_the_numbers_of_the_published_vehicles() {
    let near = |one: f32, other: f32, what: &str| {
        assert!((one - other).abs() <= 1e-4 * other.abs() + 1e-9, "{what}: {one}, published {other}");
    };
    let lagless = [("rotors.lag", "0")];
    // Published is the base's inertia of x500 and pelican alone; here the rotors' masses count, which hang out there.
    for (name, file, given, inertia_of_the_whole) in [
        ("crazyflie.py", "cf-rotorpy", &[][..], [1.0, 1.0, 1.0]),
        ("cf2x.urdf", "cf2x-pybullet", &lagless, [1.0, 1.0, 1.0]),
        ("racer.urdf", "racer-pybullet", &lagless, [1.0, 1.0, 1.0]),
        ("x500/model.sdf", "x500", &[], [1.100284, 1.105034, 1.1]),
        ("pelican.sdf", "pelican", &[], [1.08824, 1.08824, 1.08822]),
    ] {
        let (ours, theirs) = (scenario(name, given), published(file));
        let (vehicle, wanted) = (ours.configuration.vehicle(), theirs.configuration.vehicle());
        assert!((vehicle.mass / wanted.mass - 1.0).abs() < 2e-4, "{name}: {}", vehicle.mass);
        for (axis, whole) in inertia_of_the_whole.into_iter().enumerate() {
            near(vehicle.inertia[axis], whole * wanted.inertia[axis], name);
        }
        let (rotors, wanted) = (ours.configuration.rotors().unwrap(), theirs.configuration.rotors().unwrap());
        assert_eq!(rotors.len(), wanted.len());
        for rotor in rotors.iter() {
            let there =
                |other: &&controller_core::allocation::Rotor| (other.position - rotor.position).xy().norm() < 1e-6;
            let other = wanted.iter().find(there).unwrap_or_else(|| panic!("{name}: {rotor:?}"));
            near(rotor.thrust_coefficient, other.thrust_coefficient, name);
            near(rotor.drag_coefficient, other.drag_coefficient, name);
            near(rotor.thrust_max, other.thrust_max, name);
            assert_eq!(rotor.spin, other.spin, "{name}: {rotor:?}");
        }
        near(ours.rotor_lag as f32, theirs.rotor_lag as f32, name);
        // The published ones of gym-pybullet-drones leave drag out.
        if let (Some(ours), Some(theirs)) = (ours.reality.drag, theirs.reality.drag) {
            assert_eq!(ours, theirs, "{name}");
        }
    }
}

#[test]
fn px4s_right_is_our_minus_left_and_its_positive_moment_is_counter_clockwise() {
    let path = source("4001_gz_x500");
    let text = fs::read_to_string(&path).unwrap();
    let (_, _, directory) = imported("frame", &path, &[]);
    let file = fs::read_to_string(directory.join("mine.toml")).unwrap();
    // Rotor 0 is the front right one; PX4's Gazebo model has it at y = -0.174 and turns it ccw.
    assert!(file.contains("position = [\n    [0.13, -0.22, 0.0],\n    [-0.13, 0.2, 0.0],"), "{file}");
    // Rotor 1 states no moment: PX4's own default is 0.05, ccw.
    assert!(file.contains("spin = [\"ccw\", \"ccw\", \"cw\", \"cw\"]"), "{file}");
    // The same as QGroundControl saves it, with the z axis turned as well.
    let saved: String = text
        .lines()
        .filter_map(|line| line.strip_prefix("param set-default "))
        .map(|line| format!("1\t1\t{}\t9\n", line.replacen(' ', "\t", 1)))
        .collect();
    let vehicle = read(&(saved + "1\t1\tCA_ROTOR0_PZ\t-0.05\t9\n"), &path, None).unwrap();
    let host_sim::identification::import::numbers::Actuation::Rotors(rotors) = vehicle.actuation else { panic!() };
    assert_eq!(rotors.position.unwrap()[0], nalgebra::Vector3::new(0.13, -0.22, 0.05));
}

#[test]
fn what_a_source_lacks_is_marked_with_how_to_measure_it_and_every_command_refuses_it_by_its_key() {
    let (code, said, directory) = imported("missing", &source("4001_gz_x500"), &[]);
    assert_eq!(code, 1, "{said}");
    let file = fs::read_to_string(directory.join("mine.toml")).unwrap();
    for key in ["vehicle.mass", "vehicle.inertia", "rotors.thrust_max", "rotors.torque_per_thrust", "rotors.lag"] {
        let (_, short) = key.split_once('.').unwrap();
        assert!(said.contains(key) && file.contains(&format!("{short} = \"missing\"")), "{key}: {said}\n{file}");
        let comment = file.split("# MISSING: ").find(|comment| comment.starts_with(short)).unwrap();
        assert!(comment.contains("docs/identify.md"), "{comment}");
        // Where it is the only one, it is the one that is named.
        let others: String = file.lines().fold(String::new(), |text, line| {
            let number = match line {
                "mass = \"missing\"" => "mass = 2.0",
                "inertia = \"missing\"" => "inertia = [0.02, 0.02, 0.04]",
                "thrust_max = \"missing\"" => "thrust_max = 8.5",
                "torque_per_thrust = \"missing\"" => "torque_per_thrust = 0.016",
                "lag = \"missing\"" => "lag = 0.03",
                other => other,
            };
            text + if line == format!("{short} = \"missing\"") { line } else { number } + "\n"
        });
        fs::write(directory.join("one.toml"), others).unwrap();
        for command in [&["certify", "one.toml"][..], &["fly", "one.toml", "--out", "flown"], &["law", "one.toml"]] {
            let output = host_sim(&directory, command);
            let said = stderr(&output);
            assert!(status(&output) == 2 && said.contains(&format!("one.toml: {key}: marked \"missing\"")), "{said}");
        }
    }
    assert_eq!(files(&directory), ["mine.toml", "one.toml"]);
}

#[test]
fn products_of_inertia_are_refused_with_their_axes_unless_they_are_to_be_neglected() {
    let (code, said, _) = imported("products", &source("x2.xml"), &["--with", LAG_SETTING]);
    assert_eq!(code, 1);
    assert!(said.contains("vehicle.inertia: must be diagonal") && said.contains("pitch -4.99"), "{said}");
    let (_, said, directory) = imported("neglected", &source("x2.xml"), &["--with", LAG_SETTING, "--neglect-products"]);
    let file = fs::read_to_string(directory.join("mine.toml")).unwrap();
    assert!(file.contains("# products of inertia neglected: xy = 0.0, xz = -0.0021"), "{file}");
    // The published model's rotors on one side turn the same way.
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        said.contains(
            "rotors.spin: cannot produce thrust and all three torques independently: rotors 1 and 4, which are"
        ),
        "{said}"
    );
}

#[test]
fn malformed_sources_are_refused_by_file_element_and_reason_and_nothing_is_written() {
    let directory = binary::directory("vehicle_import", "malformed");
    let sdf = fs::read_to_string(source("pelican.sdf")).unwrap();
    let urdf = fs::read_to_string(source("cf2x.urdf")).unwrap();
    let mujoco = fs::read_to_string(source("x2.xml")).unwrap();
    let python = fs::read_to_string(source("crazyflie.py")).unwrap();
    let px4 = fs::read_to_string(source("4001_gz_x500")).unwrap();
    let changed = |text: &str, from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    };
    for (text, wanted) in [
        (String::new(), "looks like none of the formats"),
        ("<svg/>".to_owned(), "<svg>: must be <robot> (URDF), <sdf> or <mujoco>"),
        ("<sdf><model></sdf>".to_owned(), "not XML"),
        ("<!DOCTYPE a [<!ENTITY b \"b\">]><sdf>&b;</sdf>".to_owned(), "document type"),
        ("<sdf/>".to_owned(), "<sdf>: no <model>"),
        ("<sdf><gz:a/></sdf>".to_owned(), "the prefix gz is not declared: write <sdf xmlns:gz="),
        (changed(&sdf, "<mass>1.0<", "<mass>heavy<"), "line 6: <mass>: must be finite numbers, found \"heavy\""),
        (changed(&sdf, "<mass>1.0<", "<mass>-1<"), "the mass must not be negative, found -1"),
        (changed(&sdf, "<mass>1.0</mass>", ""), "<link name=\"base_link\">: no <inertial> with <mass>"),
        (changed(&sdf, "<ixx>0.01</ixx>", ""), "no <ixx>"),
        (changed(&sdf, "0.21 0 0 0 0 0", "0.21 0 0 0.3 0 0"), "rotors must push along body z"),
        (changed(&sdf, "0.21 0 0 0 0 0", "0.21 0 0"), "<pose>: must be 6 numbers, found 3"),
        (changed(&sdf, ">9.9865e-06<", ">9e-06<"), "motorConstant must be the same for all rotors"),
        (changed(&sdf, ">cw<", ">left<"), "turningDirection: must be cw or ccw, found \"left\""),
        (changed(&sdf, "<linkName>rotor_0<", "<linkName>rotor_9<"), "linkName: there is no link \"rotor_9\""),
        (changed(&sdf, "<motorNumber>1<", "<motorNumber>0<"), "motorNumber 0 is another's already"),
        (changed(&sdf, "<link name", "<include><uri>model://../x</uri></include><link name"), "must be model://NAME"),
        (changed(&sdf, "<link name", "<include><uri>model://gone</uri></include><link name"), "cannot be read"),
        (changed(&urdf, "value=\"0.027\"", "value=\"NaN\""), "<mass>: value: must be finite numbers, found \"NaN\""),
        (changed(&urdf, "ixx=\"1.4e-5\" ", ""), "attribute ixx is missing"),
        (changed(&urdf, "kf=\"3.16e-10\"", "kf=\"0\""), "<properties>: kf: must be greater than zero, found 0"),
        (changed(&urdf, "link=\"base_link\"", "link=\"prop0_link\""), "lead round in a circle"),
        (changed(&urdf, "<robot ", "<robot xmlns:xacro=\"x\" xacro:a=\"\" "), "OK"),
        (changed(&urdf, "  <link", "  <xacro:a xmlns:xacro=\"x\"/><link"), "run `xacro FILE"),
        (changed(&mujoco, "<freejoint/>", ""), "no body in <worldbody> with a <freejoint>"),
        (changed(&mujoco, "0 0 1 0 0 -.0201", "1 0 1 0 0 -.0201"), "name=\"thrust1\">: gear: must push along"),
        (changed(&mujoco, "ctrlrange=\"0 13\"", ""), "no ctrlrange: its greatest is not known"),
        (changed(&mujoco, "mass=\".25\"", "mass=\"-1\""), "the mass must not be negative"),
        (changed(&mujoco, "type=\"ellipsoid\" mass", "type=\"torus\" mass"), "type: \"torus\" is not read"),
        (changed(&mujoco, "name=\"thrust1\" pos", "name=\"thrust1\" zaxis=\"0 0 1\" pos"), "zaxis: is not read"),
        (changed(&python, "'mass': 0.03", "'mass': weigh()"), "quad_params: line 8: \"weigh\" cannot be worked out"),
        (changed(&python, "'mass': 0.03", "'mass': 'much'"), "mass: must be a number"),
        (changed(&python, "[1, -1, 1, -1]", "[1, -1, 1]"), "rotor_directions: must have one element for each"),
        ("{\"rotor_pos\": 3}".to_owned(), "rotor_pos: must be a dictionary of positions"),
        ("{\"rotor_pos\": ".to_owned(), "not JSON"),
        (changed(&px4, "COUNT 4", "COUNT 99"), "CA_ROTOR_COUNT: must be a whole number from 1 to 12, found 99"),
        (changed(&px4, "ROTOR0_PX 0.13", "ROTOR0_PX wide"), "line 6: CA_ROTOR0_PX: must be a finite number"),
        (px4 + "param set-default CA_ROTOR0_AX 1\n", "CA_ROTOR0_AX, _AY, _AZ: must point up"),
        ("<a>".repeat(500_000), "not XML"),
        ("#".repeat((4 << 20) + 1), "cannot be read: longer than 4194304 bytes"),
    ] {
        fs::write(directory.join("source"), text).unwrap();
        let output = host_sim(&directory, &["vehicle", "source", "--out", "mine.toml"]);
        if wanted == "OK" {
            assert_eq!(status(&output), 1, "{}", stderr(&output));
            fs::remove_file(directory.join("mine.toml")).unwrap();
            continue;
        }
        let said = stderr(&output);
        assert_eq!((status(&output), stdout(&output)), (2, String::new()), "{wanted}: {said}");
        assert!(said.starts_with("error: source: ") && said.contains(wanted), "{wanted}: {said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
    assert_eq!(files(&directory), ["source"]);
}

#[test]
fn included_models_stand_where_the_include_or_their_own_pose_says_and_links_relative_to_them() {
    let directory = binary::directory("vehicle_import", "included");
    let inertia = "<inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>";
    let link = |name: &str, pose: &str| {
        format!("<link name='{name}'>{pose}<inertial><mass>1</mass>{inertia}</inertial></link>")
    };
    let model = |name: &str, pose: &str, content: &str| {
        fs::create_dir_all(directory.join(name)).unwrap();
        let text = format!("<sdf><model name='{name}'>{pose}{content}</model></sdf>");
        fs::write(directory.join(name).join("model.sdf"), text).unwrap();
    };
    model("base", "<pose>0 0 3 0 0 0</pose>", &link("base_link", ""));
    model("arm", "<pose>9 9 9 0 0 0</pose>", &link("arm", ""));
    let own = "<include><uri>model://base</uri></include>\
               <include><uri>arm</uri><pose degrees='true'>0 0 1 0 0 90</pose></include>";
    let beside = link("beside", "<pose relative_to='base_link'>0 6 1 0 0 0</pose>");
    model("whole", "<pose>5 5 5 0 0 0</pose>", &(own.to_owned() + &beside));
    let path = directory.join("whole/model.sdf");
    let vehicle = read(&fs::read_to_string(&path).unwrap(), &path, None).unwrap();
    // At (0, 0, 3), (0, 0, 1) and (0, 6, 4), each 1 kg.
    assert_eq!(vehicle.mass, Some(3.0));
    let (y, z, yz) = (24.0, 42.0 / 9.0, 8.0);
    let moments = nalgebra::Matrix3::new(y + z, 0.0, 0.0, 0.0, z, -yz, 0.0, -yz, y);
    let found = vehicle.inertia.unwrap();
    assert!((found - moments - nalgebra::Matrix3::<f64>::identity() * 3.0).amax() < 1e-9, "{found}");
}

#[test]
fn models_that_include_each_other_without_end_are_refused() {
    let directory = binary::directory("vehicle_import", "circle");
    for (name, other) in [("a", "b"), ("b", "a")] {
        fs::create_dir(directory.join(name)).unwrap();
        let include = format!("<include><uri>model://{other}</uri></include>");
        let text = format!("<sdf><model name='{name}'>{}</model></sdf>", include.repeat(3));
        fs::write(directory.join(name).join("model.sdf"), text).unwrap();
    }
    let output = host_sim(&directory, &["vehicle", "a/model.sdf", "--out", "mine.toml"]);
    assert_eq!(status(&output), 2);
    assert!(stderr(&output).contains("include each other more than 8 deep"), "{}", stderr(&output));
}

#[test]
fn a_number_of_ones_own_must_be_one_and_stands_in_the_file_as_such() {
    let given = ["--with", "rotors.lag=0.03", "--with", "drag.linear=[0.01, 0.01, 0.01]"];
    let (code, said, directory) = imported("given", &source("cf2x.urdf"), &given);
    assert_eq!(code, 0, "{said}");
    let file = fs::read_to_string(directory.join("mine.toml")).unwrap();
    assert!(file.contains("# given beside the source\nlag = 0.03\n"), "{file}");
    assert!(file.contains("linear = [0.01, 0.01, 0.01]") && !file.contains("MISSING"), "{file}");
    for (given, wanted) in [
        ("lag=0.03", "must be section.key"),
        ("rotors.lag=slow", "rotors.lag: must be a number or a list"),
        ("rotors.lag=1\n[x]", "rotors.lag: must be a number or a list"),
        ("rotors.lag", "must be KEY=VALUE"),
    ] {
        let (code, said, directory) = imported("refused", &source("cf2x.urdf"), &["--with", given]);
        assert!(code == 2 && said.contains(wanted) && files(&directory).is_empty(), "{given}: {said}");
    }
}

#[test]
fn formats_are_told_apart_by_their_content_and_the_wrong_one_is_refused() {
    for (name, format) in [
        ("crazyflie.py", Format::Rotorpy),
        ("cf2x.urdf", Format::Urdf),
        ("pelican.sdf", Format::Sdf),
        ("x2.xml", Format::Mujoco),
        ("4001_gz_x500", Format::Px4),
    ] {
        let text = fs::read_to_string(source(name)).unwrap();
        assert_eq!(Format::detect(&text), Ok(format));
        for (_, other) in Format::ALL.into_iter().filter(|(_, other)| *other != format) {
            assert!(read(&text, &source(name), Some(other)).is_err(), "{name} as {other:?}");
        }
    }
    let json = "{\"mass\": 1, \"rotor_pos\": {\"r1\": [0, 1, 0]}}";
    assert_eq!(read(json, Path::new(""), None).unwrap().mass, Some(1.0));
}

#[test]
fn no_damage_to_a_source_makes_a_reader_panic_or_write_what_is_no_toml() {
    let mut rng = random::generator(31);
    for name in ["crazyflie.py", "cf2x.urdf", "pelican.sdf", "x2.xml", "cf2.xml", "4001_gz_x500"] {
        let whole = fs::read(source(name)).unwrap();
        for _ in 0..3000 {
            let mut bytes = whole.clone();
            for _ in 0..rng.random_range(1..4) {
                let (at, other) = (rng.random_range(0..bytes.len()), rng.random_range(0..bytes.len()));
                match rng.random_range(0..4) {
                    0 => bytes[at] = bytes[other],
                    1 => bytes.truncate(at.max(1)),
                    2 => bytes.insert(at, b"-+9e.{[(<'\"\n"[rng.random_range(0..12)]),
                    _ => drop(bytes.drain(at.min(other)..at.min(other) + (at.max(other) - at.min(other)).min(20))),
                }
            }
            let text = String::from_utf8_lossy(&bytes);
            if let Ok(vehicle) = read(&text, &source(name), None) {
                let file = written(&vehicle, "damaged", "a\nfile", &Wishes::default()).unwrap();
                assert!(file.text.parse::<toml_edit::DocumentMut>().is_ok(), "{}", file.text);
                assert_eq!(file.text.matches("= \"missing\"").count(), file.missing.len());
            }
        }
    }
}
