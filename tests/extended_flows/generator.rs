//! The generator of the force estimate, section 2: never beyond its levels, at ticks up to k_d h = 0.6.

use crate::support::extended::EXAMPLE;
use crate::support::random;
use controller_core::extended::force::{ForceEstimate, ForceGenerator};
use controller_core::extended::parameters::EstimateParameters;
use nalgebra::Vector3;
use rand::RngExt;

#[test]
fn the_force_estimate_never_leaves_its_levels_up_to_the_longest_ticks() {
    let mut rng = random::generator(321);
    let (mut closest, period) = ([0.0_f32; 3], 0.01);
    for number in 0..3_000 {
        let share = if number % 3 == 0 { 1.0 } else { rng.random_range(0.02..1.0) };
        let bandwidth = ForceGenerator::STEP_MAX / period * share;
        let level = random::log_uniform(&mut rng, 0.1, 10.0);
        // The rate's limit reached at once, now and then, or never.
        let snap = level * bandwidth * bandwidth * random::log_uniform(&mut rng, 0.02, 10.0);
        let parameters = EstimateParameters {
            force_across: level,
            force_vertical: 0.5 * level,
            force_bandwidth_across: bandwidth,
            force_bandwidth_vertical: bandwidth,
            force_snap_across: snap,
            force_snap_vertical: snap,
            ..EXAMPLE.estimates
        };
        let generator = ForceGenerator::new(&parameters, period).unwrap();
        let (mut estimate, mut input, mut left) = (ForceEstimate::NONE, Vector3::zeros(), 0);
        for tick in 0..2_000 {
            if left == 0 {
                left = 1 + random::log_uniform(&mut rng, 1.0, 200.0) as u32;
                input = if rng.random_bool(0.7) {
                    Vector3::from_fn(|_, _| if rng.random_bool(0.5) { level } else { -level } * 2.0)
                } else {
                    random::vector(&mut rng, level)
                };
            }
            left -= 1;
            estimate.average = input;
            let second = generator.acceleration(&estimate);
            estimate = generator.advanced(&estimate, &second);
            for axis in 0..3 {
                let most = if axis == 2 { 0.5 * level } else { level };
                let shares = [
                    estimate.value[axis].abs() / most,
                    estimate.rate[axis].abs() * bandwidth / snap,
                    second[axis].abs() / snap,
                ];
                let within = shares.iter().all(|share| *share <= 1.0 + 1e-5);
                assert!(within, "{shares:?} of the levels on axis {axis}, tick {tick}, k_d h {}", bandwidth * period);
                for (closest, share) in closest.iter_mut().zip(shares) {
                    *closest = closest.max(share);
                }
            }
        }
    }
    println!("closest to the levels of d, d' and d'': {closest:?}");
    assert!(closest.iter().all(|share| *share > 0.999), "{closest:?}");
}

#[test]
fn ticks_that_are_too_long_for_the_generator_are_refused() {
    let parameters = EstimateParameters { force_bandwidth_across: 61.0, ..EXAMPLE.estimates };
    let refused = ForceGenerator::new(&parameters, 0.01).unwrap_err();
    assert_eq!(refused.field, "estimates.force_bandwidth_across");
}
