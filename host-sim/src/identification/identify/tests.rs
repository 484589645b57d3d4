//! The noise that is left, bench data, and the scenario that is written, without a flight. Those with flights are in
//! tests/numbers/identify.rs.

use super::bench;
use super::noise::Noise;
use super::output::{Values, rewritten};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand::rngs::Xoshiro256PlusPlus;
use rand_distr::{Distribution, StandardNormal};
use scenario::Scenario;

const HUMMINGBIRD: &str = include_str!("../../../../vehicles/hummingbird.toml");

fn parse(text: &str) -> Scenario {
    Scenario::parse(text, "f").unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn what_is_left_is_made_white_by_the_noise_that_is_fitted_to_it() {
    const PART_COUNT: usize = 20;
    let truth = Noise { wander: 200.0, time: 2.0, walk: 0.5 };
    let (period, mut random) = (0.01, Xoshiro256PlusPlus::seed_from_u64(3));
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let decay = (-period / PART_COUNT as f64 / truth.time).exp();
    let (mut r, mut b) = (0.0, 0.0);
    let series: Vec<f64> = (0..8000)
        .map(|_| {
            let measured = r + normal();
            r += truth.walk * normal();
            for _ in 0..PART_COUNT {
                r += period / PART_COUNT as f64 * b;
                b = decay * b + truth.wander * (1.0 - decay * decay).sqrt() * normal();
            }
            0.003 * measured
        })
        .collect();
    let white = Noise::START.fitted(&series, period).whitening(series.len(), period).whiten(&series);
    let spread: f64 = white.iter().map(|e| e * e).sum();
    assert!(((spread / white.len() as f64).sqrt() / 0.003 - 1.0).abs() < 0.05, "{spread}");
    for lag in 1..40 {
        let correlation = white.iter().zip(&white[lag..]).map(|(a, b)| a * b).sum::<f64>() / spread;
        // Four deviations of what white noise of this length shows.
        assert!(correlation.abs() < 4.0 / (white.len() as f64).sqrt(), "{lag}: {correlation}");
    }
}

#[test]
fn bench_data_are_read_as_their_formulas_say_and_refused_by_name() {
    let scenario = parse(HUMMINGBIRD);
    let rotors = scenario.configuration.rotors().unwrap();
    let full = 5.57e-6 * 1500.0 * 1500.0 * 0.9;
    let commands = [0.2, 0.4, 0.6, 0.8, 1.0];
    let thrusts: Vec<String> = commands.iter().map(|u| (full * (0.3 * u + 0.7 * u * u)).to_string()).collect();
    // J/m = g T^2 d^2 / (16 pi^2 L): 7.3e-3 m^2 swings with this period.
    let period = (7.3e-3 * 16.0 * std::f64::consts::PI.powi(2) * 1.2 / (9.81 * 0.09)).sqrt();
    let text = format!(
        "[weighing]\nmass = [0.51, 0.53]\nuncertainty = 0.001\n[[swing]]\naxis = \"y\"\nlength = 1.2\ndistance = 0.3\n\
         swings = 20\ntimes = [{0}, {0}]\nuncertainty = 0.001\n[thrust_stand]\ncommands = {commands:?}\nthrusts = [{1}]\nuncertainty = 0.01\n",
        20.0 * period,
        thrusts.join(", ")
    );
    let read = bench::read(&text, rotors, 9.81).unwrap();
    let (mass, scale) = (read.mass.unwrap(), read.thrust_scale.unwrap());
    assert!((mass.value - 0.52).abs() < 1e-12 && (mass.uncertainty - 0.001_f64.hypot(0.01)).abs() < 1e-9, "{mass:?}");
    assert!((scale.value - 0.9).abs() < 1e-5 && (scale.uncertainty - 0.009).abs() < 1e-5, "{scale:?}");
    assert!((read.curve.unwrap() - 0.3).abs() < 1e-6);
    assert!(read.swings[0].axis == 1 && (read.swings[0].over_mass.value - 7.3e-3).abs() < 1e-9);
    for (good, bad, said) in [
        ("[weighing]", "[weighting]", "weighting: unknown key"),
        ("axis = \"y\"", "axis = \"w\"", "swing.axis: must be"),
        ("length = 1.2", "length = -1.2", "swing.length: must be a number above zero"),
        ("uncertainty = 0.01", "", "thrust_stand.uncertainty: is missing"),
        ("[0.2, 0.4, 0.6, 0.8, 1.0]", "[0.2, 0.2, 0.2, 0.2, 0.2]", "thrust_stand.commands: must differ"),
        ("[0.2, 0.4, 0.6, 0.8, 1.0]", "[0.2, 0.4, 0.8, 0.6, 1.0]", "thrust_stand.thrusts: must rise with the commands"),
    ] {
        // Of several the last: the stand's.
        let at = text.rfind(good).unwrap();
        let refused = bench::read(&(text[..at].to_owned() + bad + &text[at + good.len()..]), rotors, 9.81).unwrap_err();
        assert!(refused.contains(said), "{refused}");
    }
}

#[test]
fn the_written_scenario_has_the_numbers_and_keeps_the_rest() {
    let values = Values {
        mass: 0.61,
        inertia: [4e-3, 4.1e-3, 7.5e-3],
        thrust_scale: 0.9,
        lag: 0.0123,
        delay: 0.0064,
        centre_of_mass: [0.002, -0.003],
        drag: [0.3, 0.2, 0.1],
    };
    let text = rewritten(HUMMINGBIRD, "mine", &values, 1e-3).unwrap();
    let (scenario, original) = (parse(&text), parse(HUMMINGBIRD));
    let vehicle = scenario.configuration.vehicle();
    assert_eq!((scenario.name.as_str(), vehicle.mass, vehicle.inertia.y), ("mine", 0.61, 4.1e-3));
    assert!((scenario.rotor_lag - 0.0123).abs() < 1e-9 && (scenario.delay() - 0.006).abs() < 1e-9);
    let rotor = |scenario: &Scenario| *scenario.configuration.rotors().unwrap().iter().next().unwrap();
    let (new, old) = (rotor(&scenario), rotor(&original));
    assert!((new.thrust_coefficient / old.thrust_coefficient - 0.9).abs() < 1e-5);
    assert!((new.drag_coefficient / old.drag_coefficient - 0.9).abs() < 1e-5);
    assert!((new.position - old.position - Vector3::new(-0.002, 0.003, 0.0)).norm() < 1e-5);
    assert_eq!(scenario.reality.drag.unwrap().linear, Vector3::new(0.3, 0.2, 0.1));
    for kept in ["k_p_across = 48.45521", "# RK4", "Flies a 1 m circle"] {
        assert!(text.contains(kept) || !HUMMINGBIRD.contains(kept), "{kept}");
    }
    // Rotors that the file knows by their thrust.
    let by_thrust = HUMMINGBIRD.lines().map(|line| match line.split(' ').next() {
        Some("thrust_coefficient") => "thrust_max = 10.0",
        Some("drag_coefficient") => "thrust_min = 0.1",
        Some("speed") => "torque_per_thrust = 0.0244",
        _ => line,
    });
    let by_thrust = by_thrust.collect::<Vec<_>>().join("\n");
    let new = rotor(&parse(&rewritten(&by_thrust, "mine", &values, 1e-3).unwrap()));
    assert!((new.thrust_max - 9.0).abs() < 1e-5 && (new.thrust_min - 0.09).abs() < 1e-6, "{new:?}");
    assert!((new.drag_coefficient / new.thrust_coefficient - 0.0244).abs() < 1e-7);
}
