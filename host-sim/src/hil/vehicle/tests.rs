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

#[test]
fn it_is_seen_at_each_millisecond_on_the_way_and_moves_no_differently_for_that() {
    // Two plant steps a millisecond.
    let file = std::fs::read_to_string("../vehicles/study.toml").unwrap().replace("step = 0.001", "step = 0.0005");
    let fine = Scenario::parse(&file, "fine.toml").unwrap();
    let (mut seen, mut unseen) = (HilVehicle::new(&fine).unwrap(), HilVehicle::new(&fine).unwrap());
    for _ in 0..20 {
        let (path, end) = (seen.advance(&all(0.9), 10).unwrap(), unseen.advance(&all(0.9), 1).unwrap());
        assert_eq!((path.path.len(), end.path.len()), (10, 1));
        assert_eq!((path.state, path.path[9], end.path[0]), (end.state, end.state, end.state));
    }
    // Each state follows a millisecond after the one before.
    let before = *seen.state();
    let path = seen.advance(&all(0.9), 10).unwrap().path;
    for (earlier, later) in std::iter::once(&before).chain(&path).zip(&path) {
        let risen = later.position.z - earlier.position.z;
        let mean = 0.5e-3 * (later.velocity.z + earlier.velocity.z);
        assert!(risen > 0.0 && (risen - mean).abs() < 1e-9, "{risen} {mean}");
    }
}

#[test]
fn an_accelerometer_feels_the_impact() {
    let mut vehicle = HilVehicle::new(&study()).unwrap();
    let scenario = study();
    let period = scenario.timing.period();
    (0..100).for_each(|_| {
        vehicle.advance(&all(hover() + 0.02), 1).unwrap();
    });
    // What it shows while it falls and stops adds up to what the fall and the stop do to the velocity: nothing.
    let start = vehicle.state().velocity.z;
    let (mut felt, mut greatest) = (0.0, 0.0_f64);
    for _ in 0..500 {
        let moved = vehicle.advance(&all(hover() - 0.02), 1).unwrap();
        felt += (moved.specific_force.z - 9.81) * period;
        greatest = greatest.max(moved.specific_force.z);
        if let Some(touchdown) = moved.touchdown {
            assert!((greatest - 9.81 - touchdown.speed / period).abs() < 1.0, "{greatest} {touchdown:?}");
            assert!((felt + start).abs() < 0.05, "{felt} {start}");
            return;
        }
    }
    panic!("it has not come down: {}", vehicle.state().position);
}
