//! Speeds against closed forms: lag, curve, voltage, failure.

use super::*;
use scenario::Scenario;

const HUMMINGBIRD: &str = include_str!("../../../../../vehicles/hummingbird.toml");
const LAG_S: f64 = 0.03;
const STEP_S: f64 = 1e-3;
const THRUST_COEFFICIENT: f64 = 5.57e-6;

fn propulsion(sections: &str, lag: f64) -> Propulsion {
    let scenario = Scenario::parse(&format!("{HUMMINGBIRD}{sections}"), "f").unwrap();
    Propulsion::new(&scenario.configuration, scenario.motor(), lag, &scenario.reality, STEP_S)
}

fn speeds(delivered: &Delivered) -> [f64; ROTORS_MAX] {
    let Delivered::Speeds(speeds) = delivered else { panic!("{delivered:?}") };
    *speeds
}

/// The first rotor's speed, rad/s, after so many steps of thrusts of 2 N.
fn after(propulsion: &mut Propulsion, steps: std::ops::Range<u64>) -> f64 {
    propulsion.command(&[2.0; 4]);
    for now in steps {
        propulsion.advance(now);
    }
    propulsion.speeds()[0]
}

fn speed_of(thrust: f64) -> f64 {
    (thrust / THRUST_COEFFICIENT).sqrt()
}

#[test]
fn speeds_follow_the_first_order_response_at_every_stage() {
    let mut propulsion = propulsion("", LAG_S);
    let start = propulsion.speeds()[0];
    assert!((start - speed_of(0.5 * 9.81 / 4.0)).abs() < 1e-4);
    propulsion.command(&[2.0; 4]);
    let end = speed_of(2.0);
    for now in 0..200_u64 {
        for (stage, part) in propulsion.advance(now).iter().zip(STAGE_TIMES) {
            let time = (now as f64 + part) * STEP_S;
            let exact = end + (start - end) * (-time / LAG_S).exp();
            assert!((speeds(stage)[0] - exact).abs() < 1e-4, "{time}: {} {exact}", speeds(stage)[0]);
            assert_eq!(speeds(stage)[4..], [0.0; 4]);
        }
    }
}

#[test]
fn without_lag_a_rotor_is_at_its_speed_at_once() {
    let mut propulsion = propulsion("", 0.0);
    propulsion.command(&[2.0; 4]);
    let stages = propulsion.advance(0);
    assert!(stages.iter().all(|stage| (speeds(stage)[0] - speed_of(2.0)).abs() < 1e-3));
}

#[test]
fn a_failed_rotor_settles_at_its_share_of_the_thrust_with_the_rotors_lag() {
    let mut failing = propulsion("[failure]\nrotor = 1\ntime = 0.5\nthrust_left = 0.25", LAG_S);
    let before = after(&mut failing, 0..500);
    assert!((before - speed_of(2.0)).abs() < 1e-3);
    let later = after(&mut failing, 500..530);
    let expected = speed_of(0.5) + (before - speed_of(0.5)) * (-1.0_f64).exp();
    assert!((later - expected).abs() < 1e-3, "{later} {expected}");
    assert!((after(&mut failing, 530..2000) - speed_of(0.5)).abs() < 1e-3);
    assert!((failing.speeds()[1] - speed_of(2.0)).abs() < 1e-3);
    let mut stopping = propulsion("[failure]\nrotor = 1\ntime = 0.5", LAG_S);
    assert!(after(&mut stopping, 0..2000) < 1e-9);
}

#[test]
fn a_weakened_rotor_delivers_its_share_besides_its_failures_until_it_is_whole_again() {
    let mut weak = propulsion("[failure]\nrotor = 1\ntime = 0.5\nthrust_left = 0.5", LAG_S);
    weak.weaken(0, 0.5);
    assert!((after(&mut weak, 0..500) - speed_of(1.0)).abs() < 1e-3);
    assert!((after(&mut weak, 500..2000) - speed_of(0.5)).abs() < 1e-3);
    weak.weaken(0, 1.0);
    assert!((after(&mut weak, 2000..4000) - speed_of(1.0)).abs() < 1e-3);
    assert!((weak.speeds()[1] - speed_of(2.0)).abs() < 1e-3);
}

#[test]
fn thrust_falls_with_the_square_of_the_voltage() {
    let battery =
        "[battery]\nfull_voltage = 9.45\nempty_voltage = 9.45\nresistance = 0\ncapacity = 10\nnominal_voltage = 12.6";
    let mut sagging = propulsion(battery, LAG_S);
    let speed = after(&mut sagging, 0..2000);
    assert!((THRUST_COEFFICIENT * speed * speed - 2.0 * 0.75 * 0.75).abs() < 1e-5, "{speed}");
    assert_eq!(sagging.battery().unwrap().0, 9.45);
}

#[test]
fn a_loaded_battery_sags_by_what_the_rotors_draw() {
    let battery =
        "[battery]\nfull_voltage = 12.6\nempty_voltage = 12.6\nresistance = 0.1\ncapacity = 100\nefficiency = 0.5";
    let mut sagging = propulsion(battery, LAG_S);
    let speed = after(&mut sagging, 0..2000);
    let (voltage, current) = sagging.battery().unwrap();
    assert!((12.6 - voltage - 0.1 * current).abs() < 1e-9);
    // Settled: four shafts of k_m w^3 at half the efficiency, at the speed that this voltage gives.
    assert!((voltage * current / (4.0 * 1.36e-7 * speed.powi(3) / 0.5) - 1.0).abs() < 1e-6);
    assert!((speed / (speed_of(2.0) * voltage / 12.6) - 1.0).abs() < 1e-6 && voltage < 12.4, "{speed} {voltage}");
}

