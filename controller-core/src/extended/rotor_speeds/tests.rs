//! Speeds to a wrench and back: within ranges and limits, whatever is demanded.

extern crate std;
use super::*;
use crate::allocation::{MinimumNorm, QuadX};
use crate::extended::tests::Random;
use crate::vehicle::{LimitParameters, Vehicle, VehicleParameters};
use std::vec::Vec;

const QUAD: QuadX =
    QuadX { arm: 0.17, thrust_coefficient: 5.57e-6, drag_coefficient: 1.36e-7, speed_min: 80.0, speed_max: 1500.0 };

fn rotors() -> Rotors {
    Rotors::quad_x(QUAD).unwrap()
}

fn limits(thrust_max: f32, torque_max: [f32; 3]) -> Limits {
    let vehicle =
        Vehicle::new(VehicleParameters { mass: 0.01, inertia: Vector3::repeat(1e-3), gravity: 9.81 }).unwrap();
    Limits::new(LimitParameters { thrust_max, torque_max: torque_max.into() }, &vehicle).unwrap()
}

const WIDE: ([f32; 3], f32) = ([100.0; 3], 100.0);

#[test]
fn speeds_turn_the_rotors_that_they_name_and_come_back() {
    let rotors = rotors();
    let x = RotorSpeeds::new(&rotors, &limits(WIDE.1, WIDE.0)).unwrap();
    let mixer = MinimumNorm::new(&rotors);
    let mut random = Random(101);
    for _ in 0..1_000 {
        let speeds = core::array::from_fn(|_| 0.999 * random.signed());
        let wrench = x.wrench(&speeds, 1.0);
        let delivered = mixer.allocate(&wrench).unwrap();
        assert!(!delivered.clipped);
        // Front left, rear left, rear right, front right.
        let [front_right, back_right, back_left, front_left] = speeds;
        for (thrust, speed) in delivered.thrusts.iter().zip([front_left, back_left, back_right, front_right]) {
            let turns = QUAD.speed_min + (QUAD.speed_max - QUAD.speed_min) * 0.5 * (1.0 + speed);
            assert!((thrust - QUAD.thrust_coefficient * turns * turns).abs() < 1e-4, "{thrust} {turns}");
        }
        let commanded = Vector4::new(wrench.thrust, wrench.torque.x, wrench.torque.y, wrench.torque.z);
        for (back, speed) in x.speeds(&commanded).iter().zip(speeds) {
            assert!((back - speed).abs() < 1e-4, "{back} {speed}");
        }
    }
}

/// Whatever is demanded, at every thrust scale: the rotors, told w / s, clip nothing, and w is within the limits.
#[test]
fn no_demand_takes_a_rotor_out_of_its_range_or_a_wrench_over_a_limit() {
    let rotors = rotors();
    let mixer = MinimumNorm::new(&rotors);
    let mut random = Random(102);
    for _ in 0..20_000 {
        let torque_max =
            [random.logarithmic(0.01, 10.0), random.logarithmic(0.01, 10.0), random.logarithmic(0.01, 10.0)];
        let limits = limits(random.logarithmic(5.0, 100.0), torque_max);
        let x = RotorSpeeds::new(&rotors, &limits).unwrap();
        let speeds = core::array::from_fn(|_| match random.below(6) {
            0 => -1.0,
            1 => 1.0,
            2 => f32::NAN,
            3 => random.signed() * 1e30,
            _ => random.signed(),
        });
        let scale = random.logarithmic(0.5, 1.5);
        let wrench = x.wrench(&speeds, scale);
        let Wrench { thrust, torque } = wrench;
        assert!(thrust <= limits.thrust_max * (1.0 + 1e-6), "{thrust} {}", limits.thrust_max);
        assert!(torque.iter().zip(limits.torque_max.iter()).all(|(torque, max)| torque.abs() <= max * (1.0 + 1e-6)));
        let told = Wrench { thrust: thrust / scale, torque: torque / scale };
        assert!(!mixer.allocate(&told).unwrap().clipped, "{speeds:?} {scale} {limits:?}");
    }
}

#[test]
fn rotors_that_are_no_x_fly_no_speeds() {
    let rotor = |x: f32, y: f32, spin, thrust_max| Rotor {
        position: Vector3::new(x, y, 0.0),
        spin,
        thrust_coefficient: 1e-5,
        drag_coefficient: 1e-7,
        thrust_min: 0.1,
        thrust_max,
    };
    let (cw, ccw) = (Spin::Clockwise, Spin::CounterClockwise);
    let good =
        [rotor(0.1, 0.1, cw, 5.0), rotor(0.1, -0.1, ccw, 5.0), rotor(-0.1, -0.1, cw, 5.0), rotor(-0.1, 0.1, ccw, 5.0)];
    let flies = |list: &[Rotor]| RotorSpeeds::new(&Rotors::new(list).unwrap(), &limits(WIDE.1, WIDE.0)).is_some();
    assert!(flies(&good));
    let [first, second, third, fourth] = good;
    assert!(flies(&[third, fourth, second, first]));
    // The other way round, one stronger, one farther out, a plus, six.
    let turned: Vec<Rotor> =
        good.iter().map(|rotor| Rotor { spin: if rotor.spin == cw { ccw } else { cw }, ..*rotor }).collect();
    assert!(!flies(&turned));
    assert!(!flies(&[rotor(0.1, 0.1, cw, 5.1), second, third, fourth]));
    assert!(!flies(&[rotor(0.13, 0.1, cw, 5.0), second, third, fourth]));
    assert!(!flies(&[
        rotor(0.1, 0.0, cw, 5.0),
        rotor(0.0, 0.1, ccw, 5.0),
        rotor(-0.1, 0.0, cw, 5.0),
        rotor(0.0, -0.1, ccw, 5.0)
    ]));
    let six = [first, second, third, fourth, rotor(0.2, 0.0, cw, 5.0), rotor(-0.2, 0.0, ccw, 5.0)];
    assert!(!flies(&six));
}
