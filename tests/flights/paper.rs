//! The paper's experiment, flown: every figure that Section VI claims, and the sharper ones this project aims at.

use controller_core::certificate::Certificate;
use host_sim::flight::Flight;
use host_sim::flight::claims::{all_hold, claims, table};
use host_sim::flight::extremes::FlightExtremes;
use scenario::Scenario;
use scenario::verdict::Verdict;
use std::path::Path;

fn flown(scenario: &Scenario) -> FlightExtremes {
    FlightExtremes::gather(scenario, Flight::new(scenario).unwrap()).unwrap()
}

#[test]
fn the_papers_experiment_meets_every_published_figure() {
    let scenario = Scenario::paper().unwrap();
    let flown = flown(&scenario);
    assert_eq!(flown.ticks, 4000);
    assert!(flown.steady_position_error < 1e-3 && flown.steady_mrp_error < 1e-4, "{flown:?}");
    assert!(flown.thrust.0 >= 3.51 && flown.thrust.1 <= 6.19, "{flown:?}");
    for (torque, bound) in flown.torque.into_iter().zip([0.29, 0.33, 0.48]) {
        assert!(torque <= bound, "{flown:?}");
    }
    assert_eq!(flown.clipped, 0);
    assert!(flown.filter <= 2.0);
    let claims = claims(&scenario, &Verdict::judge(&scenario).unwrap(), &flown);
    assert!(all_hold(&claims), "{}", table(&claims));
}

#[test]
fn it_tracks_several_times_closer_than_published() {
    let flown = flown(&Scenario::paper().unwrap());
    assert!(flown.steady_position_error < 3e-4, "{:e} m", flown.steady_position_error);
    assert!(flown.steady_mrp_error < 1e-5, "{:e}", flown.steady_mrp_error);
}

#[test]
fn a_flight_is_the_same_every_time() {
    let scenario = Scenario::paper().unwrap();
    assert_eq!(flown(&scenario), flown(&scenario));
}

#[test]
fn a_finer_plant_step_does_not_change_what_was_flown() {
    let scenario = Scenario::paper().unwrap();
    let mut fine = scenario.clone();
    fine.timing.steps_per_tick *= 4;
    let (coarse, fine) = (flown(&scenario), flown(&fine));
    assert!((coarse.thrust.1 - fine.thrust.1).abs() < 1e-5, "{coarse:?} {fine:?}");
    for (a, b) in coarse.torque.into_iter().zip(fine.torque) {
        assert!((a - b).abs() < 1e-5, "{coarse:?} {fine:?}");
    }
    assert!((coarse.height_lost - fine.height_lost).abs() < 1e-4, "{coarse:?} {fine:?}");
}

/// Every scenario file in a folder of the repository.
fn collection(folder: &str) -> Vec<Scenario> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder);
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = paths.filter(|path| path.extension().is_some_and(|extension| extension == "toml"));
    files.map(|path| Scenario::load(&path).unwrap()).collect()
}

#[test]
fn every_file_of_the_collection_flies_within_its_claims_and_arrives() {
    let all = [collection("scenarios"), collection("vehicles")].concat();
    for scenario in &all {
        let flown = flown(scenario);
        let claims = claims(scenario, &Verdict::judge(scenario).unwrap(), &flown);
        println!("{}: there after {:?} s", scenario.name, flown.position_reached());
        assert!(all_hold(&claims), "{}\n{}", scenario.name, table(&claims));
        let thrust = Certificate::new(&scenario.configuration).unwrap().thrust();
        assert!(thrust.min > 0.0 && thrust.max <= f64::from(scenario.configuration.limits().thrust_max));
    }
    for name in [
        "paper",
        "hover",
        "circle",
        "waypoints",
        "hummingbird",
        "study",
        "hummingbird-paper",
        "study-paper",
        "paper-extended",
    ] {
        assert!(all.iter().any(|scenario| scenario.name == name), "{name} is missing");
    }
}

#[test]
fn the_papers_vehicle_flies_every_scenario_within_a_centimetre() {
    let vehicle = *Scenario::paper().unwrap().configuration.vehicle();
    for scenario in collection("scenarios").iter().filter(|scenario| *scenario.configuration.vehicle() == vehicle) {
        let flown = flown(scenario);
        assert!(flown.steady_position_error < 0.01, "{}: {} m", scenario.name, flown.steady_position_error);
    }
}
