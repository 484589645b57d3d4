//! The body beside the plant of the model, and its origin beside its centre of mass.

use super::*;
use crate::vehicle::plant::Plant;
use controller_core::state::Wrench;
use scenario::Scenario;
use scenario::body::attitude_from_euler;

fn tumbling() -> BodyState {
    BodyState {
        position: Vector3::new(1.0, -2.0, 3.0),
        velocity: Vector3::new(0.4, 0.5, -0.6),
        attitude: attitude_from_euler(0.4, -0.9, 2.0),
        angular_velocity: Vector3::new(6.0, -4.0, 9.0),
    }
}

fn gap(a: &BodyState, b: &BodyState) -> f64 {
    (a.position - b.position).norm()
        + (a.velocity - b.velocity).norm()
        + (a.attitude - b.attitude).norm()
        + (a.angular_velocity - b.angular_velocity).norm()
}

fn body(centre_of_mass: Vector3<f64>) -> RigidBody {
    let vehicle = *Scenario::paper().unwrap().configuration.vehicle();
    let truth = Truth { centre_of_mass, ..Truth::model(&vehicle) };
    RigidBody::new(&truth, f64::from(vehicle.gravity), &tumbling())
}

#[test]
fn under_a_held_wrench_it_is_the_plant_of_the_model() {
    let paper = Scenario::paper().unwrap();
    let (vehicle, limits) = (paper.configuration.vehicle(), paper.configuration.limits());
    let wrench = Wrench { thrust: 5.5, torque: Vector3::new(0.02, -0.015, 0.01) };
    let mut plant = Plant::new(vehicle, limits, 1e-3, tumbling());
    plant.hold(&wrench, 2000).unwrap();
    let mut body = body(Vector3::zeros());
    let (force, torque) = (Vector3::z() * f64::from(wrench.thrust), wrench.torque.map(f64::from));
    for _ in 0..2000 {
        body.advance(1e-3, |_, _| (force, torque));
    }
    // Rounding, and the length that each takes from the quaternion in its own way: the plant's gap to the exact motion
    // is 1e-8.
    assert!(gap(plant.state(), &body.origin()) < 1e-8, "{:e}", gap(plant.state(), &body.origin()));
}

#[test]
fn the_centre_of_mass_falls_on_a_parabola_and_the_origin_circles_it() {
    let offset = Vector3::new(0.03, -0.02, 0.01);
    let mut body = body(offset);
    let start = *body.state();
    assert!(gap(&body.origin(), &tumbling()) < 1e-15);
    for _ in 0..1000 {
        body.advance(1e-3, |_, _| (Vector3::zeros(), Vector3::zeros()));
        let arm = body.state().position - body.origin().position;
        assert!((arm.norm() - offset.norm()).abs() < 1e-12);
    }
    let fallen = start.position + start.velocity - Vector3::z() * (0.5 * f64::from(9.81_f32));
    assert!((body.state().position - fallen).norm() < 1e-11);
    // The origin's velocity is the change of its position.
    let before = body.origin();
    body.advance(1e-4, |_, _| (Vector3::zeros(), Vector3::zeros()));
    let mean = 0.5 * (before.velocity + body.origin().velocity);
    assert!(((body.origin().position - before.position) / 1e-4 - mean).norm() < 1e-6);
}
