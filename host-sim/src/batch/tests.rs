//! Flights side by side against the same flights alone, to the bit.

use super::*;
use crate::campaign::draw::circumstances;
use crate::campaign::step;
use controller_core::certificate::certified::Certified;
use scenario::Scenario;
use scenario::body::BodyState;
use scenario::campaign::Asked;

/// Flights of the paper's scenario from random states, with noisy sensors, for 2 s.
fn thrown(numbers: std::ops::Range<u64>) -> Vec<Flight> {
    let mut scenario = step::longest(&Scenario::paper().unwrap());
    scenario.campaign.ranges.reference = Asked::File;
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let one = |number| {
        let thrown = circumstances(&scenario, &scenario.campaign.ranges, 3, number);
        Flight::certified(&thrown, &certified).unwrap()
    };
    numbers.map(one).collect()
}

/// What a flight shows of a tick, as bits.
fn bits(brief: &Brief) -> (u64, Vec<u64>, Vec<u32>, bool) {
    let BodyState { position, velocity, attitude, angular_velocity } = &brief.state;
    let numbers = position.iter().chain(velocity).chain(&attitude.coords).chain(angular_velocity);
    let wrench = [&brief.wrench.thrust].into_iter().chain(&brief.wrench.torque);
    (brief.time_us, numbers.map(|x| x.to_bits()).collect(), wrench.map(|x| x.to_bits()).collect(), brief.clipped)
}

fn side_by_side(processor: Arch, flights: Vec<Flight>) -> Batch {
    Batch::new(processor, flights).unwrap_or_else(|flights| panic!("{} flights that could not", flights.len()))
}

#[test]
fn flights_side_by_side_have_the_bits_of_each_alone_on_all_that_this_processor_has() {
    let mut processors = vec![Arch::Scalar, Arch::new()];
    #[cfg(target_arch = "x86_64")]
    processors.extend(pulp::x86::V3::try_new().map(Arch::V3));
    let flights = thrown(0..11);
    for processor in processors {
        let (mut batch, mut alone) = (side_by_side(processor, flights.clone()), flights.clone());
        for _ in 0..200 {
            let mut seen = 0;
            batch.tick(|number, brief| {
                assert_eq!(bits(brief.unwrap()), bits(&alone[number].brief_tick().unwrap()), "{processor:?}, {number}");
                seen += 1;
            });
            assert_eq!(seen, flights.len());
        }
    }
}

#[test]
fn a_flight_that_cannot_go_on_ends_as_it_does_alone_and_leaves_the_others_alone() {
    let paper = Scenario::paper().unwrap();
    let mut lost = paper.clone();
    lost.initial.position.x = 1e20; // beyond what the law takes
    let [good, bad] = [&paper, &lost].map(|scenario| Flight::uncertified(scenario).unwrap());
    let mut batch = side_by_side(Arch::new(), vec![good.clone(), bad.clone(), good.clone()]);
    let mut seen = [0; 3];
    for tick in 0..3 {
        let mut alone = good.clone();
        (0..tick).for_each(|_| drop(alone.brief_tick().unwrap()));
        batch.tick(|number, brief| {
            seen[number] += 1;
            match brief {
                Ok(brief) => assert_eq!(bits(brief), bits(&alone.clone().brief_tick().unwrap())),
                Err(error) => assert_eq!((number, Some(error)), (1, bad.clone().brief_tick().err())),
            }
        });
    }
    assert_eq!(seen, [3, 1, 3]);
}

#[test]
fn what_cannot_fly_side_by_side_is_given_back() {
    let paper = Scenario::paper().unwrap();
    let study = Scenario::parse(include_str!("../../../vehicles/study.toml"), "study").unwrap();
    let mut ahead = Flight::new(&paper).unwrap();
    ahead.brief_tick().unwrap();
    let finer = step::halved(&paper).unwrap();
    let first = || Flight::new(&paper).unwrap();
    for (other, why) in [
        (Flight::new(&study).unwrap(), "rotors"),
        (ahead, "another time"),
        (Flight::new(&finer).unwrap(), "another plant step"),
        (Flight::new(&Scenario::paper().unwrap()).unwrap(), "another reference"),
    ] {
        let given_back = Batch::new(Arch::new(), vec![first(), other]).err();
        assert_eq!(given_back.map(|flights| flights.len()), Some(2), "{why}");
    }
    assert!(Batch::new(Arch::new(), vec![]).is_err());
    assert!(Batch::new(Arch::new(), vec![first(), first()]).is_ok());
}
