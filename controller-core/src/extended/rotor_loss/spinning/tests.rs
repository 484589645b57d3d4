//! A vehicle without a rotor: it turns, comes to its place and stays; its commands keep to what there is.

use super::*;
use crate::extended::tests::Random;
use crate::extended::tests::example::{Craft, rotors as quad, vehicle};
use crate::heading::Heading;
use nalgebra::UnitQuaternion;

const PERIOD: f32 = 0.01;

fn limits() -> Limits {
    Craft::example().limits
}

fn law(lost: &LostRotor) -> RotorLossLaw {
    RotorLossLaw::new(&vehicle(), &limits(), &quad(), lost, [0.0, PERIOD], &Estimates::NONE)
}

fn still(position: Vector3<f32>) -> State {
    let none = Vector3::zeros();
    State { position, velocity: none, attitude: Quaternion::identity(), angular_velocity: none }
}

fn hover() -> Reference {
    Reference::resting(Vector3::zeros(), Heading::FORWARD)
}

/// Moves a rigid body with a drag of `drag`, N m s, about its z for a tick: of what is commanded, a rotor delivers what
/// it has `left`.
fn advance(state: &mut State, law: &RotorLossLaw, left: &LostRotor, drag: f32) {
    let share = |index| if index == left.rotor { left.left } else { 1.0 };
    let delivered: Vector4<f32> = quad()
        .effectiveness()
        .iter()
        .zip(law.commands())
        .enumerate()
        .map(|(index, (column, command))| column.map(|x| x as f32) * (command * share(index)))
        .sum();
    let inertia = vehicle().inertia;
    let steps = 20;
    for _ in 0..steps {
        let h = PERIOD / steps as f32;
        let rate = state.angular_velocity;
        let torque = Vector3::new(delivered.y, delivered.z, delivered.w - drag * rate.z);
        let change = (torque - rate.cross(&inertia.component_mul(&rate))).component_div(&inertia) * h;
        let attitude = UnitQuaternion::new_normalize(state.attitude);
        let push = attitude * Vector3::z() * (delivered.x / 0.5) - Vector3::z() * 9.81;
        state.position += state.velocity * h + push * (0.5 * h * h);
        state.velocity += push * h;
        state.attitude = (attitude * UnitQuaternion::from_scaled_axis((rate + change * 0.5) * h)).into_inner();
        state.angular_velocity += change;
    }
}

fn fly(law: &mut RotorLossLaw, state: &mut State, left: &LostRotor, drag: f32, ticks: u32) -> f32 {
    let mut farthest = 0.0_f32;
    for _ in 0..ticks {
        let _ = law.step(state, &hover(), &Vector4::zeros(), PERIOD);
        advance(state, law, left, drag);
        farthest = farthest.max(state.position.norm());
    }
    farthest
}

#[test]
fn without_any_of_its_rotors_it_turns_and_holds_its_place() {
    for rotor in 0..4 {
        let lost = LostRotor { rotor, left: 0.0 };
        let (mut law, mut state) = (law(&lost), still(Vector3::zeros()));
        let farthest = fly(&mut law, &mut state, &lost, 7e-3, 1_500);
        assert!(farthest < 1.0 && state.position.norm() < 0.03, "{farthest}, {state:?}");
        // It turns as the rotors' drag has it that are left: those beside the failed one.
        let sign = -quad()[rotor].spin.sign();
        assert!((8.0..20.0).contains(&(sign * state.angular_velocity.z)), "{state:?}");
    }
}

