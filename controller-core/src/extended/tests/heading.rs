//! The heading's feedback.

use super::Random;
use crate::error::ParameterError;
use crate::extended::controller::Controller;
use crate::extended::heading::{self, HeadingLaw};
use crate::extended::parameters::ExtendedParameters;
use crate::extended::tests::example::{self, Craft};
use nalgebra::Vector3;

/// A body about its z axis alone, turned to a heading at rest with a torque of at most `room`: the longest time away
/// from it by more than a degree, s, the greatest rate and how far it went beyond.
fn turned(start: f32, room: f32) -> [f32; 3] {
    let law = HeadingLaw::new(&example::parameters(), &example::vehicle().inertia);
    let (h, j) = (0.01, example::vehicle().inertia.z);
    let (mut angle, mut rate) = (start, 0.0_f32);
    let mut worst = [0.0_f32; 3];
    for tick in 0..3_000 {
        let lifted = 2.0 * (0.5 * angle).sin();
        let wanted = law.torque(lifted, rate, 0.0, &Vector3::new(0.0, 0.0, rate), room);
        let acceleration = wanted.clamp(-room, room) / j;
        angle += h * (rate + 0.5 * h * acceleration);
        rate += h * acceleration;
        if angle.abs() > 0.0175 {
            worst[0] = h * tick as f32;
        }
        worst[1] = worst[1].max(rate.abs());
        worst[2] = worst[2].max(-angle * start.signum());
    }
    worst
}

#[test]
fn a_turn_of_any_angle_is_braked_with_the_torque_at_hand_and_ends_at_the_heading() {
    let p = example::parameters();
    let j = example::vehicle().inertia.z;
    for start in [0.2, 1.0, 2.0, 3.0, -3.1] {
        for share in [1.0, 2.0, 6.0] {
            let room = share * j * p.yaw_acceleration;
            let [time, rate, beyond] = turned(start, room);
            assert!(rate <= p.yaw_rate * 1.001, "from {start}: {rate} rad/s");
            assert!(beyond < 0.03 * start.abs().max(1.0), "from {start} with {room}: {beyond} rad beyond");
            // From rest to rest with that torque alone, and the linear end of the approach.
            let min = 2.0 * (start.abs() * j / room).sqrt();
            let tail = 6.0 * p.c_2 / p.c_1;
            assert!(time < 1.6 * min.max(start.abs() / p.yaw_rate) + tail, "from {start} with {room}: {time} s");
        }
    }
}

#[test]
fn small_errors_meet_the_gains_and_a_heading_that_turns_is_fed_forward() {
    let (p, j) = (example::parameters(), example::vehicle().inertia);
    let law = HeadingLaw::new(&p, &j);
    let still = Vector3::zeros();
    let slope = |angle: f32, rate: f32| law.torque(angle, rate, 0.0, &still, 0.0);
    assert!((slope(1e-4, 0.0) / (-1e-4 * p.c_1 * j.z) - 1.0).abs() < 1e-3);
    assert!((slope(0.0, 1e-2) / (-1e-2 * p.c_2 * j.z) - 1.0).abs() < 1e-5);
    // R~^T omega_d of a frame that turns steadily moves with the body: its derivative is -omega x f.
    let mut random = Random(44);
    for _ in 0..100 {
        let (rate, velocity, acceleration) = (random.vector(4.0), random.vector(9.0), random.signed());
        let forward = law.forward(&rate, acceleration, &velocity);
        assert!((forward - (acceleration - velocity.cross(&rate).z)).abs() < 1e-4);
        let torque = law.torque(0.0, 0.0, forward, &velocity, 1.0);
        let gyroscopic = velocity.cross(&j.component_mul(&velocity)).z;
        assert!((torque - (j.z * forward + gyroscopic)).abs() < 1e-5, "{torque}");
    }
}

#[test]
fn a_spin_is_braked_before_thrust_and_a_heading_that_lags_is_not() {
    let (p, j) = (example::parameters(), example::vehicle().inertia);
    let law = HeadingLaw::new(&p, &j);
    let max = j.z * p.yaw_acceleration;
    let braked = |rate: f32| law.braking(-9.0 * max, rate * p.yaw_rate) / -max;
    for (rate, share) in [(0.5, 0.0), (1.0, 0.0), (1.5, 0.5), (2.0, 1.0), (9.0, 1.0), (-9.0, 0.0)] {
        assert!((braked(rate) - share).abs() < 1e-5, "{rate}: {}", braked(rate));
    }
    // No more than what is asked for.
    assert!((law.braking(-0.1 * max, 9.0 * p.yaw_rate) / max + 0.1).abs() < 1e-5);
}

#[test]
fn ticks_too_long_for_the_gains_are_refused_by_name() {
    let refused = |c_1: f32, c_2: f32| {
        let parameters = ExtendedParameters { c_1, c_2, ..example::parameters() };
        heading::check(&parameters, 0.01).map_err(|error: ParameterError| error.field)
    };
    assert_eq!(refused(9.0, 6.0), Ok(()));
    assert_eq!(refused(30.0, 0.15), Err("gains.c_1"));
    assert_eq!(refused(900.0, 6.0), Err("gains.c_1"));
    assert_eq!(refused(9.0, 250.0), Err("gains.c_2"));
    // All that are let through die out: the greatest root of their polynomial is inside the unit circle.
    for c_2 in [0.1_f32, 1.0, 10.0, 100.0] {
        for share in [0.001, 0.1, 1.0] {
            let c_1 = share * 0.5 * c_2 / 0.01;
            assert_eq!(refused(c_1, c_2), Ok(()));
            let (half, product) = (f64::from(1.0 - 0.005 * c_2), f64::from(1.0 - 0.01 * c_2 + 1e-4 * c_1));
            let square = half * half - product;
            let max = if square > 0.0 { half.abs() + square.sqrt() } else { product.sqrt() };
            assert!(max < 1.0, "{c_1} {c_2}: {max}");
        }
    }
    let craft = Craft::example();
    let law = craft.law(&ExtendedParameters { c_1: 30.0, c_2: 0.15, ..example::parameters() });
    let refused = Controller::build(&craft.vehicle, &craft.limits, &law, Some(&craft.rotors), 0.01).unwrap_err();
    assert_eq!(refused.field, "gains.c_1");
}
