//! The rows of the budget, and what a tick spends of them.

use super::Random;
use super::std;
use crate::allocation::{MinimumNorm, Rotors};
use crate::extended::budget::{RowSource, TORQUE_THRUST_SHARE, TickBudget, TorqueBudget};
use crate::extended::tests::example::Craft;
use crate::extended::thrust_range::ThrustRange;
use crate::state::Wrench;
use crate::vehicle::{LimitParameters, Limits};
use nalgebra::{Vector2, Vector3};

fn rows(craft: &Craft, margin: f32) -> TorqueBudget {
    TorqueBudget::new(margin, &craft.limits, Some(&craft.rotors))
}

/// The craft with limits of roll and pitch that its rotors reach or not, and a low T_max or not.
fn limited(random: &mut Random) -> Craft {
    let craft = Craft::random(random);
    let torque = craft.limits.torque_max * random.logarithmic(0.2, 4.0);
    let thrust_max = craft.limits.thrust_max * random.between(0.7, 1.0);
    let limits = LimitParameters { thrust_max, torque_max: torque };
    match Limits::new(limits, &craft.vehicle) {
        Ok(limits) => Craft { limits, ..craft },
        Err(_) => craft,
    }
}

/// The longest torque along a unit vector that every row allows, N m.
fn longest(budget: &TorqueBudget, direction: &Vector2<f64>, scale: f64) -> f64 {
    let along = budget.rows.iter().map(|row| {
        let [x, y] = row.direction;
        row.capacity(scale) / (x * direction.x + y * direction.y).abs()
    });
    along.fold(f64::INFINITY, f64::min)
}

fn unit(random: &mut Random) -> Vector2<f32> {
    let (sin, cos) = random.between(0.0, core::f32::consts::TAU).sin_cos();
    Vector2::new(cos, sin)
}

/// Whether a rotor would leave its range with the wrench that [`ThrustRange`] admits.
fn clips(rotors: &Rotors, range: &ThrustRange, asked: [f32; 3], tilt: &Vector2<f32>, scale: f32) -> bool {
    let (Wrench { thrust, torque }, _) = range.limited(asked[0], tilt, [asked[1], asked[2]], scale);
    assert_eq!(torque.xy(), *tilt);
    MinimumNorm::new(rotors).allocate(&Wrench { thrust: thrust / scale, torque: torque / scale }).unwrap().clipped
}

#[test]
fn every_torque_that_is_spent_leaves_each_rotor_in_its_range_with_any_thrust_and_yaw_that_are_asked() {
    let mut random = Random(31);
    for _ in 0..300 {
        let craft = limited(&mut random);
        let scales = [random.between(0.7, 1.0), random.between(1.0, 1.3)];
        let margin = 1e-3 * craft.vehicle.mass * craft.vehicle.gravity;
        let budget = rows(&craft, margin);
        let tick = TickBudget::new(&budget, scales);
        let (limits, max) = (craft.limits, craft.limits.torque_max);
        let range = ThrustRange::new(Some(&craft.rotors), margin, limits.thrust_max, max.z);
        for _ in 0..300 {
            let scale = random.between(scales[0], scales[1]);
            if tick.radius(scale) <= 0.0 {
                continue;
            }
            let mut spending = tick.spending(scale);
            for _ in 0..3 {
                let wanted = unit(&mut random) * (2.0 * max.xy().norm() * random.between(0.0, 1.0));
                spending.spend(&wanted, 0.0);
            }
            let tilt = spending.spent;
            let along = Vector3::new(tilt.x, tilt.y, 0.0);
            assert!(tilt.x.abs() <= max.x && tilt.y.abs() <= max.y, "{craft:?} {tilt}");
            assert!(range.min_thrust(&along, scale) <= range.max_thrust(&along, scale), "{craft:?} {tilt}");
            let yaw = 3.0 * max.z * random.signed();
            let braking = if random.below(2) == 0 { 0.0 } else { random.between(0.0, 1.0) * yaw };
            let asked = [2.0 * limits.thrust_max * random.signed(), yaw, braking];
            assert!(!clips(&craft.rotors, &range, asked, &tilt, scale), "{craft:?} {tilt} {scale}");
        }
    }
}

#[test]
fn no_row_of_rotors_is_narrower_than_they_need() {
    let mut random = Random(32);
    for _ in 0..100 {
        let craft = Craft::random(&mut random);
        let budget = rows(&craft, 0.0);
        let range = ThrustRange::new(Some(&craft.rotors), 0.0, f32::MAX, f32::MAX);
        for row in budget.rows.iter().filter(|row| row.bound == RowSource::Rotors) {
            let [x, y] = row.direction.map(|part| (1.01 * row.capacity(1.0) * part) as f32);
            let fails = |torque: Vector3<f32>| range.min_thrust(&torque, 1.0) > range.max_thrust(&torque, 1.0);
            assert!(fails(Vector3::new(x, y, 0.0)) || fails(Vector3::new(-x, -y, 0.0)), "{craft:?} {row:?}");
        }
    }
}

