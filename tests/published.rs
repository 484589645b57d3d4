//! Vehicles of other projects, from the numbers those publish: `vehicles/published/` gives mass, inertia, rotors and
//! lag, and not one constant of a law. Each is certified and comes back from upside down.
//! `cargo test -p host-sim published -- --nocapture` prints the table that stands in `vehicles/README.md`.

use host_sim::course::Course;
use host_sim::flight::Flight;
use host_sim::tune::trials::recovery;
use scenario::Scenario;
use scenario::verdict::Verdict;
use std::fs;
use std::path::{Path, PathBuf};

/// How near is there, m.
const NEAR: f64 = 0.1;

/// Greatest height lost from upside down, m, and latest time of return, s: for a vehicle that lifts twice its weight,
/// and for a weaker one, whose thrust brakes a fall hardly faster than gravity made it.
const REQUIRED: (f64, f64) = (6.0, 4.0);
const REQUIRED_WEAK: (f64, f64) = (15.0, 8.0);

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vehicles/published");
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// Greatest thrust of all rotors over weight.
fn thrust_to_weight(scenario: &Scenario) -> f64 {
    let vehicle = scenario.configuration.vehicle();
    let thrust: f32 = scenario.configuration.rotors().unwrap().iter().map(|rotor| rotor.thrust_max).sum();
    f64::from(thrust / (vehicle.mass * vehicle.gravity))
}

#[test]
fn published_vehicles_are_certified_and_come_back_from_upside_down_without_a_constant_given() {
    assert_eq!(files().len(), 13);
    println!(
        "| vehicle | rotors | thrust / weight | height lost, m | within 0.1 m, s | tightest, margin |\n\
         |---|---|---|---|---|---|"
    );
    for file in files() {
        let text = fs::read_to_string(&file).unwrap();
        assert!(!["[gains]", "[estimates]", "[reference_bounds]"].iter().any(|section| text.contains(section)));
        let scenario = Scenario::load(&file).unwrap();
        let name = &scenario.name;
        let verdict = Verdict::of(&scenario).unwrap();
        assert!(verdict.refusal().is_none(), "{name}: refused");
        let tightest = verdict.certificate().tightest().unwrap();

        let upside_down = recovery(&scenario, 15.0).unwrap();
        let flight = Flight::certified(&upside_down, verdict.certified().unwrap()).unwrap();
        let Course { height_lost, settled, clipped, .. } = Course::over(&upside_down, flight, NEAR).unwrap();
        let settled = settled.unwrap_or(f64::INFINITY);
        let lift = thrust_to_weight(&scenario);
        println!(
            "| `{name}` | {} | {lift:.2} | {height_lost:.2} | {settled:.2} | {tightest}, {:.1} % |",
            scenario.configuration.rotors().unwrap().len(),
            100.0 * tightest.margin()
        );
        let (height, latest) = if lift < 2.0 { REQUIRED_WEAK } else { REQUIRED };
        assert!(height_lost < height && settled < latest, "{name}: {height_lost} m, {settled} s");
        assert_eq!(clipped, 0, "{name}: a rotor was commanded beyond its limits");
    }
}

#[test]
fn a_published_yaw_inertia_that_no_body_has_is_refused_by_its_field() {
    for name in ["firefly", "iris"] {
        let file = files().into_iter().find(|file| file.file_stem().unwrap() == name).unwrap();
        let text = fs::read_to_string(file).unwrap();
        let published = text.replace("0.0806492]", "0.0977]");
        assert_ne!(published, text);
        let error = Scenario::parse(&published, "published.toml").err().unwrap().to_string();
        assert!(error.contains("vehicle.inertia"), "{error}");
    }
}
