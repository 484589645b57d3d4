//! Errors projected over the rotors' lag and delay.

use super::Random;
use crate::extended::actuators::{ActuatorModel, ActuatorParameters, ActuatorState};
use crate::extended::attitude::{AttitudeLaw, Late};
use crate::extended::tests::example;
use nalgebra::{Quaternion, Vector3, Vector4};

#[test]
fn what_is_pending_is_what_was_commanded_less_what_has_acted() {
    let period = 0.01;
    for (lag, delay) in [(0.0, 0.0), (0.03, 0.0), (0.005, 0.013), (0.08, 0.03), (0.0, 0.027)] {
        let model = ActuatorModel::new(&ActuatorParameters { lag, delay }, period).unwrap();
        let mut state = ActuatorState::steady(Vector4::zeros());
        let (mut random, mut expected) = (Random(41), Vector4::zeros());
        for _ in 0..200 {
            let sent = Vector4::new(random.signed(), random.signed(), random.signed(), random.signed());
            state.command(sent);
            let acted = model.advance(&mut state);
            expected += (sent - acted) * period;
            // 200 sums of a hundredth.
            assert!((model.pending(&state) - expected).norm() < 1e-6, "{lag} {delay}");
        }
    }
}

/// A body on rotors with a lag, small motions in fine ticks: the projected angle moves with the projected rate, and
/// that with the acceleration that is commanded now, whatever was commanded before.
#[test]
fn the_projected_errors_move_as_if_the_rotors_were_ideal() {
    let inertia = example::vehicle().inertia;
    let law = AttitudeLaw::new(&example::parameters(), &inertia);
    let (period, lag) = (1e-3_f32, 0.05_f32);
    let model = ActuatorModel::new(&ActuatorParameters { lag, delay: 0.0 }, period).unwrap();
    let bias = Vector3::new(0.002, -0.001, 0.0005);
    // omega_d' is constant: its own change is not projected.
    let wanted = Vector3::new(40.0, -30.0, 20.0);
    let held = inertia.component_mul(&wanted) - bias;
    let mut state = ActuatorState::steady(Vector4::new(0.0, held.x, held.y, held.z));
    let (mut angle, mut rate) = (Vector3::new(0.02, 0.01, -0.03), Vector3::new(0.1, -0.2, 0.05));
    let projected = |state: &ActuatorState, angle: &Vector3<f32>, rate: &Vector3<f32>| {
        let pending = model.pending(state);
        let impulse = Vector3::new(pending.y, pending.z, pending.w) + bias * lag;
        let error = Quaternion::from_parts(1.0, angle * 0.5);
        let (q, projected_rate) = law.projected(&error, rate, &Late { time: lag, impulse, forward: wanted });
        (q.imag() * (2.0 / q.w), projected_rate)
    };
    for tick in 0..300 {
        // To one side for 40 ms, then to the other.
        let side = if tick / 40 % 2 == 0 { 1.0 } else { -1.0 };
        let torque = held + Vector3::new(0.02, -0.015, 0.01) * side;
        let (angle_before, rate_before) = projected(&state, &angle, &rate);
        state.command(Vector4::new(0.0, torque.x, torque.y, torque.z));
        let acted = model.advance(&mut state);
        let acceleration = (Vector3::new(acted.y, acted.z, acted.w) + bias).component_div(&inertia) - wanted;
        angle += rate * period + acceleration * (0.5 * period * period);
        rate += acceleration * period;
        let (angle_after, rate_after) = projected(&state, &angle, &rate);
        let commanded = (torque + bias).component_div(&inertia) - wanted;
        let found = (rate_after - rate_before) / period;
        // Rates of 0.3 rad/s rounded, over a tick of a millisecond.
        assert!((found - commanded).norm() < 1e-3, "{found} {commanded}");
        // To second order in angles of some hundredths.
        let (found, mean) = ((angle_after - angle_before) / period, (rate_before + rate_after) * 0.5);
        assert!((found - mean).norm() < 0.01 * (0.1 + mean.norm()), "{found} {mean}");
    }
}

#[test]
fn without_lag_and_delay_nothing_is_projected() {
    let law = AttitudeLaw::new(&example::parameters(), &example::vehicle().inertia);
    let mut random = Random(43);
    for _ in 0..1_000 {
        let (q, rate) = (random.attitude(), random.vector(20.0));
        let late = Late { time: 0.0, impulse: Vector3::zeros(), forward: random.vector(100.0) };
        assert_eq!(law.projected(&q, &rate, &late), (q, rate));
    }
}