#[test]
fn what_a_tick_may_spend_is_what_all_rows_allow_and_no_less() {
    let (mut random, mut dropped) = (Random(33), 0);
    for _ in 0..200 {
        let craft = limited(&mut random);
        let scales = [random.between(0.7, 1.0), random.between(1.0, 1.3)];
        let budget = rows(&craft, 1e-3 * craft.vehicle.mass * craft.vehicle.gravity);
        let tick = TickBudget::new(&budget, scales);
        dropped += usize::from(std::format!("{tick:?}").len() < std::format!("{:?}", budget.rows).len() / 3);
        for _ in 0..50 {
            let scale = random.between(scales[0], scales[1]);
            if tick.radius(scale) <= 0.0 {
                continue;
            }
            let direction = unit(&mut random);
            let longest = longest(&budget, &direction.map(f64::from).normalize(), f64::from(scale));
            let mut spending = tick.spending(scale);
            let share = spending.spend(&(direction * (2.0 * longest as f32)), 0.0);
            let found = f64::from(2.0 * share);
            assert!(found <= 1.0 && found > 0.998, "{craft:?} {direction} {scale}: {found}");
        }
    }
    assert!(dropped > 20, "{dropped}");
}

#[test]
fn each_part_is_spent_up_to_what_it_has_to_keep_and_the_next_one_beside_it() {
    let mut random = Random(34);
    let craft = Craft::example();
    let budget = rows(&craft, 5e-3);
    let tick = TickBudget::new(&budget, [0.9, 1.15]);
    let (mut whole, mut part) = (0, 0);
    for _ in 0..20_000 {
        let scale = random.between(0.9, 1.15);
        let mut spending = tick.spending(scale);
        let radius = spending.radius();
        let kept = [0.3, 0.2, 0.0].map(|share| share * radius);
        for kept in kept {
            let before = spending.spent;
            let size = radius * random.logarithmic(0.01, 10.0);
            let wanted = unit(&mut random) * size;
            let share = spending.spend(&wanted, kept);
            assert!((spending.spent - before - wanted * share).norm() < 1e-6);
            let holds = |torque: Vector2<f32>| {
                budget.rows.iter().all(|row| {
                    let along = row.direction[0] * f64::from(torque.x) + row.direction[1] * f64::from(torque.y);
                    along.abs() <= row.capacity(f64::from(scale)) - f64::from(kept)
                })
            };
            assert!(holds(spending.spent), "{before} {wanted} {kept}");
            let max = budget.rows.iter().map(|row| {
                let along = |torque: Vector2<f32>| {
                    row.direction[0] * f64::from(torque.x) + row.direction[1] * f64::from(torque.y)
                };
                let (spent, more) = (along(before), along(wanted));
                let room = row.capacity(f64::from(scale)) * 0.999 - f64::from(kept) - spent * more.signum();
                room.max(0.0) / more.abs()
            });
            let max = max.fold(1.0, f64::min);
            assert!((f64::from(share) - max).abs() < 1e-4, "{before} {wanted} {kept}: {share} of {max}");
            if share < 1.0 { part += 1 } else { whole += 1 }
        }
    }
    assert!(whole > 10_000 && part > 10_000, "{whole} {part}");
}

#[test]
fn nothing_is_spent_of_a_torque_that_is_no_number() {
    let budget = rows(&Craft::example(), 5e-3);
    let tick = TickBudget::new(&budget, [0.9, 1.15]);
    for wanted in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut spending = tick.spending(1.0);
        spending.spend(&Vector2::new(0.1, 0.0), 0.0);
        spending.spend(&Vector2::new(wanted, 0.0), 0.0);
        assert_eq!(spending.spent, Vector2::new(0.1, 0.0), "{wanted}");
    }
}

#[test]
fn a_budget_that_a_scale_leaves_empty_spends_nothing() {
    let craft = Craft::example();
    let tick = TickBudget::new(&rows(&craft, 50.0), [0.9, 1.15]);
    let mut spending = tick.spending(1.0);
    assert!(tick.radius(1.0) < 0.0);
    spending.spend(&Vector2::new(0.1, 0.2), 0.0);
    assert_eq!(spending.spent, Vector2::zeros());
}

#[test]
fn the_acceleration_that_is_held_is_the_ticks_own_less_what_a_bias_takes() {
    let mut random = Random(35);
    for _ in 0..100 {
        let craft = Craft::random(&mut random);
        let budget = rows(&craft, 1e-3);
        let ceiling = budget.ceiling(&craft.vehicle, &craft.limits);
        let scale = random.between(0.8, 1.2);
        let held = budget.held_acceleration(&craft.vehicle, &craft.limits, f64::from(scale));
        let found = ceiling.at(scale, &Vector3::zeros());
        assert!((f64::from(found) * (1.0 - TORQUE_THRUST_SHARE) / held - 1.0).abs() < 1e-5, "{found} {held}");
        // With a bias every rotor still has that thrust in its range.
        let bias = random.vector(1.0).component_mul(&(craft.limits.torque_max * 0.2));
        let thrust = ceiling.at(scale, &bias) * craft.vehicle.mass;
        let range = ThrustRange::new(Some(&craft.rotors), 1e-3, craft.limits.thrust_max, f32::MAX);
        assert!(thrust <= range.max_thrust(&bias, scale) * (1.0 + 1e-6), "{thrust} {bias}");
    }
}
