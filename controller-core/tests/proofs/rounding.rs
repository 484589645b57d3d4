//! Rounding: `Rounding.v`, `limiter.gappa`, `filters.gappa`. The same steps in the same order give the same bits.

use super::tick::{budget, certificate};
use super::{TRIALS, constants, direction, of, rotors};
use crate::support::Random;
use crate::support::coq::Proofs;
use crate::support::gappa::Rounding;
use controller_core::allocation::MinimumNorm;
use controller_core::attitude_reference::Turn;
use controller_core::certificate::form::ARITHMETIC_ALLOWANCE;
use controller_core::extended::budget::ROOM_LEFT;
use controller_core::extended::parameters::Extended;
use controller_core::extended::thrust_range::ThrustRange;
use controller_core::extended::turning::{Circumstances, TURNED, TurningLimit};
use controller_core::position::FilterTransition;
use controller_core::state::Wrench;
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
pub(super) fn a_rotors_command_rounds_as_in_the_proofs() {
    let proofs = Proofs::read("Rounding");
    let [unit, margin_least] = ["unit", "margin_least"].map(|name| proofs.number(name, &[]));
    assert!(unit > 0.5 * f64::from(f32::EPSILON) * (1.0 + f64::from(f32::EPSILON)), "{unit}");
    assert!(margin_least < f64::from(Extended::FLOOR_MARGIN_LEAST), "{margin_least}");
    let tiny = proofs.number("tiny", &[]);
    assert!(tiny > 0.5 * f64::from(f32::from_bits(1)) * (1.0 + f64::from(f32::EPSILON)), "{tiny}");
    the_slack_is_there(proofs.number("slack", &[]));

    let (rotors, mut random) = (rotors(), Random(12));
    let allocation = MinimumNorm::new(&rotors);
    let mut delivered = 0;
    for _ in 0..TRIALS {
        let torque = 0.2 * direction(&mut random);
        let scale = random.within(0.5, 1.5) as f32;
        let margin = random.magnitude(1e-5, 1.0) as f32;
        let range = ThrustRange::new(Some(&rotors), margin, 1e6);
        let wrench = Wrench { thrust: random.within(5.0, 15.0) as f32, torque };
        let allocated = allocation.allocate(&wrench.scaled(1.0 / scale)).unwrap();
        delivered += usize::from(!allocated.clipped);
        let asked = [
            ("s", scale),
            ("T", wrench.thrust),
            ("t_1", torque.x),
            ("t_2", torque.y),
            ("t_3", torque.z),
            ("margin", margin),
        ];
        let greatest = rotors.iter().map(|rotor| rotor.thrust_max).sum::<f32>() * 1.5;
        let (mut floor, mut ceiling) = (f64::from(margin), 1e6_f64);
        for ((rotor, row), thrust) in rotors.iter().zip(rotors.pseudo_inverse()).zip(allocated.thrusts) {
            let proofs = Proofs::read("Rounding")
                .with(&of(&asked))
                .with(&of(&[("thrust_min", rotor.thrust_min), ("thrust_max", rotor.thrust_max)]))
                .with(&[("B", row.x), ("Q_1", row.y / row.x), ("Q_2", row.z / row.x), ("Q_3", row.w / row.x)]);
            let proofs = proofs.with(&of(&[("G", greatest)]));
            for quantity in ["s", "B", "G"] {
                assert!(proofs.sides("sizes", &format!("<= {quantity} <=")).is_sorted(), "{quantity}");
            }
            for x in [row.y / row.x, row.z / row.x, row.w / row.x].into_iter().chain(torque.cast().iter().copied()) {
                assert!(proofs.clone().with(&[("x", x)]).sides("within", "Rabs x <=").is_sorted(), "{x}");
            }
            floor = floor.max(proofs.number("floor", &[]));
            ceiling = ceiling.min(proofs.number("ceiling", &[]));
            if !allocated.clipped {
                assert_eq!(f64::from(thrust), proofs.number("command", &[]), "{wrench:?} {scale}");
            }
        }
        assert_eq!(f64::from(range.least(&torque, scale)), floor, "{torque} {scale} {margin}");
        assert_eq!(f64::from(range.greatest(&torque, scale)), ceiling, "{torque} {scale} {margin}");
    }
    assert!(delivered > TRIALS / 4, "{delivered} of {TRIALS} within the rotors' ranges");
}

/// What the certificate and a tick leave of the rotors' rows is more than rounding takes.
fn the_slack_is_there(slack: f64) {
    let (budget, certificate, rotors) = (budget(), certificate(), rotors());
    let ends = rotors.iter().zip(rotors.pseudo_inverse()).map(|(rotor, row)| f64::from(rotor.thrust_max) / row.x);
    let greatest = f64::from(constants().scale_greatest) * ends.fold(0.0, f64::max);
    for (row, name) in budget.rows.iter().skip(2).zip(["R ", "T1 thrust floor"]) {
        let required = super::tick::row(&certificate, name).required;
        let by_the_certificate = required * (1.0 - 1.0 / (1.0 + ARITHMETIC_ALLOWANCE));
        assert!(slack * greatest < by_the_certificate.min(ROOM_LEFT * row.room), "{name}: {slack} of {greatest}");
    }
}

#[test]
pub(super) fn filters_round_as_in_the_proofs() {
    let (proofs, mut random) = (Rounding::read("filters.gappa"), Random(13));
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
