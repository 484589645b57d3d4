extern crate std;
use super::super::tests::TYPICAL;
use super::super::{GovernorLimits, tests::Random};
use super::*;
use std::vec::Vec;

fn windows() -> Windows {
    Windows::design(&TYPICAL, &GovernorLimits::default(), 0.01).unwrap()
}

/// At rest at the origin.
fn smoother(windows: &Windows) -> Smoother {
    let mut smoother = Smoother::NONE;
    smoother.design(windows, 0.01);
    smoother
}

/// Three averages of the commands, run one after another in floating point.
fn averaged(commands: &[f64], lengths: [usize; 3]) -> Vec<f64> {
    let mut signal = commands.to_vec();
    for length in lengths {
        signal = (0..signal.len())
            .map(|k| (0..length).map(|i| if k >= i { signal[k - i] } else { 0.0 }).sum::<f64>() / length as f64)
            .collect();
    }
    signal
}

#[test]
fn the_comb_and_its_sums_are_three_moving_averages() {
    let windows = windows();
    let mut smoother = smoother(&windows);
    let mut random = Random::new(5);
    let commands: Vec<i32> = (0..1_500).map(|_| (random.signed() * 60_000.0) as i32).collect();
    let expected = averaged(&commands.iter().map(|&c| f64::from(c)).collect::<Vec<_>>(), windows.lengths);
    for (command, expected) in commands.iter().zip(&expected) {
        smoother.push(&Vector3::new(*command, -command, 0));
        let average = smoother.axes[0].difference[1] as f64 / windows.product() as f64;
        assert!((average - expected).abs() < 1e-6, "{average} against {expected}");
    }
}

#[test]
fn a_steady_motion_comes_out_as_it_went_in() {
    let windows = windows();
    let mut smoother = smoother(&windows);
    let unit = windows.per_metre;
    smoother.start(&Vector3::new(unit as i64 * 3, 0, -(unit as i64)), &Vector3::new(0, (unit * 0.02) as i64, 0));
    for tick in 0..2_000 {
        let knot = smoother.knot();
        assert_eq!((knot.position.x, knot.position.z), (3.0, -1.0));
        assert!((knot.position.y - 0.02 * tick as f32).abs() < 1e-5, "{} at {tick}", knot.position.y);
        assert!((knot.velocity.y - 2.0).abs() < 1e-6 && knot.acceleration.norm() == 0.0);
        smoother.push(&Vector3::zeros());
    }
}

#[test]
fn a_million_ticks_of_noise_leave_no_trace() {
    let windows = windows();
    let mut smoother = smoother(&windows);
    let mut random = Random::new(6);
    for _ in 0..1_000_000 {
        let speed = smoother.speed().x as f32 / 1e7;
        smoother.push(&Vector3::new(((random.signed() - speed) * 30_000.0) as i32, 0, 0));
    }
    let steps = 100;
    let (whole, rest) = (smoother.speed().x / steps, smoother.speed().x % steps);
    for step in 0..steps {
        smoother.push(&Vector3::new(-(whole + i64::from(step == 0) * rest) as i32, 0, 0));
    }
    for _ in 0..HISTORY {
        smoother.push(&Vector3::zeros());
    }
    assert!(smoother.at_rest());
}
