//! Against the rotors of the simulated air.

use super::*;
use crate::vehicle::reality::air::{Air, Flow};
use crate::vehicle::reality::propulsion::Delivered;
use controller_core::allocation::geometry::ROTORS_MAX;
use scenario::Scenario;
use scenario::reality::drag::Drag;
use scenario::reality::truth::Truth;

const HUMMINGBIRD: &str = include_str!("../../../../../vehicles/hummingbird.toml");

#[test]
fn rotors_that_turn_unlike_each_other_and_hubs_that_move_act_as_the_simulated_ones() {
    let scenario = Scenario::parse(HUMMINGBIRD, "hummingbird").unwrap();
    let (vehicle, rotors) = (scenario.configuration.vehicle(), scenario.configuration.rotors().unwrap());
    let (mass, k): (f64, f64) = (vehicle.mass.into(), rotors.iter().next().unwrap().thrust_coefficient.into());
    let drag = Drag { rotor_across: 1.19e-4, rotor_along: 2.32e-4, translational_lift: 3.39e-3, ..Drag::default() };
    let truth = Truth::model(vehicle);
    let (still_air, windy) = (Air::new(Some(rotors), &truth, &Drag::default()), Air::new(Some(rotors), &truth, &drag));
    // Pressed down by the air, as in wind: more than a hover takes.
    let speed = (mass * 12.0 / (4.0 * k)).sqrt();
    let mut speeds = [0.0; ROTORS_MAX];
    // Roll and pitch.
    for (rotor, part) in [0.97, 1.01, 1.03, 0.99].into_iter().enumerate() {
        speeds[rotor] = speed * part;
    }
    let delivered = Delivered::Speeds(speeds);
    let airspeed = Vector3::new(3.0, -2.0, 1.5);
    let still = Flow { airspeed: Vector3::zeros(), angular_velocity: Vector3::zeros(), ground_effect: 0.0 };
    let (layout, hubs) =
        (Layout::of_rotors(rotors), Hubs { along: 1.0, across: 1.0, lift: drag.translational_lift / mass });
    let (thrust, torque) = still_air.act(&still, &delivered);
    let impulse = Impulse { thrust: thrust.z, torque };

    let dragged = Air::new(Some(rotors), &truth, &Drag { translational_lift: 0.0, ..drag });
    let (force, turned) = dragged.act(&Flow { airspeed, ..still }, &delivered);
    let expected = hubs.unlike(&impulse, thrust.z / mass, &((force - thrust) / mass));
    let found = turned - torque;
    // To first order in how unlike they turn, 3 %.
    assert!((found - expected).norm() < 0.03 * found.norm() && found.norm() > 1e-3, "{found} {expected}");

    let yawing = Flow { airspeed, angular_velocity: Vector3::new(0.0, 0.0, 1.2), ground_effect: 0.0 };
    let (lifted, turned) = windy.act(&yawing, &delivered);
    let (bare, dragged) = dragged.act(&yawing, &delivered);
    let found = (lifted - bare).z / mass;
    // What the yawing itself lifts besides is (omega_z p)^2, 0.04 of 13 m^2/s^2.
    assert!((found / hubs.lifted(&layout, &airspeed) - 1.0).abs() < 0.004, "{found}");
    let (found, expected) = (turned - dragged, hubs.torque(&layout, &airspeed, 1.2) * mass);
    assert!((found - expected).norm() < 1e-6 * found.norm() && found.norm() > 1e-3, "{found} {expected}");
}
