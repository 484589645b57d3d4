//! Recoveries of the Hummingbird: what is drawn, flown and found again.

use super::*;
use crate::studies::campaign::draw::Drawn;
use controller_core::certificate::certified::Certified;
use nalgebra::Vector3;
use start::Start;

const HUMMINGBIRD: &str = include_str!("../../../../vehicles/hummingbird.toml");

pub(super) fn hummingbird() -> Scenario {
    Scenario::parse(HUMMINGBIRD, "f").unwrap()
}

pub(super) fn flyer(sets: &Sets) -> Flyer {
    let scenario = hummingbird();
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    Flyer::new(&certified, &scenario.loop_timing(), sets, RADIUS_UNPROVEN_M).unwrap()
}

/// Small tolerances: their proof is quick.
pub(super) fn sets() -> Sets {
    Sets { lag: 0.02, inertia: 0.01, ..Sets::default() }
}

const FEW: Orders = Orders { flights: 60, search: 40, seed: 7 };

fn report(orders: &Orders, threads: usize) -> Report {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| recovery(&hummingbird(), &sets(), orders, &Interrupt::default())).unwrap()
}

#[test]
fn the_same_seed_finds_the_same_whatever_the_number_of_threads() {
    let one = report(&FEW, 1).to_string();
    assert_eq!(one, report(&FEW, 3).to_string());
    assert_ne!(one, report(&Orders { seed: 8, ..FEW }, 1).to_string());
}

#[test]
fn a_search_finds_worse_than_the_flights_that_it_climbs_from() {
    let (searched, flown) = (report(&Orders { search: 300, ..FEW }, 2), report(&Orders { search: 0, ..FEW }, 2));
    assert!(searched.height.worst() > flown.height.worst(), "{searched}{flown}");
    assert!(searched.time.worst() > flown.time.worst(), "{searched}{flown}");
}

#[test]
fn starts_stay_within_the_sets_however_they_are_changed() {
    let (sets, vehicle) = (Sets::default(), *hummingbird().configuration.vehicle());
    let mut drawn = Drawn::new(3, 0);
    for number in 0..20 {
        let mut start = Start::drawn(&sets, &vehicle, 3, number);
        for _ in 0..50 {
            assert!((start.attitude.norm() - 1.0).abs() < 1e-9);
            assert!(start.rates.norm() <= sets.spin + 1e-9 && start.velocity.norm() <= sets.speed + 1e-9);
            assert!((start.lag - 1.0).abs() <= sets.lag + 1e-9);
            assert!(start.inertia.iter().all(|factor| (factor - 1.0).abs() <= sets.inertia + 1e-9));
            assert!(start.gust.axis < 3 && start.gust.steps.iter().all(|step| step.share.abs() <= 1.0));
            assert!(start.gust.steps.is_sorted_by_key(|step| step.from));
            let ends = start.clone().at_the_ends(&sets);
            assert!((ends.rates.norm() - sets.spin).abs() < 1e-9 && (ends.velocity.norm() - sets.speed).abs() < 1e-9);
            start = start.mutated(&sets, &vehicle, &mut drawn, 1.0);
        }
    }
}

#[test]
fn a_gust_at_rest_takes_the_vehicle_away() {
    let flyer = flyer(&Sets { gust: 1.0, ..Sets::default() });
    let interrupt = Interrupt::default();
    let beside = |flyer: &Flyer, gusts| {
        let orders = Orders { search: 0, ..FEW };
        tube::beside_gusts(flyer, gusts, &orders, &Work::new(0, &interrupt)).unwrap_or_else(|_| panic!("interrupted"))
    };
    let second = [1.0; 100];
    let one = beside(&flyer, [&second, &[], &[]]);
    assert!(one.alone > 0.01 && one.alone < 0.5 && one.alone == one.together, "{one:?}");
    let all = beside(&flyer, [&second, &second, &second[..50]]);
    assert!(all.alone >= one.alone && all.together > 1.3 * all.alone, "{all:?}");
    let none = beside(&flyer, [&[0.0; 100], &[], &[]]);
    assert!(none.together < 1e-3, "{none:?}");
    let sure = self::flyer(&Sets { gust: 1.0, lag: 0.0, inertia: 0.0, ..Sets::default() });
    assert!(beside(&sure, [&second, &[], &[]]).alone < one.alone);
}

#[test]
fn what_cannot_be_judged_is_refused_by_name() {
    let refused = |text: &str| {
        let scenario = Scenario::parse(text, "f").unwrap();
        recovery(&scenario, &sets(), &FEW, &Interrupt::default()).unwrap_err().to_string()
    };
    assert!(refused(scenario::PAPER).starts_with("control.law: "));
    let without_rotors = HUMMINGBIRD.split_once("[rotors]").unwrap().0;
    assert!(refused(without_rotors).starts_with("rotors: "));
    let slow = HUMMINGBIRD.replace("yaw_acceleration = 6.0 ", "yaw_acceleration = 3.0 ");
    assert!(refused(&slow).starts_with("not certified: "));
}

#[test]
fn a_signal_ends_it() {
    let interrupt = Interrupt::default();
    interrupt.ask();
    let refused = recovery(&hummingbird(), &sets(), &FEW, &interrupt).unwrap_err();
    assert!(matches!(refused, Refused::Interrupted(2)), "{refused}");
}

#[test]
fn a_gust_is_what_its_last_step_says() {
    let step = |from, share| gust::Step { from, share };
    let gust = gust::Gust { axis: 1, steps: vec![step(0.0, 1.0), step(0.5, -1.0)] };
    assert_eq!(gust.at(0.1), Vector3::new(0.0, 1.0, 0.0));
    assert_eq!(gust.at(0.5), Vector3::new(0.0, -1.0, 0.0));
    assert_eq!(gust::Gust::NONE.at(0.3), Vector3::zeros());
    assert_eq!(gust.until(0.3).to_string(), "y 1.000 at 0.000 s");
}
