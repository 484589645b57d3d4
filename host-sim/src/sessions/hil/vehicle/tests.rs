//! The vehicle on the ground, its delay, and commands that are none.

use super::*;
use scenario::body::attitude_from_euler;

fn study() -> Scenario {
    Scenario::load(std::path::Path::new("../vehicles/study.toml")).unwrap()
}

fn all(command: f32) -> Controls {
    Controls { time: 0, armed: true, commands: [command; MOTOR_COUNT] }
}

/// The command that hovers: u^2 of the rotors' greatest thrust is the weight.
fn hover() -> f32 {
    let configuration = study().configuration;
    let greatest: f32 = configuration.rotors().unwrap().iter().map(|rotor| rotor.thrust_max).sum();
    (configuration.vehicle().mass * configuration.vehicle().gravity / greatest).sqrt()
}

#[test]
fn it_stands_below_the_scenarios_start_until_it_is_commanded_to_rise() {
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
fn an_accelerometer_feels_every_impact_also_one_that_the_vehicle_hops_off_from_at_once() {
    let mut spun = HilVehicle::new(&study()).unwrap();
    let period = study().timing.period();
    (0..50).for_each(|_| {
        spun.advance(&all(hover() - 1e-4), 1).unwrap();
    });
    let (mut hops, mut felt) = (0, 0.0_f64);
    for millirad in 0..20 {
        let mut vehicle = spun.clone();
        let mut falling = *spun.state();
        falling.attitude = attitude_from_euler(f64::from(millirad) * 1e-3, 0.0, 0.0);
        (falling.position.z, falling.velocity.z) = (0.02, -0.5);
        vehicle.plant.place(falling);
        vehicle.ground.touch(&falling);
        // It is righted, and the foot that it touched with is in the air again.
        let mut righting = all(hover() - 1e-4);
        righting.commands[1] += 0.01;
        righting.commands[2] += 0.01;
        for _ in 0..100 {
            let before = *vehicle.state();
            let moved = vehicle.advance(&righting, 1).unwrap();
            let shown = UnitQuaternion::new_normalize(moved.state.attitude) * moved.specific_force;
            let gained = moved.state.velocity - before.velocity;
            assert!(((shown - Vector3::z() * 9.81) * period - gained).norm() < 1e-6, "{shown} {gained}");
            felt = felt.max(shown.z - 9.81);
            hops += usize::from(moved.touchdown.is_some() && !vehicle.ground.stands());
        }
    }
    assert!(hops > 3, "{hops}");
    assert!((felt * period - 0.5).abs() < 0.01, "{felt}");
}
