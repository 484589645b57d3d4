//! Rounding: `Rounding.v`, `limiter.gappa`, `filters.gappa`. The same steps in the same order give the same bits.

use super::tick::{budget, used};
use super::{TRIALS, as_f64, constants, direction, rotors, signed};
use crate::support::coq::Proofs;
use crate::support::gappa::Rounding;
use crate::support::{Random, hummingbird};
use controller_core::allocation::{MinimumNorm, Rotor, Rotors, Spin};
use controller_core::attitude_reference::DirectionMotion;
use controller_core::extended::direction_limiter::DirectionLimiter;
use controller_core::extended::parameters::{Extended, ExtendedParameters};
use controller_core::extended::thrust_range::ThrustRange;
use controller_core::position::FilterTransition;
use nalgebra::{Vector2, Vector3, Vector4};

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
    // What a tick leaves unused of a row is a thousand times as much.
    assert!(1.0 - used() > 1000.0 * most, "{most}");
    let mut random = Random(11);
    let mut shortened = 0;
    for _ in 0..TRIALS {
        let v = Vector2::new(within([least, greatest], &mut random), -within(y, &mut random));
        // The first step shortens to alpha; of a vehicle at rest and upright the others do nothing.
        let alpha = within(length, &mut random);
        let p = ExtendedParameters { turn_rate: f32::MAX.sqrt(), ..constants() };
        let turn = DirectionMotion {
            rate: Vector2::zeros(),
            acceleration: v,
            magnitude: 9.81,
            radial_rate: 0.0,
            radial_acceleration: 0.0,
        };
        let found = DirectionLimiter::new(&p, alpha, 0.01).limited(&turn, &Vector3::z());
        if found == v {
            continue;
        }
        shortened += 1;
        for (component, other, found) in [(v.x, v.y, found.x), (v.y, v.x, found.y)] {
            // Either component first: a sum of two does not depend on their order.
            let inputs = [("x", component), ("y", other), ("length", alpha)];
            assert_eq!(f64::from(found), proofs.number("shortened", &inputs), "{v} to {alpha}");
            let exact = proofs.number("EXACT", &inputs);
            let error = (f64::from(found) / exact - 1.0).abs();
            assert!(error <= most, "{v} to {alpha}: {error}");
        }
    }
    assert!(shortened > TRIALS / 4, "{shortened} of {TRIALS} shortened");
}

#[test]
pub(super) fn a_rotors_command_rounds_as_in_the_proofs() {
    let proofs = Proofs::read("Rounding");
    let [unit, margin_least] = ["unit", "margin_least"].map(|name| proofs.number(name, &[]));
    assert!(unit > 0.5 * f64::from(f32::EPSILON) * (1.0 + f64::from(f32::EPSILON)), "{unit}");
    assert!(margin_least < f64::from(Extended::FLOOR_MARGIN_SHARE_MIN), "{margin_least}");
    let tiny = proofs.number("tiny", &[]);
    assert!(tiny > 0.5 * f64::from(f32::from_bits(1)) * (1.0 + f64::from(f32::EPSILON)), "{tiny}");
    the_slack_is_there(proofs.number("slack", &[]));

    let (rotors, mut random) = (rotors(), Random(12));
    let allocation = MinimumNorm::new(&rotors);
    let mut delivered = 0;
    for _ in 0..TRIALS {
        let tilt = 0.2 * direction(&mut random).xy();
        let scale = random.within(0.5, 1.5) as f32;
        let margin = random.magnitude(1e-5, 0.1) as f32;
        let range = ThrustRange::new(Some(&rotors), margin, 1e6, 1.0);
        let wanted = random.within(-5.0, 30.0) as f32;
        // All of yaw that there is, either way, or none.
        let yaw = [f32::MAX, -f32::MAX, 0.0][(random.bits() % 3) as usize];
        let braking = 0.2 * signed(&mut random);
        let (wrench, room) = range.limited(wanted, &tilt, [yaw, braking], scale);
        let torque = wrench.torque;
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
        let (mut least, mut most) = (-1.0_f64, 1.0_f64);
        for ((rotor, row), thrust) in rotors.iter().zip(rotors.pseudo_inverse()).zip(allocated.thrusts) {
            let ends = [("thrust_min", rotor.thrust_min), ("thrust_max", rotor.thrust_max)];
            let proofs = Proofs::read("Rounding")
                .with(&as_f64(&asked))
                .with(&as_f64(&ends))
                .with(&as_f64(&[("G", greatest)]))
                .with(&[("B", row.x), ("Q_1", row.y / row.x), ("Q_2", row.z / row.x), ("Q_3", row.w / row.x)]);
            for quantity in ["s", "B", "G"] {
                assert!(proofs.sides("sizes", &format!("<= {quantity} <=")).is_sorted(), "{quantity}");
            }
            assert!(proofs.sides("sizes", "<= 2 * G").is_sorted(), "{torque}");
            for x in [row.y / row.x, row.z / row.x, row.w / row.x].into_iter().chain(torque.cast().iter().copied()) {
                assert!(proofs.clone().with(&[("x", x)]).sides("within", "Rabs x <=").is_sorted(), "{x}");
            }
            floor = floor.max(proofs.number("floor", &[]));
            ceiling = ceiling.min(proofs.number("ceiling", &[]));
            let [[_, min], [_, max]] = ends.map(|(name, end)| [0.0, f64::from(end)].map(|x| (name, x).1));
            let [low, high] = [(min, f64::from(margin)), (max, -f64::from(margin))]
                .map(|(end, apart)| proofs.number("end_at", &[end, apart]));
            let [low, high] = if row.w > 0.0 { [low, high] } else { [high, low] };
            (least, most) = (least.max(low), most.min(high));
            if !allocated.clipped {
                assert_eq!(f64::from(thrust), proofs.number("command", &[]), "{wrench:?} {scale}");
            }
            // The premise of the theorem, for this rotor.
            let between =
                if row.w > 0.0 { "Rmin ( end_at thrust_min margin ) 0 <=" } else { "Rmin ( end_at thrust_max" };
            assert!(proofs.sides("between_ends", between).is_sorted(), "{torque} {between}");
        }
        let (along, least, most) = (tilt.push(0.0), least.min(0.0), most.max(0.0));
        assert_eq!(f64::from(range.min_thrust(&along, scale)), floor, "{tilt} {scale} {margin}");
        assert_eq!(f64::from(range.max_thrust(&along, scale)), ceiling, "{tilt} {scale} {margin}");
        let beside = f64::from(range.max_thrust(&tilt.push(braking), scale));
        let thrust = floor.max(ceiling.min(beside)).min(floor.max(f64::from(wanted)));
        assert_eq!(f64::from(wrench.thrust), thrust, "{tilt} {scale} {margin}");
        assert_eq!(f64::from(torque.z), most.min(least.max(f64::from(yaw))), "{tilt} {scale} {margin}");
        assert_eq!(f64::from(room), most.min(-least), "{tilt} {scale} {margin}");
    }
    assert!(delivered > TRIALS / 4, "{delivered} of {TRIALS} within the rotors' ranges");
}

