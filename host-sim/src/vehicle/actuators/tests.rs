//! Lag against its closed form, delays to the step, and nothing at all where the file asks for nothing.

use super::*;
use scenario::Scenario;
use scenario::body::{BodyState, attitude_from_euler};

const HUMMINGBIRD: &str = include_str!("../../../../vehicles/hummingbird.toml");
const STEP_S: f64 = 1e-3;
const HOVER_N: f32 = 0.5 * 9.81;
const LAG_S: f64 = 0.03;

fn hummingbird() -> Scenario {
    Scenario::parse(HUMMINGBIRD, "hummingbird").unwrap()
}

fn plant(step: f64) -> Plant {
    let configuration = hummingbird().configuration;
    let (rest, attitude) = (Vector3::zeros(), attitude_from_euler(0.0, 0.0, 0.0));
    let state = BodyState { position: rest, velocity: rest, attitude, angular_velocity: rest };
    Plant::new(configuration.vehicle(), configuration.limits(), step, state)
}

/// The vehicle's rotors with a lag of so many s, behind the mixer: these wrenches are not a certified law's.
fn rotors(lag: f64, delay_steps: u64, step: f64) -> Actuators {
    let configuration = hummingbird().configuration;
    let rotors = configuration.rotors().unwrap();
    let spinning = SpinningRotors::hovering(rotors, lag, HOVER_N, step);
    Actuators::new(Some((Box::new(Mixer::new(rotors)), spinning)), delay_steps, HOVER_N)
}

fn wrench(thrust: f32, x: f32, y: f32, z: f32) -> Wrench {
    Wrench { thrust, torque: Vector3::new(x, y, z) }
}

fn asked(thrust: f32, x: f32, y: f32, z: f32) -> ActuatorDemand {
    ActuatorDemand::Wrench(wrench(thrust, x, y, z))
}

#[test]
fn without_rotors_and_delay_the_plant_is_the_plant_bit_for_bit() {
    let (mut direct, mut through) = (plant(STEP_S), plant(STEP_S));
    let mut actuators = Actuators::new(None, 0, HOVER_N);
    for k in 0..200_u8 {
        let x = f32::from(k);
        let wrench = wrench(25.0 * (0.3 * x).sin(), 0.02 * x.cos(), 1.5 * (0.7 * x).sin(), 0.01);
        let (clipped, thrusts) = actuators.hold(&mut through, &ActuatorDemand::Wrench(wrench), 10).unwrap();
        assert_eq!(clipped, direct.hold(&wrench, 10).unwrap());
        assert!(thrusts.is_empty());
        assert_eq!(through.state(), direct.state());
    }
}

#[test]
fn a_delay_takes_effect_at_its_step_and_not_one_sooner() {
    let commands = [wrench(6.0, 0.01, 0.0, 0.0), wrench(4.0, 0.0, -0.02, 0.0), wrench(5.0, 0.0, 0.0, 0.03)];
    for delay in [1, 7, 10, 13, 25] {
        let (mut direct, mut through) = (plant(STEP_S), plant(STEP_S));
        let mut actuators = Actuators::new(None, delay, HOVER_N);
        for (tick, command) in commands.iter().chain(&commands).enumerate() {
            actuators.hold(&mut through, &ActuatorDemand::Wrench(*command), 10).unwrap();
            for step in 10 * tick as u64..10 * (tick as u64 + 1) {
                // The wrench of tick k acts from step 10 k + delay on; before the first one, hovering thrust.
                let acting = step
                    .checked_sub(delay)
                    .map_or(wrench(HOVER_N, 0.0, 0.0, 0.0), |since| commands[since as usize / 10 % 3]);
                direct.hold(&acting, 1).unwrap();
            }
            assert_eq!(through.state(), direct.state(), "delay {delay}, tick {tick}");
        }
    }
}

