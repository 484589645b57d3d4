extern crate std;
use super::*;
use crate::PERIOD_US;
use crate::chain::{Chain, Memory};
use crate::hummingbird;
use controller_core::certificate::certified::Certified;
use controller_core::governor::GovernorLimits;
use controller_core::heading::Heading;
use controller_core::state::State;
use nalgebra::{Quaternion, Vector3};
use std::boxed::Box;
use std::vec::Vec;

/// The ticks at which a share over the ticks is reported.
fn reported(share: impl Fn(u64) -> Option<f32>, ticks: u64) -> Vec<u64> {
    let mut check = ThrustCheck::default();
    (0..ticks).filter(|&tick| check.tick(share(tick), tick * PERIOD_US).is_some()).collect()
}

#[test]
fn a_share_that_stays_doubtful_is_reported_every_ten_seconds() {
    for share in [0.84, 1.16, f32::NAN] {
        assert_eq!(reported(|_| Some(share), 2_400), [300, 1_300, 2_300]);
    }
}

#[test]
fn a_share_that_is_right_or_passes_or_is_not_flown_is_not_reported() {
    assert!(reported(|_| Some(0.86), 2_000).is_empty());
    assert!(reported(|tick| Some(if tick % 290 == 0 { 1.0 } else { 0.7 }), 2_000).is_empty());
    assert!(reported(|_| None, 2_000).is_empty());
}

/// The seconds at which the check reports, and the last share, in 30 s of hover whose rotors deliver `share` of the
/// commanded thrust, in vertical wind that accelerates the vehicle by `push` of the time, m/s^2.
fn hover(share: f32, push: impl Fn(f32) -> f32) -> (Vec<u64>, f32) {
    const GRAVITY_M_PER_S2: f32 = 9.81;
    let certified = Certified::new(hummingbird::extended_law()).unwrap();
    let mass = certified.configuration().vehicle().mass;
    let memory = Box::leak(Box::new(Memory::EMPTY));
    let mut chain = Chain::new(&certified, &GovernorLimits::default(), PERIOD_US, memory).unwrap();
    chain.start(&Vector3::zeros(), &Heading::FORWARD).unwrap();
    chain.rise(1.0).unwrap();
    let (zero, attitude) = (Vector3::zeros(), Quaternion::new(1.0, 0.0, 0.0, 0.0));
    let mut state = State { position: zero, velocity: zero, attitude, angular_velocity: zero };
    let mut check = ThrustCheck::default();
    let mut reports = Vec::new();
    let period = PERIOD_US as f32 * 1e-6;
    for tick in 0..3_000_u64 {
        let flown = chain.fly(&state).map(|_| chain.delivered_share());
        if check.tick(flown.ok(), tick * PERIOD_US).is_some() {
            reports.push(tick / 100);
        }
        let thrust: f32 = chain.thrusts().unwrap().iter().sum();
        let made = share * thrust / mass + push(tick as f32 * period) - GRAVITY_M_PER_S2;
        // The ground carries what the rotors do not.
        let acceleration = if state.position.z > 0.0 { made } else { made.max(0.0) };
        state.velocity.z += period * acceleration;
        state.position.z += period * state.velocity.z;
    }
    assert!((state.position.z - 1.0).abs() < 0.2, "{} m", state.position.z);
    (reports, chain.delivered_share())
}

#[test]
fn rotors_that_deliver_too_little_or_too_much_in_hover_are_reported_with_their_share() {
    for share in [0.6, 0.75, 1.3] {
        let (reports, found) = hover(share, |_| 0.0);
        assert!(reports.first().is_some_and(|&second| second < 10), "{share}: {reports:?}");
        assert!((found - share).abs() < 0.02, "{share}: {found}");
    }
}

#[test]
fn a_healthy_vehicle_in_vertical_wind_is_not_reported() {
    let gusts = |time: f32| 0.7 + 0.7 * (0.5 * time).sin() + 0.7 * (2.1 * time).sin();
    for side in [0.0, 1.0, -1.0] {
        for share in [0.95, 1.0, 1.05] {
            let (reports, found) = hover(share, |time| side * gusts(time));
            assert!(reports.is_empty(), "{side}, {share}: {reports:?}, {found}");
        }
    }
}
