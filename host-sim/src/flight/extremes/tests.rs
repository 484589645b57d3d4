//! From when on a vehicle counts as arrived, and from when on as steady.

use super::*;

fn flown(scenario: &Scenario, ticks: u64) -> FlightExtremes {
    let mut flight = Flight::new(scenario).unwrap();
    let mut flown = FlightExtremes::new(scenario);
    for _ in 0..ticks {
        flown.observe(&flight.tick().unwrap());
    }
    flown
}

#[test]
fn steady_state_is_the_last_quarter() {
    let paper = Scenario::paper().unwrap();
    let (before, after) = (flown(&paper, 3000), flown(&paper, 3001));
    assert_eq!((before.steady_position_error, before.steady_mrp_error), (0.0, 0.0));
    assert!(after.steady_position_error > 0.0);
    // It fell from 10 m, upside down, by what Table I's gains cannot prevent.
    assert!((22.0..25.0).contains(&before.height_lost), "{}", before.height_lost);
}

#[test]
fn a_vehicle_that_leaves_its_reference_has_not_reached_it() {
    let paper = Scenario::paper().unwrap();
    let mut flight = Flight::new(&paper).unwrap();
    let mut flown = FlightExtremes::new(&paper);
    assert_eq!((flown.position_reached(), flown.attitude_reached()), (None, None));
    for _ in 0..paper.timing.ticks {
        flown.observe(&flight.tick().unwrap());
    }
    assert!(flown.position_reached().is_some() && flown.attitude_reached().is_some());
    let mut tick = flight.tick().unwrap();
    tick.state.position.z += 0.21;
    flown.observe(&tick);
    assert!(flown.position_reached().is_none() && flown.attitude_reached().is_some());
    tick = flight.tick().unwrap();
    tick.diagnostics.mrp.x = 0.06;
    flown.observe(&tick);
    assert_eq!((flown.position_reached(), flown.attitude_reached()), (Some(40.01), None));
}
