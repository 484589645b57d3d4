//! The fault campaign: every failure in every phase of a flight, alone and in pairs, flown in closed loop by the core's
//! whole pilot on a simulated vehicle with rotors, air, ground, a noisy IMU and late poses; and each flight held to
//! what must follow.
//!
//! - `failure`: what fails, and how it shows;
//! - `phase`: where in a flight, and what an operator says to get there;
//! - `expected`: what must follow, as data, and the order of severity;
//! - `watch`: what must hold in every tick;
//! - `run`: one flight, to the ground; `report`: the table;
//! - `found`: what the campaign has found, each defect with the flight that showed it.
//!
//! `cargo test -p host-sim fault_campaign -- --nocapture` prints the table. `tests/supervisor/all_pairs.rs` flies every
//! pair.

mod expected;
mod failure;
mod found;
mod phase;
mod report;
mod run;
mod watch;

use controller_core::certificate::certified::{Certified, Refused};
use controller_core::configuration::Configuration;
use controller_core::reference::ReferenceBounds;
use failure::Failure;
use flight::rules::{Condition, Row, TABLE};
use flight::{FlightSettings, Mode, Reason, Transition};
use phase::Phase;
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;
use rand::{Rng, RngExt, SeedableRng};
use rayon::prelude::*;
use run::{Case, Flown, fly};
use scenario::Scenario;
use std::collections::HashSet;
use std::ops::Range;
use std::path::Path;

/// What no failure here leads to: what an operator asks for; and what the certificate and the checks of every input
/// rule out, however the vehicle fails; and what it takes long lies for: `lying_poses`. `flight/pilot/tests.rs` and
/// `flight/rules/tests.rs` in the core cause that on purpose.
const NOT_BY_FAILURES: [Condition; 11] = [
    Condition::Uncertified,
    Condition::MotorTestPermitted,
    Condition::Requested,
    Condition::Disarmed,
    Condition::HoldRequested,
    Condition::LandRequested,
    Condition::SetpointsRequested,
    Condition::ThrustsRefused,
    Condition::Saturated,
    Condition::PosesGivenUp,
    Condition::LandingOver,
];

/// How high it flies, m.
const FLIGHT_HEIGHT: f32 = 1.5;

/// What an operator has chosen about failures: all of it within reach of a short flight.
const FLIGHT_SETTINGS: FlightSettings = FlightSettings {
    ground_station_timeout: 5.0,
    fence_radius: 6.0,
    fence_height: 4.0,
    tracking_error_max: 1.5,
    ..FlightSettings::DEFAULT
};

/// A vehicle, what an operator has chosen, what the certificate says of it, and what it says of one that asks too much.
struct Vehicle {
    scenario: Scenario,
    settings: FlightSettings,
    certified: Certified,
    refused: Refused,
}

fn vehicle(name: &str) -> Vehicle {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vehicles");
    let scenario = Scenario::load(&folder.join(format!("{name}.toml"))).unwrap();
    let configuration = scenario.configuration.clone();
    let refused = Certified::new(too_agile(&configuration)).unwrap_err();
    Vehicle { certified: Certified::new(configuration).unwrap(), scenario, settings: FLIGHT_SETTINGS, refused }
}

/// The same vehicle, with references that its torques are not enough for.
fn too_agile(configuration: &Configuration) -> Configuration {
    let bounds = *configuration.bounds();
    configuration.with_bounds(ReferenceBounds { snap: 50.0 * bounds.snap, ..bounds }).unwrap()
}

fn singles() -> Vec<Case> {
    let single = |phase| Failure::ALL.map(|first| Case { phase, first, second: None, height: FLIGHT_HEIGHT });
    Phase::ALL.into_iter().flat_map(single).collect()
}

/// When the second of two failures strikes, after the first: with it, some hundred milliseconds later, seconds later.
const SECOND_FAILURE_TICKS: [Range<u64>; 3] = [0..1, 10..100, 100..500];

/// Every ordered pair of failures in every phase, each as much later as `random` has it within one of
/// [`SECOND_FAILURE_TICKS`].
pub fn pairs(random: &mut impl Rng) -> Vec<(Case, usize)> {
    let mut pairs = Vec::new();
    for phase in Phase::ALL {
        for (first, second) in Failure::ALL.into_iter().flat_map(|first| Failure::ALL.map(|second| (first, second))) {
            for (which, later) in SECOND_FAILURE_TICKS.into_iter().enumerate().filter(|_| first != second) {
                let second = Some((second, random.random_range(later)));
                pairs.push((Case { phase, first, second, height: FLIGHT_HEIGHT }, which));
            }
        }
    }
    pairs
}

