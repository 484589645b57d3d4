//! The sections about reality as users may write them, and as they must not.

use super::*;
use crate::Scenario;
use nalgebra::Vector3;
use sensors::VelocitySource;
use wind::Shape;

const HUMMINGBIRD: &str = include_str!("../../../vehicles/hummingbird-paper-law.toml");

const REALITY: &str = "
[truth]
mass = 0.55
inertia = [3.9e-3, 3.9e-3, 7.5e-3]
centre_of_mass = [0.005, 0.0, -0.002]
thrust_scale = 0.8
rotor_scales = [1, 0.95, 1.0, 1.0]
thrust_curve = 0.3
lag = 0.015

[drag]
linear = [0.3, 0.3, 0.1]
frame = [5e-3, 5e-3, 1e-2]
rotor_across = 1.19e-4
rotor_along = 2.32e-4
translational_lift = 3.39e-3
flapping = 1e-7

[wind]
steady = [3.0, 0.0, 4.0]
gust = { kind = \"one-cosine\", start = 5.0, velocity = [5.0, 0.0, 0.0], duration = 2.0 }
turbulence = { wind_at_20_feet = 6.0, altitude = 10.0, seed = 7 }

[disturbance]
acceleration = [1.0, 0.0, -0.5]
torque = [0.0, 0.0, 0.002]
start = 2.5

[battery]
full_voltage = 12.6
empty_voltage = 10.5
resistance = 0.03
capacity = 2.0
charge = 0.9
efficiency = 0.6
nominal_voltage = 12.0

[failure]
rotor = 2
time = 4.5
thrust_left = 0.25

[ground]
height = -0.5

[sensors]
gyro_noise = 0.01
gyro_bias = [0.005, 0.0, 0.0]
position_noise = 0.002
attitude_noise_deg = 0.2
velocity = \"observer\"
velocity_bandwidth = 20.0
accelerometer_noise = 0.1
accelerometer_bias = [0.0, 0.0, 0.05]
pose_rate = 50.0
dropout = 0.01
delay = 0.02
seed = 3
";

fn read(sections: &str) -> Result<Scenario, String> {
    Scenario::parse(&format!("{HUMMINGBIRD}{sections}"), "f").map_err(|error| error.what)
}

/// `REALITY` with the line that starts with `line` replaced; `nth` of those there are.
fn with(line: &str, nth: usize, replacement: &str) -> String {
    let places: Vec<usize> =
        REALITY.lines().enumerate().filter(|(_, found)| found.starts_with(line)).map(|(place, _)| place).collect();
    let swap = |(place, found)| if places.get(nth) == Some(&place) { replacement } else { found };
    assert!(nth < places.len(), "{line}");
    REALITY.lines().enumerate().map(swap).collect::<Vec<_>>().join("\n")
}

#[test]
fn every_key_becomes_what_the_file_says() {
    let Reality { truth, drag, wind, disturbance, battery, failure, ground, sensors, .. } =
        read(REALITY).unwrap().reality;
    let truth = truth.unwrap();
    assert_eq!((truth.mass, truth.thrust_scale, truth.thrust_curve, truth.lag), (0.55, 0.8, Some(0.3), Some(0.015)));
    assert_eq!(truth.inertia, Vector3::new(3.9e-3, 3.9e-3, 7.5e-3));
    assert_eq!(
        (truth.centre_of_mass, truth.rotor_scales),
        (Vector3::new(0.005, 0.0, -0.002), vec![1.0, 0.95, 1.0, 1.0])
    );
    let drag = drag.unwrap();
    assert_eq!((drag.linear, drag.frame), (Vector3::new(0.3, 0.3, 0.1), Vector3::new(5e-3, 5e-3, 1e-2)));
    assert_eq!((drag.rotor_across, drag.rotor_along), (1.19e-4, 2.32e-4));
    assert_eq!((drag.translational_lift, drag.flapping), (3.39e-3, 1e-7));
    let wind = wind.unwrap();
    let (gust, turbulence) = (wind.gust.unwrap(), wind.turbulence.unwrap());
    assert_eq!((wind.steady, gust.velocity), (Vector3::new(3.0, 0.0, 4.0), Vector3::new(5.0, 0.0, 0.0)));
    assert_eq!((gust.shape, gust.start), (Shape::OneCosine(2.0), 5.0));
    // The steady wind's speed where the file names none.
    assert_eq!((turbulence.wind_at_20_feet, turbulence.altitude, turbulence.airspeed), (6.0, 10.0, 5.0));
    assert_eq!(turbulence.seed, 7);
    let disturbance = disturbance.unwrap();
    assert_eq!((disturbance.acceleration, disturbance.start), (Vector3::new(1.0, 0.0, -0.5), 2.5));
    assert_eq!(disturbance.torque, Vector3::new(0.0, 0.0, 0.002));
    let battery = battery.unwrap();
    assert_eq!((battery.full_voltage, battery.empty_voltage, battery.nominal_voltage), (12.6, 10.5, 12.0));
    assert_eq!((battery.resistance, battery.capacity, battery.charge, battery.efficiency), (0.03, 7200.0, 0.9, 0.6));
    assert_eq!(failure, Some(Failure { rotor: 1, time: 4.5, thrust_left: 0.25 }));
    assert_eq!(ground, Some(Ground { height: -0.5 }));
    let sensors = sensors.unwrap();
    assert_eq!((sensors.gyro_noise, sensors.gyro_bias), (0.01, Vector3::new(0.005, 0.0, 0.0)));
    assert_eq!((sensors.position_noise, sensors.attitude_noise), (0.002, 0.2_f64.to_radians()));
    let bias = Vector3::new(0.0, 0.0, 0.05);
    assert_eq!(sensors.velocity, VelocitySource::Observer { bandwidth: 20.0, noise: 0.1, bias });
    assert_eq!((sensors.pose_every, sensors.dropout, sensors.delay_ticks, sensors.seed), (2, 0.01, 2, 3));
}

#[test]
fn a_file_without_them_is_the_model_and_a_section_without_keys_changes_little() {
    let model = read("").unwrap();
    assert_eq!(model.reality, Reality::default());
    assert!(model.reality.sections().is_empty() && read(REALITY).unwrap().reality.sections() == SECTION_NAMES[..8]);
    assert!(model.reality.is_model());
    let empty = read("[truth]\n[drag]\n[wind]\n[sensors]\n").unwrap().reality;
    assert_eq!(empty.truth.as_ref().unwrap().mass, f64::from(0.5_f32));
    assert_eq!((empty.drag, empty.wind), (Some(Drag::default()), Some(Wind::default())));
    assert_eq!(empty.sensors.unwrap().velocity, VelocitySource::Exact { noise: 0.0 });
    assert!(!empty.is_model());
    assert_eq!(empty.sections(), ["truth", "drag", "wind", "sensors"]);
    assert!(read("[sensors]").unwrap().reality.is_model());
}

#[test]
fn any_difference_in_reality_makes_another_flight() {
    let real = read(REALITY).unwrap();
    assert!(real.flies_like(&read(REALITY).unwrap()) && !real.flies_like(&read("").unwrap()));
    for (line, nth, replacement) in
        [("mass", 0, "mass = 0.56"), ("linear", 0, "linear = [0, 0, 0]"), ("seed", 0, "seed = 4"), ("height", 0, "")]
    {
        assert!(!real.flies_like(&read(&with(line, nth, replacement)).unwrap()), "{replacement}");
    }
}

#[test]
fn a_velocity_from_positions_is_part_of_the_sampled_loops_and_needs_a_pose_at_every_tick() {
    let tracked = "[sensors]\nvelocity = \"alpha-beta\"\nvelocity_bandwidth = 20.0\n";
    let [known, filtered] = ["", tracked].map(|sections| read(sections).unwrap().loops().unwrap().reports());
    // Roll, pitch and yaw do not depend on it.
    assert_eq!(known[..3], filtered[..3]);
    assert!(known[3..].iter().zip(&filtered[3..]).all(|(known, filtered)| known != filtered));
    for (key, field) in [("pose_rate = 50.0", "sensors.pose_rate"), ("dropout = 0.01", "sensors.dropout")] {
        let refused = read(&format!("{tracked}{key}")).err().unwrap();
        assert!(refused.contains(field) && refused.contains("loops cannot be judged"), "{refused}");
        read(&format!("{}{key}", tracked.replace("alpha-beta", "observer"))).unwrap();
    }
}

#[test]
fn late_inputs_are_part_of_the_sampled_loops() {
    let late = |delay: &str| {
        let model = read(&format!("[sensors]\ndelay = {delay}")).unwrap().loops().unwrap();
        model.spectral_radius(crate::sampled_loop::Axis::ALL[0])
    };
    let sampling = read("[sampling]\ndelay = 0.01").unwrap().loops().unwrap();
    assert_eq!(late("0.01"), sampling.spectral_radius(crate::sampled_loop::Axis::ALL[0]));
    assert_ne!(late("0.01"), late("0.0"));
}

#[test]
fn each_unusable_field_is_named_with_the_reason() {
    let turbulence = |keys: &str| format!("turbulence = {{ {keys} }}");
    let gust = |keys: &str| format!("gust = {{ {keys}, velocity = [1, 0, 0] }}");
    for (line, nth, replacement, field, words) in [
        ("mass", 0, "mass = 0.0".to_owned(), "truth.mass", "greater than zero, found 0"),
        ("inertia", 0, "inertia = [1e-3, 1e-3, 9e-3]".into(), "truth.inertia", "triangle inequality"),
        ("inertia", 0, "inertia = [1e-3, -1e-3, 1e-3]".into(), "truth.inertia[1]", "greater than zero"),
        ("centre_of_mass", 0, "centre_of_mass = [0, 0, 101]".into(), "truth.centre_of_mass[2]", "from -100 to 100 m"),
        ("thrust_scale", 0, "thrust_scale = -0.1".into(), "truth.thrust_scale", "from 0 to 10, found -0.1"),
        ("rotor_scales", 0, "rotor_scales = [1, 1]".into(), "truth.rotor_scales", "each of 4 rotors, found 2"),
        ("rotor_scales", 0, "rotor_scales = [1, 1, nan, 1]".into(), "truth.rotor_scales[2]", "from 0 to 10, found NaN"),
        ("rotor_scales", 0, "rotor_scales = [1, 1, 1, \"a\"]".into(), "truth.rotor_scales[3]", "must be a number"),
        ("thrust_curve", 0, "thrust_curve = 1.5".into(), "truth.thrust_curve", "from 0 to 1, found 1.5"),
        ("thrust_curve", 0, "thrust_curv = 1.0".into(), "truth.thrust_curv", "did you mean \"thrust_curve\"?"),
        ("lag", 0, "lag = 1.5".into(), "truth.lag", "from 0 to 1 s, found 1.5"),
        ("linear", 0, "linear = [0.1, -0.1, 0]".into(), "drag.linear[1]", "from 0 to 1000, found -0.1"),
        ("frame", 0, "frame = 0.1".into(), "drag.frame", "a list of three numbers"),
        ("flapping", 0, "flapping = inf".into(), "drag.flapping", "finite"),
        ("[drag]", 0, "[dragg]".into(), "dragg", "did you mean \"drag\"?"),
        ("steady", 0, "steady = [101, 0, 0]".into(), "wind.steady[0]", "from -100 to 100 m/s"),
        ("gust", 0, gust("kind = \"step\""), "wind.gust.start", "missing"),
        (
            "gust",
            0,
            gust("kind = \"gale\", start = 1"),
            "wind.gust.kind",
            "\"one-cosine\" or \"pulse\", found \"gale\"",
        ),
        ("gust", 0, gust("kind = \"pulse\", start = 1"), "wind.gust.duration", "missing"),
        ("gust", 0, gust("kind = \"step\", start = 1, duration = 1"), "wind.gust.duration", "a step has none"),
        ("gust", 0, "gust = { kind = \"step\", start = 1 }".into(), "wind.gust.velocity", "missing"),
        ("turbulence", 0, turbulence("altitude = 10"), "wind.turbulence.wind_at_20_feet", "missing"),
        ("turbulence", 0, turbulence("wind_at_20_feet = 5, altitude = 2"), "wind.turbulence.altitude", "from 3.048 to"),
        ("steady", 0, "steady = [0.0, 0.0, 0.0]".into(), "wind.turbulence.airspeed", "where wind.steady does not say"),
        ("seed", 0, "seed = 1.5".into(), "sensors.seed", "whole number"),
        ("torque", 0, "torque = [0, 101, 0]".into(), "disturbance.torque[1]", "from -100 to 100 N m"),
        ("acceleration", 0, "accelerations = 1".into(), "disturbance.accelerations", "did you mean \"acceleration\"?"),
        ("full_voltage", 0, String::new(), "battery.full_voltage", "missing"),
        ("empty_voltage", 0, "empty_voltage = 13".into(), "battery.empty_voltage", "at most battery.full_voltage"),
        ("resistance", 0, "resistance = -1".into(), "battery.resistance", "from 0 to 10 ohm"),
        ("efficiency", 0, "efficiency = 0".into(), "battery.efficiency", "from 0.01 to 1"),
        ("rotor = ", 0, "rotor = 5".into(), "failure.rotor", "a rotor's number, 1 to 4, found 5"),
        ("rotor = ", 0, "rotor = 0".into(), "failure.rotor", "1 to 4, found 0"),
        ("time", 0, "time = -1".into(), "failure.time", "from 0 to"),
        ("thrust_left", 0, "thrust_left = 2".into(), "failure.thrust_left", "from 0 to 1"),
        ("height", 0, "height = 2.0".into(), "initial.position", "not be below ground.height = 2 m, found 1.5 m"),
        ("gyro_noise", 0, "gyro_noise = -0.1".into(), "sensors.gyro_noise", "from 0 to 10 rad/s"),
        ("velocity = ", 0, "velocity = \"gps\"".into(), "sensors.velocity", "found \"gps\""),
        (
            "velocity = ",
            0,
            String::new(),
            "sensors.velocity_bandwidth",
            "means nothing with sensors.velocity = \"exact\"",
        ),
        ("velocity = ", 0, "velocity = \"alpha-beta\"".into(), "sensors.accelerometer_noise", "means nothing"),
        ("velocity_bandwidth", 0, String::new(), "sensors.velocity_bandwidth", "missing"),
        ("pose_rate", 0, "pose_rate = 30".into(), "sensors.pose_rate", "over a whole number, found 30 (nearest: 33.3"),
        ("pose_rate", 0, "pose_rate = 200".into(), "sensors.pose_rate", "from 0.1 to 100"),
        ("dropout", 0, "dropout = 1".into(), "sensors.dropout", "from 0 to 0.99"),
        (
            "delay",
            0,
            "delay = 0.015".into(),
            "sensors.delay",
            "whole number of control periods, found 0.015 s (nearest:",
        ),
        ("delay", 0, "delay = 0.65".into(), "sensors.delay", "from 0 to 0.64 s"),
    ] {
        let what = read(&with(line, nth, &replacement)).err().unwrap_or_else(|| panic!("{replacement} was accepted"));
        assert!(what.starts_with(&format!("{field}: ")) && what.contains(words), "{replacement}: {what}");
        assert_eq!(what.lines().count(), 1, "{what}");
    }
}

#[test]
fn a_section_that_needs_another_says_which() {
    let paper = |sections: &str| {
        Scenario::parse(&format!("{}{sections}", crate::PAPER), "f").map_err(|error| error.what).map(|_| ())
    };
    let battery = "[battery]\nfull_voltage = 12\nempty_voltage = 10\nresistance = 0\ncapacity = 1\n";
    for (sections, start) in [
        ("[wind]\nsteady = [1, 0, 0]", "wind: needs [drag]"),
        (battery, "battery: needs [rotors]"),
        ("[failure]\nrotor = 1\ntime = 1", "failure: needs [rotors]"),
        ("[drag]\nrotor_across = 1e-4", "drag.rotor_across: needs [rotors]"),
        ("[truth]\nrotor_scales = [1]", "truth.rotor_scales: needs [rotors]"),
        ("[truth]\nthrust_curve = 0.1", "truth.thrust_curve: needs [rotors]"),
        ("[truth]\nlag = 0.1", "truth.lag: needs [rotors]"),
        ("[truth]\nrotor_inertia = 1e-6", "truth.rotor_inertia: needs [rotors]"),
        ("[truth]\ndeadband = 0.02", "truth.deadband: needs [rotors]"),
        ("[sampling]\ndelay = 0.6\n[sensors]\ndelay = 0.05", "sensors.delay: must be from 0 to 0.04"),
    ] {
        let what = paper(sections).expect_err(sections);
        assert!(what.starts_with(start), "{what}");
    }
    paper("[drag]\nlinear = [0.1, 0.1, 0.1]\n[wind]\nsteady = [1, 0, 0]\n[truth]\nthrust_scale = 0.9\n[ground]")
        .unwrap();
}

#[test]
fn an_estimator_has_defaults_and_its_delay_counts_in_the_loops() {
    let with = |text: &str| read(text).unwrap();
    let plain = with("[estimator]\n");
    let estimator = plain.reality.estimator.unwrap();
    assert_eq!((estimator.imu_noise, estimator.pose_every, estimator.pose_delay), (1.0, 10, 20));
    assert_eq!((estimator.position_noise, estimator.attitude_noise), (1e-3, 0.3_f64.to_radians()));
    assert_eq!((estimator.dropout, estimator.outage, estimator.seed), (0.0, None, 0));
    assert!(plain.reality.is_model() && plain.reality.sections() == ["estimator"]);
    assert!((6e-3..7e-3).contains(&plain.input_delay()), "{}", plain.input_delay());
    let roll = |scenario: &Scenario| scenario.loops().unwrap().reports()[0].margins.unwrap().delay;
    let lost = roll(&with("")) - roll(&plain);
    assert!((lost - plain.input_delay()).abs() < 1e-4, "{lost}");
    let outage =
        with("[estimator]\noutage = { start = 2.0, duration = 0.5 }").reality.estimator.unwrap().outage.unwrap();
    assert_eq!((outage.start, outage.duration), (2.0, 0.5));
}

#[test]
fn an_estimator_that_cannot_be_is_refused_by_name() {
    for (text, field, problem) in [
        ("[sensors]\n[estimator]", "estimator", "leave [sensors] or [estimator] out"),
        ("[estimator]\npose_rate = 70.0", "estimator.pose_rate", "whole milliseconds"),
        ("[estimator]\npose_rate = 500.0", "estimator.pose_rate", "from 10 to 200 Hz"),
        ("[estimator]\npose_delay = 0.0205", "estimator.pose_delay", "whole milliseconds"),
        ("[estimator]\npose_delay = 0.2", "estimator.pose_delay", "from 0 to 0.15 s"),
        ("[estimator]\nimu_noise = -1.0", "estimator.imu_noise", "from 0 to 100"),
        ("[estimator]\noutage = { start = 1.0 }", "estimator.outage.duration", "missing"),
        ("[estimator]\npose_noise = 1.0", "estimator.pose_noise", "unknown"),
    ] {
        let error = read(text).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(field) && error.contains(problem), "{text}: {error}");
    }
}
