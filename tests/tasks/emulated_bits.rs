//! The paper's flight gives the published number on this machine. `.ci/emulated bits` checks the same on emulated
//! processors.

use controller_core::certificate::certified::Certified;
use controller_core::controller::{Controller, Diagnostics};
use controller_core::reference::Reference;
use firmware::replay::{FLIGHT_TICKS, PERIOD_US, Replay, record};
use host_sim::flight::Flight;
use nalgebra::Vector3;
use scenario::Scenario;
use sha2::{Digest, Sha256};

/// The number as published; `.ci/emulated` reads the same file.
const PUBLISHED_HASH: &str = include_str!("../paper_flight.sha256");

fn bits(wrench: &controller_core::state::Wrench) -> [u32; 4] {
    [wrench.thrust, wrench.torque.x, wrench.torque.y, wrench.torque.z].map(f32::to_bits)
}

#[test]
fn the_papers_flight_is_the_published_number_on_this_machine() {
    let scenario = Scenario::paper().unwrap();
    assert_eq!((scenario.timing.ticks, scenario.timing.period_us), (FLIGHT_TICKS, PERIOD_US));
    let mut flight = Flight::new(&scenario).unwrap();
    let mut replay = Replay::new().unwrap();
    for tick in 0..FLIGHT_TICKS {
        // The live flight's own wrench: the replay flies the same vehicle, gains and reference.
        let flown = flight.tick().unwrap();
        let replayed = replay.tick(&record(&flown.state.measured())).unwrap();
        assert_eq!(bits(&flown.wrench), bits(&replayed), "tick {tick}");
    }
    assert_eq!(replay.digest(), PUBLISHED_HASH.trim());
}

#[test]
fn one_bit_of_one_state_changes_the_number() {
    let mut flight = Flight::new(&Scenario::paper().unwrap()).unwrap();
    let mut replay = Replay::new().unwrap();
    for tick in 0..FLIGHT_TICKS {
        let mut state = record(&flight.tick().unwrap().state.measured());
        if tick == FLIGHT_TICKS / 2 {
            state[0] ^= 1;
        }
        replay.tick(&state).unwrap();
    }
    assert_ne!(replay.digest(), PUBLISHED_HASH.trim());
}

/// a b + c d, each product and the sum rounded.
fn separate([a, b]: [f32; 2], [c, d]: [f32; 2]) -> f32 {
    a * b + c * d
}

/// The same with the second product not rounded.
fn fused([a, b]: [f32; 2], [c, d]: [f32; 2]) -> f32 {
    c.mul_add(d, a * b)
}

/// T = m |u|, N, worked out as the law does it: u in the heading frame first, where `sum` makes one component.
fn thrust(mass: f32, u: &Vector3<f32>, reference: &Reference, sum: fn([f32; 2], [f32; 2]) -> f32) -> f32 {
    let yaw = reference.heading.direction();
    let forward = sum([yaw.x, u.x], [yaw.y, u.y]);
    let left = yaw.x * u.y - yaw.y * u.x;
    mass * ((u.z * u.z + forward * forward) + left * left).sqrt()
}

/// The paper's flight as the number that `firmware::replay` describes, written down a second time, with the thrust as
/// `thrust` has it; and at how many ticks that is not the law's.
fn number(thrust: impl Fn(&Reference, &Diagnostics) -> f32) -> (String, u64) {
    let scenario = Scenario::paper().unwrap();
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let mut controller = Controller::new(&certified, scenario.timing.period() as f32).unwrap();
    let mut flight = Flight::new(&scenario).unwrap();
    let (mut hash, mut different) = (Sha256::new(), 0);
    for tick in 0..FLIGHT_TICKS {
        let state = flight.tick().unwrap().state.measured();
        let reference = scenario.trajectory.at(tick * PERIOD_US);
        let (wrench, diagnostics) = controller.step(&state, &reference).unwrap();
        let memory = controller.memory();
        let (filter, lift) = (memory.filter, memory.lift.unwrap());
        let thrust = thrust(&reference, &diagnostics);
        different += u64::from(thrust.to_bits() != wrench.thrust.to_bits());
        let q = lift.memory;
        let numbers: [&[f32]; 9] = [
            &[thrust],
            wrench.torque.as_slice(),
            filter.filtered.as_slice(),
            filter.intermediate.as_slice(),
            &[q.w, q.i, q.j, q.k],
            &[lift.sign],
            diagnostics.mrp.as_slice(),
            diagnostics.desired_angular_velocity.as_slice(),
            diagnostics.desired_angular_acceleration.as_slice(),
        ];
        numbers.concat().iter().for_each(|number| hash.update(number.to_le_bytes()));
    }
    (hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect(), different)
}

#[test]
fn one_fused_multiplication_and_addition_changes_the_number() {
    let mass = Scenario::paper().unwrap().configuration.vehicle().mass;
    let with = |sum: fn([f32; 2], [f32; 2]) -> f32| {
        number(|reference, diagnostics| thrust(mass, &diagnostics.acceleration_command, reference, sum))
    };
    // What is fused below is the law's own line: as it stands, it gives the law's bits and the published number.
    assert_eq!(with(separate), (PUBLISHED_HASH.trim().to_owned(), 0));
    let (found, different) = with(fused);
    println!("fused: {different} of {FLIGHT_TICKS} thrusts have other bits");
    assert!(different > 0 && found != PUBLISHED_HASH.trim(), "{different}");
}