fn fly_all(vehicle: &Vehicle, cases: Vec<Case>) -> Vec<Flown> {
    cases.into_par_iter().map(|case| fly(vehicle, case)).collect()
}

/// Says what went wrong, and fails if anything did.
fn judge(flown: &[Flown]) {
    let ticks: u64 = flown.iter().map(|flown| flown.ticks).sum();
    println!("{} flights, {:.0} s", flown.len(), ticks as f64 * 0.01);
    for reason in [Reason::PoseLost, Reason::LandCommanded] {
        let down = |flown: &&Flown| flown.is_gentle && (reason == Reason::PoseLost) == flown.is_by_imu();
        let speeds = flown.iter().filter(down).filter_map(|flown| flown.touchdown);
        println!("{reason:?}: touched down at {:.3} m/s at most", speeds.fold(0.0, f64::max));
    }
    let wrong: Vec<&Flown> = flown.iter().filter(|flown| !flown.complaints.is_empty()).collect();
    for flown in wrong.iter().take(40) {
        println!("{:?}: {}", flown.case, flown.complaints[0]);
        println!("    {:?}", flown.path.iter().map(|(t, s)| format!("{:?} {s:.2}", t.reason)).collect::<Vec<_>>());
    }
    assert!(wrong.is_empty(), "{} of {} flights", wrong.len(), flown.len());
}

#[test]
fn every_failure_in_every_phase_ends_as_it_must() {
    let vehicle = vehicle("study");
    let flown = fly_all(&vehicle, singles());
    report::print(&flown);
    judge(&flown);
}

/// A sixth of all pairs, chosen by a seed: each two failures in each phase once, in one order and at one distance.
#[test]
fn two_failures_end_as_the_more_severe_of_them_must() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut pairs = pairs(&mut random);
    pairs.shuffle(&mut random);
    let mut seen = HashSet::new();
    let is_new = |(case, _): &(Case, usize)| {
        let (first, second) = (case.first as u8, case.second.map_or(0, |second| second.0 as u8));
        seen.insert((case.phase as u8, first.min(second), first.max(second)))
    };
    fly_pairs(pairs.into_iter().filter(is_new).map(|(case, _)| case).collect());
}

/// Flies them, and asks that they take every row of the table that failures lead to.
pub fn fly_pairs(mut cases: Vec<Case>) {
    // A take-off that is long enough to be lost on the ground.
    cases.push(Case { phase: Phase::Spooling, first: Failure::HeldDown, second: None, height: 3.5 });
    let flown = fly_all(&vehicle("study"), cases);
    judge(&flown);
    let taken = |row: &&Row| {
        let wanted = Transition { from: row.from, to: row.to, reason: row.reason };
        row.from == row.to || flown.iter().any(|flown| flown.taken.contains(&wanted))
    };
    let (taken, left): (Vec<&Row>, Vec<&Row>) = TABLE.iter().partition(taken);
    println!("{} of the table's {} rows were taken, or lead nowhere; not these:", taken.len(), TABLE.len());
    left.iter().for_each(|row| println!("    {:?}, {:?}", row.from, row.condition));
    // A crash by the IMU alone: where the ground is level, the IMU stops fitting what is commanded 0.2 s sooner.
    let is_sooner = |row: &Row| (row.from, row.condition) == (Mode::Descending, Condition::Crashed);
    // Setpoints that lift nothing off the ground are no failure.
    let is_asked = |row: &Row| (row.from, row.condition) == (Mode::Flying, Condition::HeldOnGround);
    // What holds and loses a rotor lands turning, and crashes no more.
    let is_caught = |row: &Row| (row.from, row.condition) == (Mode::Holding, Condition::Crashed);
    let led = |row: &Row| is_sooner(row) || is_asked(row) || is_caught(row);
    let elsewhere = |row: &&Row| NOT_BY_FAILURES.contains(&row.condition) || led(row);
    assert!(left.iter().all(elsewhere), "a failure no longer leads there");
}
