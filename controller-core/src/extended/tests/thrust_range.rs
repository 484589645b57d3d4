//! The least and the greatest thrust.

use super::Random;
use crate::allocation::{QuadX, Rotors};
use crate::extended::tests::example;
use crate::extended::thrust_range::ThrustRange;
use nalgebra::Vector3;

#[test]
fn at_either_end_one_rotor_is_at_its_own_and_none_beyond() {
    let rotors = Rotors::quad_x(QuadX { speed_min: 200.0, ..example::QUAD }).unwrap();
    let range = ThrustRange::new(Some(&rotors), 0.0, f32::MAX);
    let mut random = Random(6);
    for _ in 0..10_000 {
        let torque = random.vector(0.5);
        let scale = random.between(0.8, 1.3);
        let of_rotor = |row: &nalgebra::Vector4<f64>, thrust: f32| {
            let torque = torque.map(f64::from);
            row.x * f64::from(thrust) + row.y * torque.x + row.z * torque.y + row.w * torque.z
        };
        let rooms = |thrust: f32, room: fn(f64, f64, f64) -> f64| {
            let all = rotors.iter().zip(rotors.pseudo_inverse()).map(|(rotor, row)| {
                let [least, greatest] = [rotor.thrust_min, rotor.thrust_max].map(|end| f64::from(scale * end));
                room(of_rotor(row, thrust), least, greatest)
            });
            all.fold(f64::INFINITY, f64::min)
        };
        let above = rooms(range.least(&torque, scale), |thrust, least, _| thrust - least);
        let below = rooms(range.greatest(&torque, scale), |thrust, _, greatest| greatest - thrust);
        // A rotor's 16 N and the sum of four in single precision.
        assert!(above.abs() < 2e-6 && below.abs() < 6e-6, "{torque}: {above} {below}");
    }
}

#[test]
fn the_bound_on_all_rotors_changes_no_thrust() {
    let range = ThrustRange::new(Some(&example::rotors()), 0.05, 40.0);
    let (mut random, mut moved) = (Random(8), 0);
    for _ in 0..100_000 {
        let (torque, scale) = (random.vector(0.5), 1.0 + 0.3 * random.signed());
        let (least, most) = (range.least(&torque, scale), range.greatest(&torque, scale));
        // Just below an end, at it, just above it, and anywhere up to where the bound may be.
        for end in [least, most] {
            for thrust in [end.next_down(), end, end.next_up(), end * (1.0 + 2.0 * random.signed())] {
                let found = range.admitted(thrust, &torque, scale);
                assert_eq!(found, thrust.max(least).min(most), "{thrust} at {torque}, scale {scale}");
                moved += u32::from(found != thrust);
            }
        }
    }
    assert!(moved > 200_000, "{moved}");
}

#[test]
fn a_vehicle_without_rotors_has_a_constant_range() {
    let range = ThrustRange::new(None, 0.05, 40.0);
    let torque = Vector3::new(0.3, -0.2, 0.1);
    assert_eq!([-1.0, 9.0, 50.0].map(|thrust| range.admitted(thrust, &torque, 1.1)), [0.05, 9.0, 40.0]);
}
