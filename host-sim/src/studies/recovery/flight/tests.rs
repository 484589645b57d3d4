//! What a flight shows, of motions made by hand and of the law's.

use super::super::gust::{Gust, Step};
use super::super::tests::flyer;
use super::*;
use nalgebra::Quaternion;

/// Full thrust over mass of the Hummingbird's rotors, m/s^2, rounded up.
const THRUST_PER_MASS_MAX_M_PER_S2: f64 = 101.0;

#[test]
fn an_outcome_is_what_a_motion_made_by_hand_shows() {
    let mut outcome = Outcome::BEGUN;
    let motion = [[0.4, 0.0, -0.1], [0.6, 0.0, -1.5], [0.3, 0.0, -0.9], [0.0, 0.0, 0.15], [0.4, 0.0, 0.2]];
    for (tick, position) in motion.into_iter().enumerate() {
        outcome.see(tick as f64, &Vector3::from(position), 0.5);
    }
    assert_eq!((outcome.height_lost, outcome.lowest_at, outcome.settled_after), (1.5, 1.0, Some(3.0)));
    assert_eq!(outcome.farthest, Vector3::new(0.6, 0.0, -1.5).norm());
    outcome.see(5.0, &Vector3::new(0.0, -0.6, 0.0), 0.5);
    assert_eq!((outcome.settled_after, outcome.distance_at_end), (None, 0.6));
}

#[test]
fn a_vehicle_at_rest_is_back_at_once_and_a_dive_costs_no_less_than_full_thrust_allows() {
    let flyer = flyer(&Sets { gust: 1.0, ..Sets::default() });
    let rest = flyer.flown(&Start::at_rest());
    assert!(rest.height_lost < 1e-3 && rest.settled_after == Some(0.0), "{rest:?}");
    let dive = Start { velocity: Vector3::new(0.0, 0.0, -6.0), ..Start::at_rest() };
    let flown = flyer.flown(&dive);
    let least = 18.0 / (THRUST_PER_MASS_MAX_M_PER_S2 - 9.81);
    assert!(flown.height_lost > least && flown.height_lost < 4.0, "{flown:?}");
    assert!(flown.settled_after.is_some_and(|time| time > flown.lowest_at), "{flown:?}");
    let pushed = Start { gust: Gust { axis: 2, steps: vec![Step { from: 0.0, share: -1.0 }] }, ..dive };
    let pushed = flyer.flown(&pushed);
    assert!(pushed.height_lost > flown.height_lost + 1e-3, "{pushed:?}, {flown:?}");
}

#[test]
fn lag_inertia_and_force_that_the_law_does_not_know_change_the_flight() {
    let flyer = flyer(&Sets { gust: 1.0, ..Sets::default() });
    let (attitude, rates) = (Quaternion::new(0.1, 0.7, 0.7, 0.1).normalize(), Vector3::new(4.0, 1.0, 0.0));
    let start = Start { attitude, rates, ..Start::at_rest() };
    let others = [
        Start { lag: 1.3, ..start.clone() },
        Start { inertia: Vector3::new(1.1, 1.0, 1.0), ..start.clone() },
        Start { gust: Gust { axis: 0, steps: vec![Step { from: 0.0, share: 1.0 }] }, ..start.clone() },
    ];
    let flown = flyer.flown(&start);
    for other in others {
        assert!((flyer.flown(&other).farthest - flown.farthest).abs() > 1e-4, "{other:?}");
    }
}
