//! The net.

use super::Random;
use super::position::{at, force};
use crate::attitude_reference::DesiredAttitude;
use crate::extended::defaults::NOTHING_GIVEN;
use crate::extended::net::{Net, PATIENCE};
use crate::extended::position::{Filters, PositionLaw};
use crate::extended::tests::example::{Craft, greatest_accelerations};
use crate::extended::turning::{Circumstances, TurningLimit};
use crate::heading::Heading;
use crate::reference::Trajectory;
use crate::reference::hover::Hover;
use nalgebra::Vector3;

/// z_1 and z_2.
const FAR: [Vector3<f32>; 2] = [Vector3::new(0.0, 1.0, 0.0), Vector3::new(0.0, 0.0, 1.0)];
const NEAR: [Vector3<f32>; 2] = [Vector3::new(0.03, 0.0, 0.0), Vector3::new(0.0, 0.03, 0.0)];

fn waited(net: &mut Net, seconds: f32, [z_1, z_2]: [Vector3<f32>; 2], limited: bool) {
    for _ in 0..(seconds * 100.0) as u32 {
        net.observe(&z_1, &z_2, limited, 0.01);
    }
}

#[test]
fn the_net_catches_after_its_patience_of_limited_time_and_lets_go_near_the_target() {
    let mut net = Net::FRESH;
    waited(&mut net, 10.0 * PATIENCE, FAR, false);
    assert!(!net.catches(), "nothing was limited");
    waited(&mut net, 0.99 * PATIENCE, FAR, true);
    assert!(!net.catches());
    waited(&mut net, 0.02 * PATIENCE, FAR, true);
    assert!(!net.is_caught() && net.catches() && net.is_caught() && net.times() == 1);
    // Once caught it is not caught again, however long.
    waited(&mut net, 3.0 * PATIENCE, FAR, true);
    assert!(!net.catches() && net.is_caught() && net.times() == 1);
    // Near in place alone, or at rest alone, is not near.
    let [[far, fast], [near, slow]] = [FAR, NEAR];
    waited(&mut net, 1.0, [near, fast], false);
    waited(&mut net, 1.0, [far, slow], false);
    assert!(net.is_caught());
    waited(&mut net, 0.01, NEAR, true);
    assert!(!net.is_caught() && !net.catches());
}

#[test]
fn near_the_target_its_patience_begins_anew() {
    let mut net = Net::FRESH;
    for _ in 0..3 {
        waited(&mut net, 0.9 * PATIENCE, FAR, true);
        waited(&mut net, 0.01, NEAR, false);
    }
    assert!(!net.catches() && net.times() == 0);
}

#[test]
fn a_twentieth_of_the_silent_time_is_forgiven() {
    // Limited for a share of each second: caught above 1/21, never below.
    let caught = |ticks: u32| {
        let mut net = Net::FRESH;
        (0..1_000_000_u32).any(|tick| {
            let [z_1, z_2] = FAR;
            net.observe(&z_1, &z_2, tick % 100 < ticks, 0.01);
            net.catches()
        })
    };
    assert!(!caught(4) && caught(6));
    // What is forgiven is not saved up.
    let mut net = Net::FRESH;
    waited(&mut net, 1.0, FAR, true);
    waited(&mut net, 100.0 * PATIENCE, FAR, false);
    waited(&mut net, 1.01 * PATIENCE, FAR, true);
    assert!(net.catches());
}

/// The worst feedback that the net's level allows: any errors, jumping, of any size, under a constant force.
#[test]
fn under_the_nets_level_the_frame_is_never_limited() {
    let mut random = Random(71);
    let origin = Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0);
    for _ in 0..200 {
        let craft = Craft::random(&mut random);
        let p = craft.constants(&NOTHING_GIVEN);
        let (gravity, h) = (craft.vehicle.gravity, craft.period);
        let position = PositionLaw::new(&p, gravity, h).unwrap();
        let limit = TurningLimit::new(&p, h);
        let [greatest, _] = greatest_accelerations(&craft, &p);
        // One that the thrust holds: its parts across and along may be at their levels, not both of all vehicles.
        let mut d = force(&mut random, &p);
        while (Vector3::z() * gravity - d).norm() > 0.98 * greatest {
            d *= 0.9;
        }
        let mut filter = Filters::at(-d);
        let (mut state, mut yaw_rate) = (at(Vector3::zeros(), Vector3::zeros()), 0.0);
        for tick in 0..2_000 {
            if random.below(20) == 0 {
                state = at(random.vector(1e3), random.vector(1e3));
                yaw_rate = p.yaw_rate * random.signed().signum();
            }
            let feedback = position.feedback(&state, &origin, &filter, &d, greatest, &position.net());
            let wanted = (feedback.drive - feedback.rate) * position.k_f();
            let c = filter.command;
            let desired = DesiredAttitude::new(&Vector3::new(c.x, c.y, c.z + gravity), &Heading::FORWARD);
            let circumstances = Circumstances {
                budget: p.turn_reserve,
                yaw_rate,
                up: desired.up(),
                greatest,
                vertical: [c.z, feedback.rate.z, wanted.z],
            };
            let limited = limit.limited(&desired.turn(&feedback.rate, &wanted), &circumstances);
            assert_eq!(limited.change, None, "{craft:?} {d} tick {tick}");
            filter = position.advance(&filter, &feedback.smoothed, &feedback.drive);
        }
    }
}