#[test]
fn a_delay_holds_rotors_back_as_well() {
    let still = |delay| {
        let mut plant = plant(STEP_S);
        let mut actuators = rotors(0.0, delay, STEP_S);
        actuators.hold(&mut plant, &asked(8.0, 0.0, 0.0, 0.0), 10).unwrap();
        plant.state().velocity.z.abs() < 1e-5
    };
    assert!(!still(9) && still(10));
}

/// Velocity gained in 50 ms of a thrust step, less the closed form's, relative to the latter.
fn thrust_error(step: f64) -> f64 {
    let mut plant = plant(step);
    let mut actuators = rotors(LAG_S, 0, step);
    let duration = 0.05;
    actuators.hold(&mut plant, &asked(9.0, 0.0, 0.0, 0.0), (duration / step).round() as u32).unwrap();
    // Thrust 4 k (c + (s - c) e^(-t/lag))^2, integrated.
    let coefficient = f64::from(hummingbird().configuration.rotors().unwrap()[0].thrust_coefficient);
    let (s, c) = ((f64::from(HOVER_N) / 4.0 / coefficient).sqrt(), (9.0 / 4.0 / coefficient).sqrt());
    let gone = |rate: f64| (1.0 - (-rate * duration / LAG_S).exp()) * LAG_S / rate;
    let impulse = 4.0 * coefficient * (c * c * duration + 2.0 * c * (s - c) * gone(1.0) + (s - c).powi(2) * gone(2.0));
    let exact = impulse / 0.5 - f64::from(9.81_f32) * duration;
    (plant.state().velocity.z - exact) / exact
}

#[test]
fn thrust_is_the_square_of_the_lagging_speed_to_second_order_in_the_step() {
    let (coarse, fine) = (thrust_error(1e-3), thrust_error(5e-4));
    // (step / lag)^2 / 24 = 4.6e-5 of the transient; single-precision speeds add 1e-7.
    assert!(coarse.abs() < 5e-5, "{coarse:e}");
    assert!((coarse / fine - 4.0).abs() < 0.2, "{coarse:e} {fine:e}");
}

#[test]
fn rotors_start_at_the_speeds_that_hover() {
    let mut plant = plant(STEP_S);
    let mut actuators = rotors(LAG_S, 0, STEP_S);
    let (clipped, thrusts) = actuators.hold(&mut plant, &asked(HOVER_N, 0.0, 0.0, 0.0), 1000).unwrap();
    assert!(!clipped && thrusts.iter().all(|thrust| (thrust - HOVER_N / 4.0).abs() < 1e-6));
    // Single-precision rotor speeds: 1e-7 of gravity over a second.
    assert!(
        plant.state().velocity.amax() < 1e-5 && plant.state().angular_velocity.amax() < 1e-4,
        "{:?}",
        plant.state()
    );
}

#[test]
fn what_the_rotors_lack_is_flagged() {
    let cut = |wrench: &Wrench| {
        rotors(LAG_S, 0, STEP_S).hold(&mut plant(STEP_S), &ActuatorDemand::Wrench(*wrench), 10).unwrap().0
    };
    // Two rotors at their least thrust, 0.059 N, leave the others all yaw: k_m / k_eta = 24.4 mm of 4.9 N less 0.24 N.
    assert!(!cut(&wrench(HOVER_N, 0.0, 0.0, 0.113)) && cut(&wrench(HOVER_N, 0.0, 0.0, 0.115)));
    assert!(cut(&wrench(60.0, 0.0, 0.0, 0.0)) && cut(&wrench(-1.0, 0.0, 0.0, 0.0)));
    assert!(cut(&wrench(HOVER_N, 9.0, 0.0, 0.0)));
}

#[test]
fn a_wrench_that_is_no_number_is_refused() {
    let mut actuators = rotors(LAG_S, 0, STEP_S);
    let refused = actuators.hold(&mut plant(STEP_S), &asked(f32::NAN, 0.0, 0.0, 0.0), 10);
    assert!(matches!(refused, Err(ActuationError::Wrench(_))), "{refused:?}");
}