#[test]
fn a_curve_bends_the_thrust_between_none_and_all() {
    let thrust = |commanded: f32, curve: f64| {
        let mut bent = propulsion(&format!("[truth]\nthrust_curve = {curve}"), 0.0);
        bent.command(&[commanded; 4]);
        THRUST_COEFFICIENT * speeds(&bent.advance(0)[0])[0].powi(2)
    };
    let full = THRUST_COEFFICIENT * 1500.0 * 1500.0;
    // A quarter of the thrust is half the command.
    for (part, curve, expected) in
        [(0.25, 0.0, 0.25), (0.25, 1.0, 0.5), (0.25, 0.4, 0.2 + 0.15), (1.0, 0.4, 1.0), (0.0, 0.4, 0.0)]
    {
        let found = thrust((part * full) as f32, curve) / full;
        assert!((found - expected).abs() < 1e-6, "{part} {curve}: {found}");
    }
}

#[test]
fn a_model_with_the_true_curve_gets_what_it_asks_for() {
    for (linear, voltage) in [(0.4, 1.0), (1.0, 1.0), (0.4, 0.75)] {
        let text = HUMMINGBIRD.replace("[rotors] ", &format!("[rotors]\nthrust_curve = {linear} "));
        let battery = format!(
            "[battery]\nfull_voltage = {0}\nempty_voltage = {0}\nresistance = 0\ncapacity = 10\nnominal_voltage = 12.6",
            12.6 * voltage
        );
        let scenario = Scenario::parse(&format!("{text}{battery}"), "f").unwrap();
        let mut rotors = Propulsion::new(&scenario.configuration, scenario.motor(), 0.0, &scenario.reality, STEP_S);
        let full = THRUST_COEFFICIENT * 1500.0 * 1500.0;
        rotors.command(&[2.0; 4]);
        let thrust = THRUST_COEFFICIENT * speeds(&rotors.advance(0)[0])[0].powi(2);
        let curve = |u: f64| full * (linear * u + (1.0 - linear) * u * u);
        // The command whose thrust is 2 N, with less of it as the voltage is less.
        let commands = (0..=1_000_000).map(|step| f64::from(step) * 1e-6);
        let command = commands.min_by(|a, b| (curve(*a) - 2.0).abs().total_cmp(&(curve(*b) - 2.0).abs())).unwrap();
        assert!((thrust - curve(command * voltage)).abs() < 1e-4, "{linear} {voltage}: {thrust}");
    }
}

#[test]
fn a_motor_that_turns_idles_at_least_and_a_stopped_one_stands() {
    let mut propulsion = propulsion("", 0.0);
    propulsion.command(&[1e-6, 0.0, 2.0, 2.0]);
    let speeds = speeds(&propulsion.advance(0)[0]);
    assert!((speeds[0] - 0.055 * 1500.0).abs() < 1e-3 && speeds[1] == 0.0, "{speeds:?}");
}

#[test]
fn without_rotors_the_wrench_acts_within_the_limits() {
    let paper = Scenario::paper().unwrap();
    let mut direct = Propulsion::new(&paper.configuration, paper.motor(), 0.0, &paper.reality, STEP_S);
    let wrench = |thrust: f32, y: f32| Wrench { thrust, torque: Vector3::new(0.1, y, 0.0) };
    assert!(!direct.command_directly(&wrench(5.0, -0.2)));
    let torque = wrench(5.0, -0.2).torque.map(f64::from);
    assert_eq!(direct.advance(0), [Delivered::Wrench { thrust: 5.0, torque }; 3]);
    assert!(direct.command_directly(&wrench(9.0, -0.2)) && direct.command_directly(&wrench(5.0, 0.6)));
    let [Delivered::Wrench { torque, .. }, ..] = direct.advance(1) else { panic!() };
    assert_eq!(torque.y, 0.5);
    assert!(direct.battery().is_none() && direct.speeds() == [0.0; ROTORS_MAX]);
}

#[test]
fn a_command_within_the_deadband_changes_nothing() {
    let mut propulsion = propulsion("\n[truth]\ndeadband = 0.05\n", LAG_S);
    let speed = |propulsion: &Propulsion| propulsion.motors.as_ref().unwrap().commands[0];
    propulsion.command(&[2.0; 4]);
    let taken = speed(&propulsion);
    // Speeds go with the root of the thrust.
    propulsion.command(&[2.0 * 1.04 * 1.04; 4]);
    assert_eq!(speed(&propulsion), taken);
    propulsion.command(&[2.0 * 1.06 * 1.06; 4]);
    assert!((speed(&propulsion) / taken - 1.06).abs() < 1e-6);
}

#[test]
fn rotors_with_inertia_turn_the_body_back_and_make_it_precess() {
    let mut propulsion = propulsion("\n[truth]\nrotor_inertia = 1e-6\n", LAG_S);
    // Rotors 1 and 3 turn clockwise.
    propulsion.command(&[3.0, 1.0, 3.0, 1.0]);
    let before = propulsion.speeds();
    let stages = propulsion.advance(0);
    let after = propulsion.speeds();
    let gained: f64 = [1.0, -1.0, 1.0, -1.0].iter().zip(after.iter().zip(before)).map(|(s, (a, b))| s * (a - b)).sum();
    let torque = propulsion.spin(&stages[2], &Vector3::zeros());
    assert!((torque - Vector3::z() * (1e-6 * gained / 1e-3)).norm() < 1e-12 && gained > 0.0, "{torque}");
    let sum: f64 = [1.0, -1.0, 1.0, -1.0].iter().zip(after).map(|(s, w)| s * w).sum();
    let rolling = propulsion.spin(&stages[2], &Vector3::x()) - torque;
    assert!((rolling - Vector3::y() * (-1e-6 * sum)).norm() < 1e-12, "{rolling}");
}
