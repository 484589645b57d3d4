//! Whole files: what they become, and which defaults fill the gaps. tests/program/cli.rs holds the table of malformed
//! ones.

use super::*;
use controller_core::certificate::Certificate;
use controller_core::certificate::certified::Certified;
use controller_core::configuration::LawParameters;
use controller_core::law::Law;
use nalgebra::Vector3;

const EXTENDED: &str = include_str!("../../../vehicles/hummingbird.toml");

/// The paper's file without the section that starts with `head`.
fn without(head: &str) -> String {
    let (before, rest) = PAPER.split_once(head).unwrap();
    let after = rest.find("\n[").map_or("", |end| &rest[end..]);
    format!("{before}{after}")
}

#[test]
fn the_built_in_file_is_the_papers_experiment() {
    let paper = Scenario::paper().unwrap();
    let (vehicle, gains) = (paper.configuration.vehicle(), paper.configuration.gains().unwrap());
    assert_eq!((vehicle.mass, vehicle.gravity), (0.46, 9.81));
    assert_eq!((gains.k_p, gains.k_v, gains.k_f, gains.k_s), (9.0, 6.0, 2.0, 20.0));
    assert_eq!((gains.k_theta, gains.k_omega, gains.m_p), (100.0, 0.1, 2.0));
    assert_eq!((gains.m_theta, gains.m_omega, gains.delta, gains.alpha), (0.206, 0.045, 0.02, 0.25));
    assert_eq!(paper.initial.position, Vector3::new(5.0, 5.0, 10.0));
    // Roll of -179 degrees: the thrust axis points down.
    let q = paper.initial.attitude;
    assert!((1.0 - 2.0 * (q.i * q.i + q.j * q.j) + (1.0_f64.to_radians()).cos()).abs() < 1e-12);
    assert!((paper.initial.yaw().to_degrees() - 100.0).abs() < 1e-9);
    let start = paper.trajectory.at(0);
    assert!((start.position - Vector3::new(-2.0, 1.0, 5.5)).norm() < 1e-6);
    let frequency = 2.0 * std::f32::consts::PI / 15.0;
    assert!((paper.trajectory.bounds().vertical_acceleration - frequency * frequency).abs() < 1e-5);
    assert!(paper.is_papers());
}

#[test]
fn sections_left_out_take_their_defaults() {
    let paper = Scenario::paper().unwrap();
    for head in ["[control]", "[plant]"] {
        assert!(Scenario::parse(&without(head), "f").unwrap().flies_like(&paper), "{head}");
    }
    let placed = Scenario::parse(&without("[initial]"), "f").unwrap();
    assert!((placed.initial.position - Vector3::new(-2.0, 1.0, 5.5)).norm() < 1e-6);
    assert_eq!((placed.initial.velocity, placed.initial.angular_velocity), (Vector3::zeros(), Vector3::zeros()));
    assert_eq!(placed.initial.attitude.w, 1.0);
    let error = Scenario::parse(&without("[vehicle]"), "f").err().unwrap();
    assert_eq!(error.what, "vehicle: missing, must be a section");
    let without_gains = Scenario::parse(&without("[gains]"), "f").unwrap();
    assert!(matches!(without_gains.configuration.law(), LawParameters::Extended(_)));
    let brief = Scenario::parse(&PAPER.replace("duration = 40.0", ""), "f").unwrap();
    assert_eq!(brief.timing.duration(), 20.0);
    assert!(Scenario::parse(&PAPER.replace("gravity = 9.81", ""), "f").unwrap().flies_like(&paper));
}

#[test]
fn without_a_reference_it_hovers_where_it_starts() {
    let hovering = |text: &str| {
        let scenario = Scenario::parse(text, "f").unwrap();
        let reference = scenario.trajectory.at(1_000_000);
        assert_eq!(scenario.initial.position, reference.position.cast::<f64>());
        assert_eq!(reference.heading.direction().x, 1.0);
        reference.position
    };
    let without_reference = without("[reference]");
    assert_eq!(hovering(&without_reference), Vector3::new(5.0, 5.0, 10.0));
    let line = "position = [5.0, 5.0, 10.0]";
    assert!(without_reference.contains(line));
    assert_eq!(hovering(&without_reference.replace(line, "")), Vector3::new(0.0, 0.0, 1.0));
    for (position, words) in [("[5.0, 1e20, 10.0]", "initial.position: must be within"), ("[1, 2]", "three numbers")] {
        let text = without_reference.replace(line, &format!("position = {position}"));
        let error = Scenario::parse(&text, "f").err().unwrap().what;
        assert!(error.starts_with("initial.position: ") && error.contains(words), "{error}");
    }
}

