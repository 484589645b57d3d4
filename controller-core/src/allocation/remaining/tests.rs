//! Thrusts of the rotors that are left: within their ranges and the limits, whatever is asked; the best of those.

use super::*;
use crate::allocation::QuadX;
use crate::extended::tests::Random;
use crate::vehicle::{LimitParameters, Vehicle, VehicleParameters};

const WEIGHT: f32 = 4.905;

fn quad() -> Rotors {
    Rotors::quad_x(QuadX {
        arm: 0.17,
        thrust_coefficient: 5.57e-6,
        drag_coefficient: 1.36e-7,
        speed_min: 100.0,
        speed_max: 1500.0,
    })
    .unwrap()
}

fn limits(thrust_max: f32, torque_max: [f32; 3]) -> Limits {
    let inertia = Vector3::new(3.65e-3, 3.68e-3, 7.03e-3);
    let vehicle = Vehicle::new(VehicleParameters { mass: 0.5, inertia, gravity: 9.81 }).unwrap();
    Limits::new(LimitParameters { thrust_max, torque_max: torque_max.into() }, &vehicle).unwrap()
}

fn loose() -> Limits {
    limits(50.0, [4.0, 4.0, 1.0])
}

fn without(rotor: usize, left: f32) -> RemainingRotors {
    RemainingRotors::new(&quad(), &loose(), &LostRotor { rotor, left }, 1.0, WEIGHT)
}

fn asked(random: &mut Random) -> Wrench {
    Wrench { thrust: random.between(-10.0, 60.0), torque: random.vector(3.0) }
}

/// What the thrusts cost.
fn cost(rotors: &RemainingRotors, wanted: &Wrench, thrusts: &[f32]) -> f64 {
    let missing =
        |sum: Vector4<f64>, rotor: &Remaining, thrust: f32| sum - rotor.column.map(f64::from) * f64::from(thrust);
    let Wrench { thrust, torque } = wanted;
    let wanted = Vector4::new(*thrust, torque.x, torque.y, torque.z).component_mul(&rotors.newtons);
    let yaw = wanted.w.clamp(-rotors.share, rotors.share);
    let wanted = Vector4::new(wanted.x, wanted.y, wanted.z, yaw).map(f64::from);
    let rest = rotors.rotors.iter().zip(thrusts).fold(wanted, |sum, (rotor, thrust)| missing(sum, rotor, *thrust));
    let ways = WRENCH_COMPLIANCE.map(f64::from);
    let beside = rotors.rotors.iter().zip(thrusts).map(|(rotor, thrust)| f64::from(thrust - rotor.preferred).powi(2));
    beside.sum::<f64>() + rest.component_mul(&rest).component_div(&ways).sum()
}

#[test]
fn every_thrust_and_command_is_within_its_range_whatever_is_asked() {
    let mut random = Random(1);
    for number in 0..20_000 {
        let left = if number % 2 == 0 { 0.0 } else { random.between(0.1, 0.9) };
        let rotors = without(number % 4, left);
        let thrusts = rotors.allocate(&asked(&mut random));
        for (index, (thrust, command)) in thrusts.iter().zip(&rotors.commands(&thrusts)).enumerate() {
            let rotor = quad()[index];
            let [min, max] = [rotor.thrust_min, rotor.thrust_max];
            let (share, is_lost) = (if index == number % 4 { left } else { 1.0 }, index == number % 4);
            assert!((share * min..=share * max).contains(thrust), "{thrust}");
            assert!((min..=max).contains(command) || is_lost && left == 0.0 && *command == 0.0, "{command}");
        }
    }
}

#[test]
fn no_thrusts_within_the_ranges_cost_less() {
    let mut random = Random(2);
    for number in 0..2_000 {
        let rotors = without(number % 4, if number % 3 == 0 { random.between(0.1, 0.9) } else { 0.0 });
        let wanted = asked(&mut random);
        let found = rotors.allocate(&wanted);
        let min = cost(&rotors, &wanted, &found);
        for _ in 0..40 {
            // Any others, near and far.
            let size = *[0.01, 0.3, 12.0].get(random.below(3)).unwrap();
            let other = |(rotor, thrust): (&Remaining, &f32)| rotor.within(thrust + random.between(-size, size));
            let others: Vec<f32, ROTORS_MAX> = collected(rotors.rotors.iter().zip(&found).map(other));
            let more = cost(&rotors, &wanted, &others);
            assert!(more >= min - 1e-3 * min.max(1.0), "{wanted:?}: {found:?} {min}, {others:?} {more}");
        }
    }
}

#[test]
fn what_can_be_had_is_delivered() {
    // Three rotors give thrust, and a torque that lowers the failed side.
    let rotors = without(0, 0.0);
    let wanted = rotors.wrench(&Thrusts::from_slice(&[0.0, 2.0, 0.8, 2.2]).unwrap());
    let had = rotors.wrench(&rotors.allocate(&wanted));
    assert!((had.torque - wanted.torque).xy().norm() < 2e-3, "{had:?} of {wanted:?}");
    assert!((had.thrust - wanted.thrust).abs() < 0.15, "{had:?} of {wanted:?}");
}

#[test]
fn roll_and_pitch_give_way_last_and_yaw_first() {
    let rotors = without(0, 0.0);
    // More roll than there is beside so little thrust: thrust rises for it.
    let wanted = Wrench { thrust: 1.0, torque: Vector3::new(0.5, 0.5, 0.3) };
    let had = rotors.wrench(&rotors.allocate(&wanted));
    assert!((had.torque - wanted.torque).xy().norm() < 0.05, "{had:?}");
    assert!(had.thrust > 2.5 && had.torque.z < 0.0, "{had:?}");
}

#[test]
fn limits_of_thrust_and_torque_hold_for_what_is_delivered_and_for_what_would_be_of_whole_rotors() {
    let mut random = Random(3);
    let limits = limits(8.0, [0.2, 0.3, 0.05]);
    let whole = RemainingRotors::new(&quad(), &limits, &LostRotor { rotor: 0, left: 1.0 }, 1.0, WEIGHT);
    let mut bound = 0;
    for number in 0..5_000 {
        let lost = LostRotor { rotor: number % 4, left: if number % 2 == 0 { 0.0 } else { random.between(0.2, 0.9) } };
        let rotors = RemainingRotors::new(&quad(), &limits, &lost, 0.9, WEIGHT);
        let thrusts = rotors.allocate(&asked(&mut random));
        for wrench in [rotors.wrench(&thrusts), whole.wrench(&rotors.commands(&thrusts)).scaled(0.9)] {
            let Wrench { thrust, torque } = wrench;
            assert!(thrust <= limits.thrust_max, "{wrench:?}");
            let left = limits.torque_max - torque.abs();
            assert!(left.min() >= 0.0, "{wrench:?}");
            bound += u32::from(left.min() < 1e-4 || thrust > 7.999);
        }
    }
    assert!(bound > 1_000, "{bound}");
}
