//! The embedded scenario equals the file, to the bit; and only what can be flown is embedded.

#[path = "../../build/embed.rs"]
mod embed;
#[path = "../../build/policy.rs"]
mod policy;

use embed::{Embedded, embedded};
use scenario::policy::{LayerNumbers, PolicyFile};
use scenario::{Scenario, board};
use std::fs;
use std::path::{Path, PathBuf};

/// The file that is embedded when SCENARIO names none: see build.rs.
const DEFAULT: &str = "vehicles/study.toml";

/// The greatest rate of most boards, Hz.
const RATE_MAX: f64 = 1000.0;

/// A file whose gains do not follow from its rotors' lag.
const PAPERS_LAW: &str = "vehicles/hummingbird-paper-law.toml";

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name)
}

/// What becomes of a file with a line of it changed.
fn changed(name: &str, line: &str, into: &str) -> Result<Embedded, String> {
    let text = fs::read_to_string(file(name)).unwrap();
    assert_eq!(text.matches(line).count(), 1, "{line} in {name}");
    embedded(&text.replace(line, into), name, RATE_MAX)
}

#[test]
fn the_embedded_configuration_is_the_files_to_the_bit() {
    let name = option_env!("SCENARIO").unwrap_or(DEFAULT);
    let scenario = Scenario::load(&file(name)).unwrap();
    assert_eq!(firmware::configuration::NAME, scenario.name);
    assert_eq!(firmware::configuration::embedded().unwrap(), scenario.configuration);
    assert_eq!(firmware::configuration::LOOPS, board::judged(&scenario));
    assert_eq!(firmware::configuration::IDENTITY, board::identity(&scenario));
    assert_eq!(firmware::configuration::MOTOR, scenario.motor());
    assert_eq!(firmware::configuration::PERIOD_US, scenario.timing.period_us);
}

#[test]
fn the_default_is_tuned_for_a_sample_of_delay() {
    let scenario = Scenario::load(&file(DEFAULT)).unwrap();
    assert!(scenario.delay() >= scenario.timing.period());
}

#[test]
fn the_vehicles_of_this_repository_are_built_without_a_word() {
    for name in [DEFAULT, "vehicles/hummingbird.toml"] {
        let text = fs::read_to_string(file(name)).unwrap();
        let Embedded { source, warning } = embedded(&text, name, RATE_MAX).unwrap();
        assert!(warning.is_none() && source.contains("Rotors::new(&["), "{name}: {warning:?}");
    }
}

/// The Pelican of rotors_simulator: a vehicle and its rotors, nothing else.
const BARE: &str = "
name = \"pelican\"

[vehicle]
mass = 1.04
inertia = [0.01, 0.01, 0.02]