#[test]
fn a_file_of_name_vehicle_and_rotors_is_complete() {
    let kept = ["[vehicle]", "[rotors]"].map(|head| {
        let section = &EXTENDED[EXTENDED.find(head).unwrap()..];
        &section[..section[1..].find("\n[").unwrap() + 2]
    });
    let bare = format!("name = \"short\"\n{}", kept.concat());
    let short = Scenario::parse(&bare, "f").unwrap();
    assert!((short.configuration.limits().thrust_max - 50.13).abs() < 1e-3);
    assert_eq!((short.timing.ticks, short.timing.period_us), (2000, 10_000));
    assert_eq!(short.initial.position, Vector3::new(0.0, 0.0, 1.0));
    assert!(matches!(short.configuration.law(), LawParameters::Extended(_)));
    Certified::new(short.configuration.clone()).unwrap();
    let same = Scenario::parse(&format!("{bare}[control]\nlaw = \"extended\"\n[gains]\n"), "f").unwrap();
    assert!(same.flies_like(&short));
    // The paper's gains follow from nothing.
    let papers = Scenario::parse(&format!("{bare}[control]\nlaw = \"paper\"\n"), "f").err().unwrap();
    assert_eq!(papers.what, "gains: missing, must be a section");
}

#[test]
fn a_constant_of_the_extended_law_is_the_files_and_the_others_follow() {
    let with = |lines: &str| Scenario::parse(&EXTENDED.replace("[gains]", &format!("[gains]\n{lines}")), "f");
    let parameters = |scenario: Scenario| match scenario.configuration.law() {
        LawParameters::Extended(law) => *law.parameters,
        LawParameters::Paper(_) => panic!(),
    };
    let (own, slower) = (parameters(with("").unwrap()), parameters(with("k_f = 5.0").unwrap()));
    assert!(own.k_f > 5.0 && slower.k_f == 5.0 && slower.k_s < own.k_s && slower.k_tilt == own.k_tilt);
    for (line, words) in [
        ("k_ff = 5.0", "gains.k_ff: unknown key"),
        ("k_f = 0.1", "gains.k_f: must be at least 0.2"),
        ("force_up = 0.1", "gains.force_up: unknown key"),
        ("w = 0.1", "gains.w: the law no longer has it: k_tilt"),
        ("turn_acceleration = 9.0", "gains.turn_acceleration: the law no longer has it: it follows"),
    ] {
        let refused = with(line).err().unwrap().what;
        assert!(refused.starts_with(words), "{refused}");
    }
    let written = crate::constants::written(own.entries());
    let (head, tail) = EXTENDED.split_once("[gains]").unwrap();
    let all = format!("{head}{written}{}", &tail[tail.find("\n[control]").unwrap()..]);
    assert_eq!(parameters(Scenario::parse(&all, "f").unwrap()), own);
}

#[test]
fn a_constant_of_the_extended_law_alone_keeps_its_law() {
    let bare = EXTENDED.replace("law = \"extended\"", "");
    assert!(bare != EXTENDED);
    let line = EXTENDED.lines().find(|line| line.starts_with("yaw_acceleration")).unwrap();
    let with = |gains: &str| Scenario::parse(&bare.replace(line, gains), "f");
    for gains in ["", "yaw_acceleration = 8.0", "k_f = 5.0"] {
        let read = with(gains).unwrap();
        assert!(matches!(read.configuration.law(), LawParameters::Extended(_)), "{gains}");
    }
    // One gain that only the paper's law has names that law, which needs all of them.
    let refused = with("k_p = 9.0").err().unwrap().what;
    assert!(refused.starts_with("gains.k_v: missing, as are k_f, "), "{refused}");
    let refused = with("k_p = 9.0\nyaw_acceleration = 8.0").err().unwrap().what;
    assert!(refused.starts_with("gains.yaw_acceleration: unknown key"), "{refused}");
}

#[test]
fn what_a_file_makes_of_a_constant_that_it_leaves_out_is_refused_by_the_files_own_number() {
    let refused = |changes: &[(&str, &str)]| {
        let text = changes.iter().fold(EXTENDED.to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replacen(from, to, 1)
        });
        Scenario::parse(&text, "f").err().unwrap().what
    };
    let what =
        refused(&[("gravity = 9.81", "gravity = 3.5"), ("[control]", "[estimates]\nscale_greatest = 10\n[control]")]);
    assert!(what.starts_with("vehicle: ") && what.contains("gains.floor_margin, which the file leaves out"), "{what}");
    let what = refused(&[("vertical_acceleration = 0.1755", "vertical_acceleration = 5.0")]);
    assert!(what.starts_with("reference_bounds.vertical_acceleration: leaves 4.81"), "{what}");
}

