//! Every advice, followed: the file that it is about takes the number, and the row that is blamed has more margin.

use super::*;
use controller_core::certificate::Certificate;
use controller_core::configuration::LawParameters;
use scenario::Scenario;
use toml_edit::{DocumentMut, Item, Table, value};

/// A vehicle's file alone.
const BARE_VEHICLE: &str = "name = \"bare\"
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
const HUMMINGBIRD: &str = include_str!("../../../../../vehicles/hummingbird.toml");
const STUDY: &str = include_str!("../../../../../vehicles/study.toml");

/// By how much a number is changed.
const CHANGE_SHARE: f64 = 0.02;

/// The numbers that an advice names after "lower" or "raise", each with the factor that does so.
fn steps(advice: &str) -> Vec<(&str, f64)> {
    let (mut factor, mut found) = (None, Vec::new());
    for word in advice.split_whitespace() {
        match word.to_lowercase().as_str() {
            "lower" => factor = Some(1.0 - CHANGE_SHARE),
            "raise" => factor = Some(1.0 + CHANGE_SHARE),
            _ => {}
        }
        let name = word.trim_matches(|c: char| !c.is_ascii_alphanumeric());
        found.extend(factor.filter(|_| name.contains('.')).map(|factor| (name, factor)));
        if word.ends_with(['.', ';']) || word == "which" {
            factor = None;
        }
    }
    found
}

/// What the number at `path` is, in the file or by a formula.
fn number(scenario: &Scenario, path: &str) -> f64 {
    let configuration = &scenario.configuration;
    let LawParameters::Extended(law) = configuration.law() else { panic!("{path}") };
    let all = law.parameters.entries().chain(configuration.bounds().entries());
    let found = all.into_iter().find(|(constant, _)| constant.path == path).map(|(_, value)| f64::from(value));
    found.unwrap_or_else(|| match path {
        "limits.thrust_max" => configuration.limits().thrust_max.into(),
        "control.rate" => 1.0 / scenario.timing.period(),
        "reference.force_kept" => scenario.force_kept.into(),
        _ => panic!("{path}: no such number"),
    })
}

/// `text` with the number at `path` times `factor`.
fn with(text: &str, path: &str, factor: f64) -> Result<Scenario, String> {
    let scenario = Scenario::parse(text, "f").unwrap();
    let mut document: DocumentMut = text.parse().unwrap();
    let (section, key) = path.split_once('.').unwrap();
    let table = document.entry(section).or_insert(Item::Table(Table::new()));
    table[key] = match path {
        "limits.torque_max" => {
            let torques = scenario.configuration.limits().torque_max.map(|torque| f64::from(torque) * factor);
            value(torques.iter().copied().collect::<toml_edit::Array>())
        }
        // The next of those that are a whole number of microseconds.
        "control.rate" => value(125.0),
        _ => value(number(&scenario, path) * factor),
    };
    Scenario::parse(&document.to_string(), "f").map_err(|error| format!("{path}: {error}"))
}

fn margin(scenario: &Scenario, name: &str) -> f64 {
    let certificate = Certificate::new(&scenario.configuration).unwrap();
    certificate.inequalities().find(|inequality| inequality.name == name).unwrap().margin()
}

#[test]
fn the_advice_on_an_inequality_is_accepted_and_gives_it_margin() {
    let mut wrong = String::new();
    for text in [BARE_VEHICLE, HUMMINGBIRD, STUDY] {
        // For the same references, also where they follow from the vehicle.
        let scenario = Scenario::parse(text, "f").unwrap();
        let bounds = scenario::constants::written(scenario.configuration.bounds().entries());
        let text = &if text.contains("[reference_bounds]") { text.to_owned() } else { format!("{text}\n{bounds}") };
        let scenario = Scenario::parse(text, "f").unwrap();
        let certificate = Certificate::new(&scenario.configuration).unwrap();
        for inequality in certificate.inequalities() {
            let steps = steps(of_inequality(inequality.name));
            assert!(!steps.is_empty(), "{}", inequality.name);
            let before = inequality.margin();
            for (path, factor) in steps {
                match with(text, path, factor) {
                    Err(error) => wrong += &format!("{}, {}: {error}\n", scenario.name, inequality.name),
                    Ok(followed) => {
                        let gained = margin(&followed, inequality.name) - before;
                        if gained <= 0.0 {
                            let name = inequality.name;
                            wrong += &format!("{}, {name}: {path} times {factor}: {gained:+.5}\n", scenario.name);
                        }
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn the_advice_is_accepted_by_a_vehicles_file_alone() {
    let scenario = Scenario::parse(BARE_VEHICLE, "f").unwrap();
    for inequality in Certificate::new(&scenario.configuration).unwrap().inequalities() {
        for (path, factor) in steps(of_inequality(inequality.name)) {
            with(BARE_VEHICLE, path, factor).unwrap_or_else(|error| panic!("{}: {error}", inequality.name));
        }
    }
}

#[test]
fn the_advice_on_paths_flights_and_loops_is_accepted() {
    use controller_core::certificate::path::PathRow;
    let rows = [PathRow::Fall, PathRow::Thrust, PathRow::TurningRate, PathRow::Torque, PathRow::Floor, PathRow::Cone];
    let lack = |axis| of_loop(&Lack { axis, missed: 0.1, what: Shortfall::Unstable { spectral_radius: 1.1 } });
    let loops = [Axis::Roll, Axis::Yaw, Axis::LateralX, Axis::Vertical].map(lack);
    let texts = rows.map(|row| of_path(row).to_owned()).into_iter().chain(loops).chain([OF_FLIGHT.to_owned()]);
    for advice in texts {
        let steps = steps(&advice);
        assert!(!steps.is_empty(), "{advice}");
        for (path, factor) in steps {
            for text in [BARE_VEHICLE, HUMMINGBIRD] {
                // Only a reference that the file has is ever blamed.
                if text == HUMMINGBIRD || !path.starts_with("reference.") {
                    with(text, path, factor).unwrap_or_else(|error| panic!("{advice}: {error}"));
                }
            }
        }
    }
}