[rotors]
position = [[0.21, 0.0, 0.0], [0.0, 0.21, 0.0], [-0.21, 0.0, 0.0], [0.0, -0.21, 0.0]]
spin = [\"cw\", \"ccw\", \"cw\", \"ccw\"]
thrust_coefficient = 9.9865e-6
drag_coefficient = 1.59784e-7
speed = [0.0, 838.0]
lag = 0.025
";

#[test]
fn a_file_of_a_vehicle_and_its_rotors_alone_is_built_and_may_arm() {
    let Embedded { source, warning } = embedded(BARE, "pelican.toml", RATE_MAX).unwrap();
    assert!(warning.is_none() && source.contains("ExtendedParameters { k_p_across: "), "{warning:?}");
}

#[test]
fn a_vehicle_whose_loop_is_unstable_is_not_built_and_the_loop_is_named() {
    // Rotors that follow a second late: the certificate, which is about commands, holds all the same.
    let refused = changed(PAPERS_LAW, "lag = 0.005 ", "lag = 1.0 ").unwrap_err();
    let loop_and_reason = "vehicles/hummingbird-paper-law.toml: sampled loop roll: unstable, spectral radius 1.0";
    assert!(refused.starts_with(loop_and_reason) && refused.lines().count() == 1, "{refused}");
}

#[test]
fn a_vehicle_whose_loop_is_stable_without_its_margin_is_not_built_either() {
    // Judging every choice of gains takes seconds: only what the build asks before that.
    let text = fs::read_to_string(file(PAPERS_LAW)).unwrap();
    let with_lag = |lag: u32| {
        let text = text.replace("lag = 0.005 ", &format!("lag = {lag}e-3 "));
        board::check(&Scenario::parse(&text, "slow").unwrap(), "slow")
    };
    let refused = (5..1000).find_map(|lag| with_lag(lag).err()).unwrap();
    assert!(refused.contains("sampled loop") && refused.contains("must") && !refused.contains("radius"), "{refused}");
}

#[test]
fn a_vehicle_that_is_not_certified_is_built_with_a_warning_that_names_the_inequality() {
    let warning = changed("vehicles/hummingbird.toml", "torque_max = [1.0, 1.0, 0.4]", "torque_max = [1.0, 1.0, 0.04]");
    let warning = warning.unwrap().warning.unwrap();
    assert!(warning.contains("T2 yaw torque") && warning.ends_with("this firmware will refuse to arm"), "{warning}");
    assert_eq!(warning.lines().count(), 1);
}

#[test]
fn a_file_is_built_at_its_rate_unless_the_boards_processor_is_too_slow_for_it() {
    let at =
        |rate: u32, rate_max: f64| embedded(&format!("{BARE}\n[control]\nrate = {rate}\n"), "pelican.toml", rate_max);
    for (rate, period) in [(50, 20_000), (100, 10_000), (500, 2_000), (1_000, 1_000)] {
        let source = at(rate, RATE_MAX).unwrap().source;
        assert!(source.contains(&format!("pub const PERIOD_US: u64 = {period};")), "{rate} Hz");
    }
    let refused = at(1_000, 500.0).unwrap_err();
    let expected = "pelican.toml: control.rate: this board's processor flies at up to 500 Hz, found 1000";
    assert_eq!(refused, expected);
    let refused = at(2_000, f64::MAX).unwrap_err();
    assert_eq!(refused, "pelican.toml: control.rate: the firmware flies at 50 to 1000 Hz, found 2000");
}

#[test]
fn what_the_boards_cannot_drive_is_refused_by_field() {
    for (file, rate, what) in [
        ("vehicles/hummingbird.toml", 40, "the firmware flies at 50 to 1000 Hz, found 40"),
        (PAPERS_LAW, 200, "the firmware flies the paper's law at 100 Hz, found 200"),
    ] {
        let refused = changed(file, "rate = 100.0 ", &format!("rate = {rate}.0 ")).unwrap_err();
        assert!(refused.starts_with(&format!("{file}: control.rate: {what}")), "{refused}");
    }
    let paper = fs::read_to_string(file("scenarios/paper.toml")).unwrap();
    assert!(embedded(&paper, "paper.toml", RATE_MAX).unwrap_err().starts_with("paper.toml: rotors: missing"));
}

#[test]
fn a_policy_is_built_in_to_the_bit_and_one_that_does_not_fit_is_refused_by_name() {
    let name = "vehicles/policies/hover.toml";
    let text = fs::read_to_string(file(name)).unwrap();
    let study = Scenario::parse(scenario::STUDY, "study.toml").unwrap();
    let source = policy::source(&text, name, &study).unwrap();
    let weights: Vec<f32> = source
        .split("weights: &[")
        .nth(1)
        .and_then(|rest| rest.split(']').next())
        .unwrap()
        .split(',')
        .filter_map(|number| number.trim().parse().ok())
        .collect();
    let PolicyFile { layers, .. } = PolicyFile::parse(&text, name).unwrap();
    let LayerNumbers::Dense { affine, .. } = &layers[0] else { panic!("a dense layer is read as one") };
    assert_eq!(weights, affine.weights);
    let refused = policy::source(&text.replace("0.0, 0.0, 0.0, 0.0]\n", "0.0]\n"), name, &study).unwrap_err();
    assert_eq!(refused, format!("{name}: layers[0].weights: must have a row for each of 1 biases, found 4"));
    // An image without one has the type for that.
    assert!(policy::NONE.contains("flight::NoPolicy"));
}

#[test]
fn a_policy_that_the_vehicle_cannot_fly_is_refused_when_it_is_built_in() {
    let name = "vehicles/policies/raptor.toml";
    let text = fs::read_to_string(file(name)).unwrap();
    let on = |vehicle: &str| policy::source(&text, name, &Scenario::parse(vehicle, "vehicle.toml").unwrap());
    assert!(on(scenario::STUDY).is_ok());
    let quick = scenario::STUDY.replace("rate = 100.0", "rate = 200.0");
    let refused = on(&quick).unwrap_err();
    assert_eq!(
        refused,
        format!("{name}: period: it acts every 0.01 s, study every 0.005 s; give the scenario [control] rate = 100.0")
    );
    for plus_or_six in ["pelican", "firefly"] {
        let vehicle = fs::read_to_string(file(&format!("vehicles/published/{plus_or_six}.toml"))).unwrap();
        assert!(on(&vehicle).unwrap_err().starts_with(&format!("{name}: demands: speeds of rotors are for an X")));
    }
}