#[test]
fn any_number_that_differs_makes_another_flight() {
    let paper = Scenario::paper().unwrap();
    for (from, to) in [
        ("duration = 40.0", "duration = 39.0"),
        ("mass = 0.460", "mass = 0.461"),
        ("thrust_max = 7.0", "thrust_max = 7.1"),
        ("k_p = 9.0", "k_p = 9.1"),
        ("rate = 100.0", "rate = 200.0"),
        ("step = 0.001", "step = 0.002"),
        ("euler_deg = [-179.0", "euler_deg = [-178.0"),
        ("center = [-3.0", "center = [-3.1"),
        ("rate = 0.0,", "rate = 0.1,"),
        ("rate = 100.0", "rate = 100.0\nthrust_floor = 1.0"),
    ] {
        assert!(PAPER.contains(from), "{from}");
        let other = Scenario::parse(&PAPER.replace(from, to), "f").unwrap();
        assert!(!other.is_papers() && !other.flies_like(&paper), "{to}");
    }
    assert!(Scenario::parse(&PAPER.replace("name = \"paper\"", "name = \"x\""), "f").unwrap().is_papers());
}

#[test]
fn a_thrust_floor_lowers_the_thrust_interval_and_is_checked() {
    let with = |floor: &str| Scenario::parse(&PAPER.replace("rate = 100.0", &format!("thrust_floor = {floor}")), "f");
    let thrust = Certificate::new(&with("1.0").unwrap().configuration).unwrap().paper().unwrap().printed.thrust;
    assert!(thrust.min < 1.0 && thrust.min > 0.999, "{thrust:?}");
    for bad in ["0.0", "-1", "4.0"] {
        assert!(with(bad).err().unwrap().what.starts_with("control.thrust_floor: "), "{bad}");
    }
}

/// Gains of the heading that are too fast for this rate are refused when the file is read, not when it is first flown.
#[test]
fn gains_that_ask_for_shorter_ticks_are_refused_by_name() {
    for (line, field) in [("c_1 = 900.0", "gains.c_1"), ("c_2 = 101.0", "gains.c_2")] {
        let text = EXTENDED.replace("[gains]", &format!("[gains]\n{line}"));
        let refused = Scenario::parse(&text, "f").err().unwrap();
        assert!(refused.to_string().contains(field), "{refused}");
    }
}

/// The extended law models commands on their way for three ticks; a delay beyond that is refused here as well, and not
/// by `fly` what `certify` has certified.
#[test]
fn a_delay_that_the_extended_law_has_no_memory_for_is_refused_by_name() {
    const STUDY_DELAY: &str = "delay = 0.010 ";
    let at = |rate: &str, delay: &str| {
        let text = crate::STUDY.replace("rate = 100.0 ", &format!("rate = {rate} "));
        Scenario::parse(&text.replace(STUDY_DELAY, delay), "f")
    };
    for (rate, delay) in [("100.0", "delay = 0.030 "), ("500.0", "delay = 0.060 ")] {
        let study = at(rate, delay).unwrap();
        let certified = Certified::new(study.configuration).unwrap();
        assert!(Law::new(&certified, study.timing.period() as f32).is_ok(), "{delay}");
    }
    for (delay, field) in [
        ("delay = 0.031 ", "sampling.delay"),
        ("delay = 0.016\n[sensors]\ndelay = 0.016 ", "sampling.delay"),
        ("delay = 0.0\n[sensors]\ndelay = 0.032 ", "sampling.delay"),
    ] {
        let refused = at("1000.0", delay).err().unwrap().what;
        assert!(refused.starts_with(field) && refused.contains("at most 30 control periods, 0.030 s"), "{refused}");
    }
    let without = crate::STUDY.replace("[sampling]", "[sensors]").replace(STUDY_DELAY, "delay = 0.310 ");
    assert!(Scenario::parse(&without, "f").err().unwrap().what.starts_with("sensors.delay: "));
}

#[test]
fn numbers_marked_missing_are_refused_by_their_keys_all_in_one_line_and_a_name_may_be_that_word() {
    let file = EXTENDED.replace("mass = 0.500 ", "mass = \"missing\"").replace("lag = 0.005 ", "lag = \"missing\"");
    let refused = Scenario::parse(&file, "f").err().unwrap().to_string();
    assert!(refused.starts_with("f: rotors.lag: marked \"missing\", as are vehicle.mass: measure it"), "{refused}");
    let named = EXTENDED.replace("name = \"hummingbird\"", "name = \"missing\"");
    assert_eq!(Scenario::parse(&named, "f").unwrap().name, "missing");
}

#[test]
fn a_start_that_single_precision_is_too_coarse_for_is_refused() {
    let text = PAPER.replace("position = [5.0, 5.0, 10.0]", "position = [5.0, 5e6, 10.0]");
    let error = Scenario::parse(&text, "f").err().unwrap().what;
    assert!(
        error.starts_with("initial.position: must be within 16 km of the origin, found (5, 5000000, 10) m"),
        "{error}"
    );
}
