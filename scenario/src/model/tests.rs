//! The model against what is known without it.

use super::*;
use crate::{STUDY, Scenario};

const AT_REST: BodyState = BodyState {
    position: Vector3::new(0.0, 0.0, 0.0),
    velocity: Vector3::new(0.0, 0.0, 0.0),
    attitude: Quaternion::new(1.0, 0.0, 0.0, 0.0),
    angular_velocity: Vector3::new(0.0, 0.0, 0.0),
};

/// The study vehicle with this lag, s, no delay, and the thrust that holds it.
fn hovering(rotor_lag: f64) -> (Model, Wrench) {
    let scenario = Scenario::parse(STUDY, "f").unwrap();
    let vehicle = scenario.configuration.vehicle();
    let timing = LoopTiming { rotor_lag, delay_samples: 0.0, ..scenario.loop_timing() };
    let hover = Wrench { thrust: vehicle.mass * vehicle.gravity, torque: Vector3::zeros() };
    (Model::new(vehicle, &timing, AT_REST), hover)
}

#[test]
fn a_force_per_mass_moves_a_hovering_vehicle_as_it_would_a_point() {
    let (mut model, hover) = hovering(0.03);
    model.push = Vector3::new(1.0, -0.5, 0.25);
    (0..100).for_each(|_| model.advance(&hover));
    let time = 100.0 * model.period();
    assert!((model.body.velocity - model.push * time).norm() < 1e-6, "{:?}", model.body);
    assert!((model.body.position - model.push * (0.5 * time * time)).norm() < 1e-6, "{:?}", model.body);
}

#[test]
fn rates_under_a_torque_follow_from_the_lag_and_the_inertia() {
    for (lag, inertia) in [(0.02, 1e-3), (0.04, 1e-3), (0.02, 2e-3)] {
        let (mut model, mut wrench) = hovering(lag);
        model.inertia.x = inertia;
        wrench.torque.x = 1e-3;
        (0..20).for_each(|_| model.advance(&wrench));
        // The integral of 1 - exp(-t / lag), and what a step of the lag's exact solution is ahead of it.
        let time = 20.0 * model.period();
        let expected = 1e-3 / inertia * (time - lag * (1.0 - (-time / lag).exp()));
        let rate = model.body.angular_velocity.x;
        assert!((rate - expected).abs() < 1e-3 / inertia * model.step, "{rate}, {expected}");
    }
}
