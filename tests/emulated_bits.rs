//! The paper's flight gives the published number on this machine. `.ci/emulated bits` checks the same on emulated
//! processors.

use firmware::replay::{PERIOD_US, Replay, TICKS, record};
use host_sim::flight::Flight;
use scenario::Scenario;

/// The number as published; `.ci/emulated` reads the same file.
const PUBLISHED: &str = include_str!("paper_flight.sha256");

fn bits(wrench: &controller_core::state::Wrench) -> [u32; 4] {
    [wrench.thrust, wrench.torque.x, wrench.torque.y, wrench.torque.z].map(f32::to_bits)
}

#[test]
fn the_papers_flight_is_the_published_number_on_this_machine() {
    let scenario = Scenario::paper().unwrap();
    assert_eq!((scenario.timing.ticks, scenario.timing.period_us), (TICKS, PERIOD_US));
    let mut flight = Flight::new(&scenario).unwrap();
    let mut replay = Replay::new().unwrap();
    for tick in 0..TICKS {
        // The live flight's own wrench: the replay flies the same vehicle, gains and reference.
        let flown = flight.tick().unwrap();
        let replayed = replay.tick(&record(&flown.state.measured())).unwrap();
        assert_eq!(bits(&flown.wrench), bits(&replayed), "tick {tick}");
    }
    assert_eq!(replay.digest(), PUBLISHED.trim());
}

#[test]
fn one_bit_of_one_state_changes_the_number() {
    let mut flight = Flight::new(&Scenario::paper().unwrap()).unwrap();
    let mut replay = Replay::new().unwrap();
    for tick in 0..TICKS {
        let mut state = record(&flight.tick().unwrap().state.measured());
        if tick == TICKS / 2 {
            state[0] ^= 1;
        }
        replay.tick(&state).unwrap();
    }
    assert_ne!(replay.digest(), PUBLISHED.trim());
}
