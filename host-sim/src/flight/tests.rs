//! Through which door a flight goes, and what its rotors show.

use super::*;

const STUDY: &str = include_str!("../../../vehicles/study.toml");

fn flies_as_boards_do(text: &str) -> bool {
    let flight = Flight::new(&Scenario::parse(text, "f").unwrap()).unwrap();
    let SimulatedVehicle::Model(_, actuators) = flight.vehicle else { panic!("the file says nothing of reality") };
    matches!(actuators.rotors, Some((Allocation::Certified(_), _)))
}

#[test]
fn what_is_certified_flies_with_the_boards_allocation_and_nothing_else_does() {
    assert!(flies_as_boards_do(STUDY));
    assert!(!flies_as_boards_do(&STUDY.replace("thrust_max = 7.0", "thrust_max = 5.0")));
}

#[test]
fn rotors_start_at_hover_and_follow_their_commands_behind_them() {
    let study = Scenario::parse(STUDY, "f").unwrap();
    let mut flight = Flight::new(&study).unwrap();
    let vehicle = study.configuration.vehicle();
    let first = flight.tick().unwrap();
    assert!((first.rotors.iter().sum::<f64>() - f64::from(vehicle.mass * vehicle.gravity)).abs() < 1e-5);
    // A second later, each is between where it was and what it was last told.
    let mut before = first;
    for _ in 0..100 {
        let tick = flight.tick().unwrap();
        for ((was, is), told) in before.rotors.iter().zip(&tick.rotors).zip(&before.rotor_thrusts) {
            let told = f64::from(*told);
            assert!((was.min(told)..=was.max(told)).contains(is), "{was} {is} {told}");
        }
        before = tick;
    }
    assert!(Flight::new(&Scenario::paper().unwrap()).unwrap().tick().unwrap().rotors.is_empty());
}

#[test]
fn a_certified_flight_is_of_what_was_certified_whatever_the_circumstances() {
    let study = Scenario::parse(STUDY, "f").unwrap();
    let certified = Certified::new(study.configuration.clone()).unwrap();
    let heavier = STUDY.replace("mass = 0.460", "mass = 0.470");
    let circumstances = Scenario::parse(&heavier, "f").unwrap();
    let mut flight = Flight::certified(&circumstances, &certified).unwrap();
    let mut own = Flight::new(&study).unwrap();
    for _ in 0..100 {
        assert_eq!(flight.tick().unwrap().state, own.tick().unwrap().state);
    }
}
