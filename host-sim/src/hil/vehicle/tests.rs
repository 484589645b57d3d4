//! The vehicle on the ground, its delay, and commands that are none.

use super::*;

fn study() -> Scenario {
    Scenario::load(std::path::Path::new("../vehicles/study.toml")).unwrap()
}

fn all(command: f32) -> Controls {
    Controls { time: 0, armed: true, commands: [command; MOTORS] }
}

/// The command that hovers: u^2 of the rotors' greatest thrust is the weight.
fn hover() -> f32 {
    let configuration = study().configuration;
    let greatest: f32 = configuration.rotors().unwrap().iter().map(|rotor| rotor.thrust_max).sum();
    (configuration.vehicle().mass * configuration.vehicle().gravity / greatest).sqrt()
}

#[test]
fn it_stands_below_the_scenarios_start_until_it_is_told_to_rise() {
    let mut vehicle = HilVehicle::new(&study()).unwrap();
    for _ in 0..100 {
        let moved = vehicle.advance(&all(hover() - 0.01), 1).unwrap();
        assert_eq!(moved.state.position, Vector3::new(1.0, 0.0, 0.0));
        assert!((moved.specific_force - Vector3::z() * 9.81).norm() < 1e-5);
    }
    let mut height = 0.0;
    for _ in 0..100 {
        height = vehicle.advance(&all(hover() + 0.01), 1).unwrap().state.position.z;
    }
    assert!((0.1..0.2).contains(&height), "{height}");
}

#[test]
fn a_command_acts_after_the_scenarios_delay() {
    let mut vehicle = HilVehicle::new(&study()).unwrap();
    assert_eq!(vehicle.advance(&all(1.0), 1).unwrap().thrust, 0.0);
    assert!(vehicle.advance(&all(1.0), 1).unwrap().thrust > 0.1);
}

#[test]
fn impossible_commands_are_refused_in_words() {
    let mut vehicle = HilVehicle::new(&study()).unwrap();
    for command in [f32::NAN, -0.1, 1.1] {
        assert!(vehicle.advance(&all(command), 1).unwrap_err().contains("0 to 1"));
    }
}

#[test]
fn a_scenario_without_rotors_is_refused_in_words() {
    assert!(HilVehicle::new(&Scenario::paper().unwrap()).unwrap_err().contains("rotors"));
}
