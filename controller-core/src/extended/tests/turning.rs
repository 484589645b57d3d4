//! The limiter of the frame's turning, driven for long.

use super::Random;
use crate::attitude_reference::DesiredAttitude;

use super::std::println;
use crate::extended::defaults::NOTHING_GIVEN;
use crate::extended::example::{Craft, greatest_accelerations};
use crate::extended::position::PositionLaw;
use crate::extended::turning::{Circumstances, TurningLimit};
use crate::heading::Heading;
use crate::position::FilterState;
use nalgebra::{Vector2, Vector3};

#[derive(Debug, Default)]
struct Worst {
    rate: f32,
    cone: f32,
    thrust: f32,
    acted: u32,
}

fn driven(craft: &Craft, random: &mut Random, ticks: u32, turning: f32, worst: &mut Worst) {
    let p = craft.constants(&NOTHING_GIVEN);
    let (gravity, h) = (craft.vehicle.gravity, craft.period);
    let position = PositionLaw::new(&p, gravity, h).unwrap();
    let limit = TurningLimit::new(&p, h);
    let [weakest, _] = greatest_accelerations(craft, &p);
    let k_s_held = (1.0 - (-p.k_s * h).exp()) / h;
    let cosine = p.tilt_max.cos();
    let mut filter = FilterState::ZERO;
    let (mut ubar, mut budget, mut yaw_rate) = (Vector3::zeros(), 0.0, 0.0);
    for tick in 0..ticks {
        if random.below(40) == 0 {
            let (sin, cos) = random.between(0.0, core::f32::consts::TAU).sin_cos();
            let lift = gravity + random.between(-p.a_down, weakest - gravity);
            let left = (weakest * weakest - lift * lift).max(0.0).sqrt();
            let reach = p.a_across.min(0.95 * left).min(0.95 * lift * p.tilt_max.tan());
            ubar = Vector3::new(reach * cos, reach * sin, lift - gravity);
        }
        if random.below(30) == 0 {
            budget = p.turn_acceleration * random.between(-1.0, 1.0);
            yaw_rate = turning * p.yaw_rate * random.signed();
        }
        let FilterState { filtered: c, intermediate: x } = filter;
        let drive = (ubar - x) * k_s_held;
        let rate = (x - c) * p.k_f;
        let wanted = (drive - rate) * p.k_f;
        let command = Vector3::new(c.x, c.y, c.z + gravity);
        let desired = DesiredAttitude::new(&command, &Heading::FORWARD);
        let turn = desired.turn(&rate, &wanted);
        let circumstances =
            Circumstances { budget, yaw_rate, up: desired.up(), greatest: weakest, vertical: [c.z, rate.z, wanted.z] };
        let limited = limit.limited(&turn, &circumstances);
        let q = limited.acceleration;
        let whole = q + Vector2::new(turn.rate.y, -turn.rate.x) * yaw_rate;
        assert!(whole.norm() <= budget.max(p.turn_reserve) * (1.0 + 1e-5), "{craft:?} {tick}");
        worst.rate = worst.rate.max(turn.rate.norm() / p.turn_rate);
        worst.cone = worst.cone.max(cosine - desired.up().z);
        worst.thrust = worst.thrust.max(command.norm() / weakest);
        worst.acted += u32::from(limited.change.is_some());
        let change = limited.change.map_or(Vector3::zeros(), |change| desired.turned(&change));
        filter = position.advance(&filter, &(drive + change / p.k_f));
        assert!(filter.filtered.z >= -p.a_down);
    }
}

#[test]
fn turning_probe() {
    let mut random = Random(51);
    for n in 0..60 {
        let craft = if n == 0 { Craft::example() } else { Craft::random(&mut random) };
        for turning in [0.0, 1.0] {
            let mut worst = Worst::default();
            driven(&craft, &mut random, 10_000, turning, &mut worst);
            let p = craft.constants(&NOTHING_GIVEN);
            println!(
                "TURN {n} {turning} {worst:?} h {} Om {} a0 {} k_f {} amax {}",
                craft.period, p.turn_rate, p.turn_reserve, p.k_f, p.turn_acceleration
            );
        }
    }
}