/// What a tick leaves of the rotors' rows is more than rounding takes.
fn the_slack_is_there(slack: f64) {
    let (p, rotors, [bottom, top]) = (constants(), rotors(), budget().ends);
    let ends = rotors.iter().zip(rotors.pseudo_inverse()).map(|(rotor, row)| f64::from(rotor.thrust_max) / row.x);
    let greatest = f64::from(p.scale_greatest) * ends.fold(0.0, f64::max);
    let margin = 2.0 * f64::from(p.floor_margin);
    let thrust_max = f64::from(super::extended_law().limits().thrust_max);
    for scale in [p.scale_least, p.scale_greatest].map(f64::from) {
        for room in [scale * (top - bottom) - margin, thrust_max - scale * bottom - margin] {
            assert!(2.0 * slack * greatest < (1.0 - used()) * room, "{slack} of {greatest} in {room}");
        }
    }
}

/// The margin is a share of a size that covers the torque's parts, for odd rotors too.
#[test]
pub(super) fn the_margins_size_is_that_of_the_proofs() {
    let mut random = Random(26);
    let mut by_parts = 0;
    for _ in 0..TRIALS / 20 {
        let rotor = |place: u8, random: &mut Random| Rotor {
            position: Vector3::new(
                (f64::from(place) * 1.6 + random.within(-0.6, 0.6)).cos() as f32,
                (f64::from(place) * 1.6 + random.within(-0.6, 0.6)).sin() as f32,
                0.0,
            ),
            spin: if place.is_multiple_of(2) { Spin::Clockwise } else { Spin::CounterClockwise },
            thrust_coefficient: 5e-6,
            drag_coefficient: 1.3e-7,
            thrust_min: 0.0,
            thrust_max: random.within(3.0, 8.0) as f32,
        };
        let all = [0, 1, 2, 3].map(|place| rotor(place, &mut random));
        let Ok(rotors) = Rotors::new(&all) else { continue };
        if rotors.pseudo_inverse().iter().any(|row| row.x < 0.02) {
            continue;
        }
        let most = |arm: fn(&Vector4<f64>) -> f64| -> f64 {
            all.iter().zip(rotors.effectiveness()).map(|(rotor, b)| f64::from(rotor.thrust_max) * arm(b).abs()).sum()
        };
        let [roll, pitch] = [most(|b| b.y), most(|b| b.z)];
        let sizes = all.iter().zip(rotors.pseudo_inverse()).map(|(rotor, row)| {
            let parts = (row.y.abs() * roll + row.z.abs() * pitch) / row.x;
            let thrust = f64::from(rotor.thrust_max) / row.x;
            let size = Proofs::read("Rounding").number("size_of", &[thrust, parts]);
            (size, size > thrust)
        });
        let (size, parts) = sizes.fold((0.0, false), |a, b| if b.0 > a.0 { b } else { a });
        by_parts += usize::from(parts);
        let p = constants();
        let least = f64::from(Extended::FLOOR_MARGIN_SHARE_MIN) * f64::from(p.scale_greatest) * size;
        let accepted = |share: f64| {
            let with = ExtendedParameters { floor_margin: (share * least) as f32, ..p };
            Extended::new(with, &hummingbird::vehicle()).unwrap().check_rotors(&rotors).is_ok()
        };
        assert!(accepted(1.001) && !accepted(0.999), "{all:?}");
    }
    assert!(by_parts > 5, "{by_parts}");
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
