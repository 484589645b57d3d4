//! Steps that fit, and how far the paper's flight moves with a long one.

use super::*;
use crate::flight::Flight;

fn vehicle(name: &str, sections: &str) -> Scenario {
    let text = match name {
        "study" => scenario::STUDY,
        "hummingbird" => include_str!("../../../../../vehicles/hummingbird.toml"),
        _ => scenario::PAPER,
    };
    Scenario::parse(&format!("{text}\n{sections}"), "f").unwrap()
}

#[test]
fn the_longest_step_that_fits_is_taken() {
    let taken = |scenario: &Scenario| {
        (with_longest_step(scenario).timing.steps_per_tick, with_longest_step(scenario).delay_steps)
    };
    assert_eq!(taken(&vehicle("paper", "")), (2, 0));
    assert_eq!(taken(&vehicle("study", "")), (2, 2));
    let mut late = vehicle("study", "");
    late.delay_steps = 4;
    assert_eq!(taken(&late), (5, 2), "4 ms of delay are no whole number of 5 ms");
    assert_eq!(taken(&vehicle("hummingbird", "[estimator]\n")), (10, 0), "the IMU's millisecond");
    let mut spinning = vehicle("paper", "");
    spinning.campaign.ranges.rate = 150.0;
    assert_eq!(taken(&spinning), (3, 0), "half a radian a step");
    let half = with_step(&vehicle("study", ""), 2.5e-3).unwrap();
    assert_eq!((half.timing.steps_per_tick, half.delay_steps), (4, 4));
}

/// With the step of a campaign the paper's flight stays within a micrometre of the same flight in steps of half a
/// millisecond.
#[test]
fn the_papers_flight_moves_by_less_than_a_micrometre() {
    let fine = divided(&vehicle("paper", ""), 20).unwrap();
    let coarse = with_longest_step(&fine);
    assert_eq!((fine.timing.step(), coarse.timing.step()), (5e-4, 5e-3));
    let (mut fine, mut coarse) = (Flight::new(&fine).unwrap(), Flight::new(&coarse).unwrap());
    let mut greatest = 0.0_f64;
    for _ in 0..4000 {
        let (a, b) = (fine.tick().unwrap(), coarse.tick().unwrap());
        greatest = greatest.max((a.state.position - b.state.position).norm());
    }
    println!("greatest distance {greatest:e} m");
    assert!(greatest > 0.0 && greatest < 1e-6, "{greatest:e} m");
}
