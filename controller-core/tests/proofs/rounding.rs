//! Rounding: `limiter.gappa` and `rounding.gappa`. The same steps in the same order give the same bits.

use super::{TRIALS, constants, direction, rotors};
use crate::support::Random;
use crate::support::gappa::Rounding;
use controller_core::attitude_reference::Turn;
use controller_core::extended::parameters::Extended;
use controller_core::extended::thrust_range::ThrustRange;
use controller_core::extended::turning::{Circumstances, TURNED, TurningLimit};
use controller_core::position::FilterTransition;
use nalgebra::{Vector2, Vector3};

/// Anywhere in an interval, all magnitudes equally likely.
fn within([least, greatest]: [f64; 2], random: &mut Random) -> f32 {
    random.magnitude(least, greatest) as f32
}

#[test]
pub(super) fn the_limiter_rounds_as_in_the_proofs() {
    let proofs = Rounding::read("limiter.gappa");
    let [[least, greatest], y, length, square] =
        ["|x|", "|y|", "length", "x * x + y * y"].map(|quantity| proofs.interval(quantity));
    // A vector's square is within the interval where both components are.
    assert!(least * least <= square[0] && square[1] <= greatest * greatest, "{square:?}");
    let [_, most] = proofs.interval("|shortened -/ EXACT|");
    let mut random = Random(11);
    let mut shortened = 0;
    for _ in 0..TRIALS {
        let v = Vector2::new(within([least, greatest], &mut random), -within(y, &mut random));
        // The first step shortens to a part of alpha; of a vehicle at rest and upright the others do nothing.
        let alpha = within(length, &mut random);
        let mut p = constants();
        (p.turn_reserve, p.turn_rate) = (alpha, f32::MAX.sqrt());
        let turn = Turn {
            rate: Vector2::zeros(),
            acceleration: v,
            magnitude: 9.81,
            radial_rate: 0.0,
            radial_acceleration: 0.0,
        };
        let upright =
            Circumstances { budget: alpha, yaw_rate: 0.0, up: Vector3::z(), greatest: 30.0, vertical: [0.0; 3] };
        let found = TurningLimit::new(&p, 0.01).limited(&turn, &upright).acceleration;
        let length = TURNED * alpha;
        if f64::from(length) < proofs.interval("length")[0] || found == v {
            continue;
        }
        shortened += 1;
        for (component, other, found) in [(v.x, v.y, found.x), (v.y, v.x, found.y)] {
            // Either component first: a sum of two does not depend on their order.
            let inputs = [("x", component), ("y", other), ("length", length)];
            assert_eq!(f64::from(found), proofs.number("shortened", &inputs), "{v} to {length}");
            let exact = proofs.number("EXACT", &inputs);
            let error = (f64::from(found) / exact - 1.0).abs();
            assert!(error <= most, "{v} to {length}: {error}");
        }
    }
    assert!(shortened > TRIALS / 4, "{shortened} of {TRIALS} shortened");
}

#[test]
pub(super) fn floor_ceiling_and_filters_round_as_in_the_proofs() {
    let proofs = Rounding::read("rounding.gappa");
    let [least_margin, greatest_margin] = proofs.interval("margin");
    let [of_floor, of_ceiling] = ["|n - N|", "|c - C|"].map(|error| proofs.interval(error)[1]);
    // The least margin is one of those for which it is proven, and takes up both errors. Units are those of the proof.
    let least = f64::from(Extended::FLOOR_MARGIN_LEAST);
    assert!((least_margin..=greatest_margin).contains(&least));
    assert!(of_floor + of_ceiling < least, "{of_floor} {of_ceiling} of {least}");

    let [_, part] = proofs.interval("scale * greatest");
    assert_eq!(part, proofs.interval("scale * least")[1]);
    let torques = ["b_1 * t_1", "DOT"].map(|part| proofs.interval(part));
    assert!(torques.iter().all(|&[least, greatest]| (least, greatest) == (-part, part)));

    let (rotors, mut random) = (rotors(), Random(12));
    let thrust = rotors.iter().zip(rotors.pseudo_inverse()).map(|(rotor, row)| f64::from(rotor.thrust_max) / row.x);
    let thrust = 1.5 * thrust.fold(0.0, f64::max);
    // The power of two below it.
    let unit = thrust.log2().floor().exp2();
    for _ in 0..TRIALS {
        let torque = direction(&mut random);
        let scale = random.within(0.5, 1.5) as f32;
        let margin = (thrust * random.magnitude(least, 0.5)) as f32;
        let range = ThrustRange::new(Some(&rotors), margin, 1e6);
        let (mut floor, mut ceiling) = (f64::from(margin), 1e6_f64);
        for (rotor, row) in rotors.iter().zip(rotors.pseudo_inverse()) {
            let ends = [rotor.thrust_min, rotor.thrust_max].map(|end| (f64::from(end) / row.x) as f32);
            let b = [row.y, row.z, row.w].map(|of_torque| (of_torque / row.x) as f32);
            let inputs = [
                ("scale", scale),
                ("margin", margin),
                ("least", ends[0]),
                ("greatest", ends[1]),
                ("b_1", b[0]),
                ("b_2", b[1]),
                ("b_3", b[2]),
                ("t_1", torque.x),
                ("t_2", torque.y),
                ("t_3", torque.z),
            ];
            let [n, exact_n, c, exact_c] = ["n", "N", "c", "C"].map(|formula| proofs.number(formula, &inputs));
            let parts = [f64::from(scale * ends[1]), proofs.number("DOT", &inputs)];
            if parts.iter().all(|size| size.abs() <= part * unit) {
                assert!((n - exact_n).abs() <= of_floor * unit && (c - exact_c).abs() <= of_ceiling * unit);
            }
            (floor, ceiling) = (floor.max(n), ceiling.min(c));
        }
        assert_eq!(f64::from(range.least(&torque, scale)), floor, "{torque} {scale} {margin}");
        assert_eq!(f64::from(range.greatest(&torque, scale)), ceiling, "{torque} {scale} {margin}");
    }

    let [[least, greatest], [least_v, greatest_v], [_, whole]] = ["u", "v", "k"].map(|name| proofs.interval(name));
    let [_, most] = proofs.interval("|next - NEXT|");
    for _ in 0..TRIALS {
        let [u, v] = [(least, greatest), (least_v, greatest_v)].map(|(low, high)| random.within(low, high) as f32);
        let bandwidth = random.magnitude(0.2, 100.0) as f32;
        let transition = FilterTransition::new(1.0, bandwidth, 0.1).unwrap();
        // What it makes of zero and one is the weight itself.
        let (_, k) = transition.advance_axis(0.0, 0.0, 1.0);
        assert!(f64::from(k) <= whole);
        let (_, next) = transition.advance_axis(0.0, u, v);
        let inputs = [("u", u), ("v", v), ("k", k)];
        assert_eq!(f64::from(next), proofs.number("next", &inputs), "from {u} to {v} by {k}");
        assert!((f64::from(next) - proofs.number("NEXT", &inputs)).abs() <= most);
    }
}
