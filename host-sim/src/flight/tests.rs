//! Both doors into a flight, and what its rotors show.

use super::*;
use crate::studies::campaign::draw::circumstances;

const STUDY: &str = include_str!("../../../vehicles/study.toml");

#[test]
fn both_doors_lead_to_the_same_flight() {
    let study = Scenario::parse(STUDY, "f").unwrap();
    let certified = Certified::new(study.configuration.clone()).unwrap();
    let mut flights = [Flight::certified(&study, &certified).unwrap(), Flight::uncertified(&study).unwrap()];
    for _ in 0..50 {
        let [a, b] = flights.each_mut().map(|flight| flight.tick().unwrap());
        assert!(a.wrench == b.wrench && a.rotor_thrusts == b.rotor_thrusts && a.state == b.state);
    }
}

#[test]
fn rotors_start_at_hover_and_follow_their_commands_behind_them() {
    let study = Scenario::parse(STUDY, "f").unwrap();
    let mut flight = Flight::new(&study).unwrap();
    let vehicle = study.configuration.vehicle();
    let first = flight.tick().unwrap();
    assert!((first.rotors.iter().sum::<f64>() - f64::from(vehicle.mass * vehicle.gravity)).abs() < 1e-5);
    // A second later, each is between where it was and its last command.
    let mut before = first;
    for _ in 0..100 {
        let tick = flight.tick().unwrap();
        for ((was, is), commanded) in before.rotors.iter().zip(&tick.rotors).zip(&before.rotor_thrusts) {
            let commanded = f64::from(*commanded);
            assert!((was.min(commanded)..=was.max(commanded)).contains(is), "{was} {is} {commanded}");
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

#[test]
fn a_tick_in_brief_is_the_same_tick() {
    for scenario in [Scenario::paper().unwrap(), Scenario::parse(STUDY, "f").unwrap()] {
        let thrown = circumstances(&scenario, &scenario.campaign.ranges, 0, 1);
        let mut flights = [(); 2].map(|()| Flight::new(&thrown).unwrap());
        for _ in 0..300 {
            let [whole, brief] = &mut flights;
            let (whole, brief) = (whole.tick().unwrap(), brief.brief_tick().unwrap());
            assert_eq!((whole.time_us, whole.state, whole.reference), (brief.time_us, brief.state, brief.reference));
            assert_eq!((whole.wrench, whole.clipped), (brief.wrench, brief.clipped));
            assert_eq!(whole.rotor_thrusts, brief.rotor_thrusts);
        }
    }
}
