//! What is sensed against what the vehicle does.

use super::*;
use crate::vehicle::SimulatedVehicle;
use crate::vehicle::actuators::ActuatorDemand;
use controller_core::state::Wrench;
use scenario::Scenario;

const HUMMINGBIRD: &str = include_str!("../../../../vehicles/hummingbird.toml");

/// The Hummingbird without drag.
fn hummingbird(more: &str) -> Scenario {
    let mut scenario = Scenario::parse(&format!("{HUMMINGBIRD}\n{more}"), "h.toml").unwrap();
    scenario.reality.drag = None;
    scenario
}

/// A vehicle under one wrench for 10 ms at a time, and what is sensed of it each time.
fn sensed(scenario: &Scenario, wrench: &Wrench, ticks: u32) -> Vec<Sensed> {
    let mut vehicle = SimulatedVehicle::new(scenario, &scenario.configuration);
    let tick = |_| {
        let before = *vehicle.state();
        vehicle.hold(&ActuatorDemand::Wrench(*wrench), scenario.timing.steps_per_tick).unwrap();
        let specific_force = specific_force(&before, vehicle.state(), scenario.timing.period(), 9.81);
        Sensed { specific_force, wrench: vehicle.take_acted().unwrap() }
    };
    (0..ticks).map(tick).collect()
}

#[test]
fn without_drag_an_accelerometer_feels_the_rotors_thrust_however_the_vehicle_turns() {
    let wrench = Wrench { thrust: 8.0, torque: Vector3::new(0.02, -0.03, 0.01) };
    for more in ["", "[truth]\nmass = 0.5\n"] {
        let scenario = hummingbird(more);
        for (tick, sensed) in sensed(&scenario, &wrench, 30).iter().enumerate() {
            let expected = Vector3::z() * (sensed.wrench.x / 0.5);
            // Halfway between two attitudes is the mean of those between up to the turn's square.
            assert!((sensed.specific_force - expected).amax() < 0.02, "{more} {tick}: {sensed:?}");
        }
        let last = sensed(&scenario, &wrench, 30)[29].wrench;
        assert!((last - Vector4::new(8.0, 0.02, -0.03, 0.01)).amax() < 1e-4, "{more}: {last:?}");
    }
}

#[test]
fn rotor_speeds_show_lag_and_a_weak_battery_but_no_weak_rotor() {
    let wrench = Wrench { thrust: 10.0, torque: Vector3::zeros() };
    let of = |more: &str, ticks: u32| sensed(&hummingbird(more), &wrench, ticks).last().unwrap().wrench.x;
    // From 4.9 N in hover, over the first 10 ms.
    assert!((7.5..9.0).contains(&of("", 1)), "{}", of("", 1));
    let sagging = "[battery]\nfull_voltage = 10.0\nempty_voltage = 10.0\nresistance = 0.0\ncapacity = 9.0\n\
                   nominal_voltage = 12.5";
    assert!((of(sagging, 30) - 6.4).abs() < 1e-3, "{}", of(sagging, 30));
    assert!((of("[truth]\nthrust_scale = 0.8", 30) - 10.0).abs() < 1e-3);
}

#[test]
fn a_model_and_the_same_vehicle_in_reality_sense_the_same() {
    let wrench = Wrench { thrust: 7.0, torque: Vector3::new(0.01, 0.0, 0.0) };
    let (model, real) = (sensed(&hummingbird(""), &wrench, 20), sensed(&hummingbird("[truth]\n"), &wrench, 20));
    // The model's body feels the middle of each step, the real one its beginning and end as well: of the change of
    // 2.1 N, 4.2 m/s^2, a part of (step / lag)^2 / 24 = 1/600.
    for (one, other) in model.iter().zip(&real) {
        assert!((one.specific_force - other.specific_force).amax() < 4.2 / 600.0, "{one:?} {other:?}");
        assert!((one.wrench - other.wrench).amax() < 2.1 / 600.0, "{one:?} {other:?}");
    }
}
