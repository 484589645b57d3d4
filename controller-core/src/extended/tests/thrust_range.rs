//! The least and the greatest thrust, and the yaw torque that is left.

use super::Random;
use crate::allocation::{QuadX, Rotors};
use crate::extended::tests::example;
use crate::extended::thrust_range::ThrustRange;
use nalgebra::{Vector2, Vector3, Vector4};

/// How far the rotors are inside their ranges at worst, N, least and greatest apart.
fn rooms(rotors: &Rotors, thrust: f32, torque: &Vector3<f32>, scale: f32) -> [f64; 2] {
    let mut rooms = [f64::INFINITY; 2];
    for (rotor, row) in rotors.iter().zip(rotors.pseudo_inverse()) {
        let row: &Vector4<f64> = row;
        let found = row.dot(&Vector4::new(thrust, torque.x, torque.y, torque.z).map(f64::from));
        let [min, max] = [rotor.thrust_min, rotor.thrust_max].map(|end| f64::from(scale * end));
        rooms = [rooms[0].min(found - min), rooms[1].min(max - found)];
    }
    rooms
}

fn idling() -> Rotors {
    Rotors::quad_x(QuadX { speed_min: 200.0, ..example::QUAD }).unwrap()
}

#[test]
fn at_either_end_one_rotor_is_at_its_own_and_none_beyond() {
    let rotors = idling();
    let range = ThrustRange::new(Some(&rotors), 0.0, f32::MAX, 0.4);
    let mut random = Random(6);
    for _ in 0..10_000 {
        let torque = random.vector(0.5);
        let scale = random.between(0.8, 1.3);
        let [above, _] = rooms(&rotors, range.min_thrust(&torque, scale), &torque, scale);
        let [_, below] = rooms(&rotors, range.max_thrust(&torque, scale), &torque, scale);
        // A rotor's 16 N and the sum of four in single precision.
        assert!(above.abs() < 2e-6 && below.abs() < 6e-6, "{torque}: {above} {below}");
    }
}

#[test]
fn thrust_is_the_nearest_that_tilting_leaves_and_yaw_the_nearest_that_both_leave() {
    let rotors = idling();
    let (thrust_max, yaw_max) = (40.0, 0.4);
    let range = ThrustRange::new(Some(&rotors), 0.0, thrust_max, yaw_max);
    let (mut random, mut cut) = (Random(8), [0; 2]);
    for _ in 0..50_000 {
        let (tilt, scale) = (random.vector(0.4).xy(), random.between(0.8, 1.3));
        let [asked, yaw] = [60.0 * random.signed(), random.signed()];
        let braking = if random.below(2) == 0 { 0.0 } else { 0.1 * yaw };
        let (wrench, room) = range.limited(asked, &tilt, [yaw, braking], scale);
        let alone = Vector3::new(tilt.x, tilt.y, 0.0);
        let max = range.max_thrust(&alone, scale).min(range.max_thrust(&Vector3::new(tilt.x, tilt.y, braking), scale));
        let expected = asked.min(max).max(range.min_thrust(&alone, scale));
        assert!((wrench.thrust - expected).abs() < 1e-5, "yaw moved the thrust: {} {expected}", wrench.thrust);
        // Where thrust is cut, what brakes is there, unless it would take a rotor below its least.
        let braked = Vector3::new(tilt.x, tilt.y, braking);
        let cut_from_above = wrench.thrust < asked && range.min_thrust(&braked, scale) < wrench.thrust;
        let brakes = braking == 0.0 || wrench.torque.z * braking.signum() >= braking.abs() - 1e-5;
        assert!(brakes || !cut_from_above, "{wrench:?} {braking}");
        let got = wrench.torque.z;
        assert!(got.abs() <= yaw_max && wrench.torque.xy() == tilt);
        let inside = |yaw: f32| {
            let [above, below] = rooms(&rotors, wrench.thrust, &Vector3::new(tilt.x, tilt.y, yaw), scale);
            above > -1e-5 && below > -1e-5
        };
        assert!(inside(got), "{wrench:?}");
        // A little nearer to what is asked would be too much.
        if (got - yaw).abs() > 1e-4 && yaw.abs() <= yaw_max {
            assert!(!inside(got + 1e-4 * (yaw - got).signum()), "{wrench:?} for {yaw}");
            cut[0] += 1;
        }
        cut[1] += usize::from(expected != asked);
        // Both ways alike there is that much.
        assert!(room >= 0.0 && (room == 0.0 || (inside(room) && inside(-room))), "{room} {wrench:?}");
    }
    assert!(cut.iter().all(|count| *count > 2_000), "{cut:?}");
}

#[test]
fn a_turning_torque_gets_the_share_with_which_the_floor_stays_below_a_thrust_or_where_it_is() {
    let rotors = idling();
    let range = ThrustRange::new(Some(&rotors), 0.05, 40.0, 0.4);
    let (mut random, mut cut) = (Random(9), 0);
    for _ in 0..50_000 {
        let (spent, wanted): (Vector2<f32>, Vector2<f32>) = (random.vector(0.4).xy(), random.vector(0.6).xy());
        let (thrust, scale) = (random.between(0.0, 12.0), random.between(0.8, 1.3));
        let floor = |share: f32| {
            let torque = spent + wanted * share;
            range.min_thrust(&Vector3::new(torque.x, torque.y, 0.0), scale)
        };
        let share = range.share(&spent, &wanted, thrust, scale);
        let max = thrust.max(floor(0.0));
        assert!((0.0..=1.0).contains(&share) && floor(share) <= max + 1e-5, "{spent} {wanted} {thrust}: {share}");
        if share < 1.0 {
            assert!(floor(share + 1e-2) > max, "{spent} {wanted} {thrust}: {share}");
            cut += 1;
        }
    }
    assert!(cut > 10_000, "{cut}");
}

#[test]
fn a_vehicle_without_rotors_has_a_constant_range() {
    let range = ThrustRange::new(None, 0.05, 40.0, 0.2);
    let torque = Vector2::new(0.3, -0.2);
    for (thrust, expected) in [(-1.0, 0.05), (9.0, 9.0), (50.0, 40.0)] {
        let (wrench, room) = range.limited(thrust, &torque, [-0.3, 0.0], 1.1);
        assert_eq!((wrench.thrust, wrench.torque.z, room), (expected, -0.2, 0.2));
    }
}
