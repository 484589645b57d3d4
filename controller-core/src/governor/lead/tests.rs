use super::*;

const LEAD: Lead = Lead { delay: 1.1, variance: 0.19, acceleration: 2.5 };

#[test]
fn a_slow_turn_is_nearly_a_parabola() {
    let velocity = Vector3::new(1.0, -2.0, 0.5);
    let sideways = |rate: f32| Vector3::new(2.0, 1.0, 0.1) * rate;
    let (turn, feed) = LEAD.ahead_and_velocity(&velocity, &sideways(0.0101), 0.2);
    let (parabola, along) = LEAD.ahead_and_velocity(&velocity, &sideways(0.0099), 0.2);
    // The third order of the turn, |v| w^2 L^3 / 6, and what 2e-4 rad/s make.
    assert!((turn - parabola).norm() < 5e-4 && (feed - along).norm() < 1e-3, "{turn} {parabola}");
}

#[test]
fn the_command_for_a_circle_is_that_circle_ahead_and_larger() {
    let rate = 0.9;
    let velocity = Vector3::new(0.0, rate, 0.0);
    let acceleration = Vector3::new(-rate * rate, 0.0, 0.0);
    let (ahead, feed) = LEAD.ahead_and_velocity(&velocity, &acceleration, 0.0);
    let gain = (0.5 * rate * rate * LEAD.variance).exp();
    let (sin, cos) = (rate * LEAD.delay).sin_cos();
    let there = Vector3::new(1.0, 0.0, 0.0) + ahead;
    assert!((there - Vector3::new(cos, sin, 0.0) * gain).norm() < 2e-3, "{there}");
    assert!((feed - Vector3::new(-sin, cos, 0.0) * (gain * rate)).norm() < 2e-3, "{feed}");
}

#[test]
fn absurd_feed_forward_makes_finite_targets() {
    for velocity in [0.0, 1e-30, 1e-3, 1e6] {
        for acceleration in [0.0, 1e-30, 1.0, 1e6] {
            let (ahead, feed) = LEAD.ahead_and_velocity(
                &Vector3::new(velocity, 0.0, velocity),
                &Vector3::new(1.0, acceleration, 0.0),
                0.5,
            );
            assert!(ahead.norm().is_finite() && feed.norm().is_finite());
        }
    }
}