#[test]
fn once_it_turns_its_axis_rests_and_so_do_the_thrusts() {
    let lost = LostRotor { rotor: 0, left: 0.0 };
    let (mut law, mut state) = (law(&lost), still(Vector3::zeros()));
    let _ = fly(&mut law, &mut state, &lost, 7e-3, 3_000);
    let before = (law.commands().clone(), state.angular_velocity);
    let _ = fly(&mut law, &mut state, &lost, 7e-3, 37);
    for (now, before) in law.commands().iter().zip(&before.0) {
        assert!((now - before).abs() < 0.02, "{now} after {before}");
    }
    let moved = state.angular_velocity - before.1;
    assert!(moved.norm() < 0.05, "{moved} to {}", state.angular_velocity);
    // The body turns about n, which points upwards.
    let axis = state.angular_velocity / state.angular_velocity.z;
    let [cosine, sine] = [AXIS_COSINE_SINE.0, AXIS_COSINE_SINE.1];
    let tangent = axis.xy().norm();
    assert!((tangent - sine / cosine).abs() < 0.06, "{axis}");
    let up = UnitQuaternion::new_normalize(state.attitude) * axis.normalize();
    assert!(up.z > 0.999, "{up}");
    // The opposite rotor's torque is what the turning needs.
    let needed = (7.03e-3 - 3.66e-3) * state.angular_velocity.z.powi(2) * tangent;
    let given = law.commands()[2] * 0.17;
    assert!((given / needed - 1.0).abs() < 0.05, "{given} of {needed}");
}

#[test]
fn with_a_part_of_a_rotor_left_it_holds_its_heading_too() {
    for left in [0.3, 0.6] {
        let lost = LostRotor { rotor: 1, left };
        let (mut law, mut state) = (law(&lost), still(Vector3::new(0.5, 0.0, -0.3)));
        let _ = fly(&mut law, &mut state, &lost, 7e-3, 1_500);
        assert!(state.position.norm() < 0.02, "{state:?}");
        assert!(Heading::from_attitude(&state.attitude).direction().x > 0.99, "{state:?}");
    }
}

#[test]
fn what_a_rotor_has_left_is_learnt_on() {
    let thought = LostRotor { rotor: 0, left: 0.5 };
    let mut law = law(&thought);
    // Half of the thrust that it was taken to deliver was missing.
    for _ in 0..200 {
        let delivered = 1.0 * law.lost().left / 0.5;
        let missing = delivered - 1.0 * 0.25 / 0.5;
        law.refine_loss(delivered, missing, PERIOD);
    }
    assert!((law.lost().left - 0.25).abs() < 0.08, "{:?}", law.lost());
    // And of one that is gone, all: then the vehicle turns about another axis.
    for _ in 0..50 {
        law.refine_loss(1.0, 1.0, PERIOD);
    }
    assert_eq!(law.lost().left, 0.0);
    assert!(law.axis.z < 0.98);
}

#[test]
fn nothing_it_is_told_takes_a_command_out_of_its_range_or_a_wrench_out_of_its_limits() {
    let mut random = Random(7);
    for number in 0..40 {
        let lost = LostRotor { rotor: number % 4, left: if number % 2 == 0 { 0.0 } else { random.between(0.2, 0.9) } };
        let mut law = law(&lost);
        for _ in 0..500 {
            let size = *[1.0, 30.0, 1e4].get(random.below(3)).unwrap();
            let state = State {
                position: random.vector(size),
                velocity: random.vector(size),
                attitude: random.attitude(),
                angular_velocity: random.vector(size.min(100.0)),
            };
            let pending = Vector4::repeat(random.between(-1.0, 1.0));
            let RotorLossStep { mrp, .. } = law.step(&state, &hover(), &pending, PERIOD);
            assert!(mrp.norm() <= 1.001, "{mrp}");
            for (index, (command, rotor)) in law.commands().iter().zip(quad().iter()).enumerate() {
                let min = if index == lost.rotor && lost.left == 0.0 { 0.0 } else { rotor.thrust_min };
                assert!((min..=rotor.thrust_max).contains(command), "{command}");
            }
            let Wrench { thrust, torque } = law.delivered();
            assert!(*thrust <= 40.0 && (limits().torque_max - torque.abs()).min() >= 0.0, "{thrust} {torque}");
        }
    }
}
