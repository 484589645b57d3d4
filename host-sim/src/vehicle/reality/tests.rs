//! The whole vehicle against closed forms, against RotorPy, and against the model's own vehicle where reality is the
//! model.

use super::*;
use crate::vehicle::SimulatedVehicle;
use controller_core::state::Wrench;
use nalgebra::Quaternion;

const HUMMINGBIRD: &str = include_str!("../../../../vehicles/hummingbird-paper-law.toml");
const PAPER: &str = scenario::PAPER;

/// The Hummingbird's file with other `[initial]` and `[reference]`, in hover, and what `sections` say.
fn scenario(sections: &str) -> Scenario {
    let (head, _) = HUMMINGBIRD.split_once("[initial]").unwrap();
    let text = format!("{head}[reference]\nkind = \"hover\"\nposition = [0.0, 0.0, 0.0]\n{sections}");
    Scenario::parse(&text, "f").unwrap()
}

fn vehicle(scenario: &Scenario) -> RealVehicle {
    RealVehicle::new(scenario, &scenario.configuration)
}

/// The paper's vehicle, without rotors, level and at rest in the origin.
fn direct(sections: &str) -> RealVehicle {
    let (head, _) = PAPER.split_once("[initial]").unwrap();
    let text = format!("{head}[reference]\nkind = \"hover\"\nposition = [0.0, 0.0, 0.0]\n{sections}");
    vehicle(&Scenario::parse(&text, "f").unwrap())
}

fn wrench(thrust: f32, torque: [f32; 3]) -> Wrench {
    Wrench { thrust, torque: Vector3::from(torque) }
}

fn asked(thrust: f32, torque: [f32; 3]) -> ActuatorDemand {
    ActuatorDemand::Wrench(wrench(thrust, torque))
}

fn gap(a: &BodyState, b: &BodyState) -> f64 {
    (a.position - b.position).norm()
        + (a.velocity - b.velocity).norm()
        + (a.attitude - b.attitude).norm()
        + (a.angular_velocity - b.angular_velocity).norm()
}

#[test]
fn a_fall_approaches_the_terminal_velocity_of_linear_drag() {
    let mut falling = direct("[drag]\nlinear = [0.0, 0.0, 0.3]");
    let (mass, gravity) = (f64::from(0.46_f32), f64::from(9.81_f32));
    let (terminal, time) = (mass * gravity / 0.3, mass / 0.3);
    for second in 1..=20 {
        falling.hold(&asked(0.0, [0.0; 3]), 1000).unwrap();
        let t = f64::from(second);
        let expected = -terminal * (1.0 - (-t / time).exp());
        assert!((falling.state().velocity.z - expected).abs() < 1e-11, "{t} s: {}", falling.state().velocity.z);
        let height = -terminal * (t - time * (1.0 - (-t / time).exp()));
        assert!((falling.state().position.z - height).abs() < 1e-10);
    }
    assert!((falling.state().velocity.z + terminal).abs() < 1e-4);
}

#[test]
fn a_fall_approaches_the_terminal_velocity_of_quadratic_drag() {
    let mut falling = direct("[drag]\nframe = [0.0, 0.0, 0.02]");
    let (mass, gravity) = (f64::from(0.46_f32), f64::from(9.81_f32));
    let terminal = (mass * gravity / 0.02).sqrt();
    falling.hold(&asked(0.0, [0.0; 3]), 1000).unwrap();
    assert!((falling.state().velocity.z + terminal * (gravity / terminal).tanh()).abs() < 1e-11);
    falling.hold(&asked(0.0, [0.0; 3]), 20_000).unwrap();
    assert!((falling.state().velocity.z + terminal).abs() < 1e-4);
}

#[test]
fn wind_carries_a_level_vehicle_along() {
    let mut carried = direct("[drag]\nlinear = [0.23, 0.23, 0.0]\n[wind]\nsteady = [5.0, -1.0, 0.0]");
    carried.hold(&asked(0.46 * 9.81, [0.0; 3]), 2000).unwrap();
    // 0.46 kg over 0.23 kg/s: 2 s.
    let expected = Vector3::new(5.0, -1.0, 0.0) * (1.0 - (-2.0 * 0.23 / f64::from(0.46_f32)).exp());
    assert!((carried.state().velocity - expected).norm() < 1e-6, "{}", carried.state().velocity);
    assert_eq!(carried.surroundings().wind, Some(Vector3::new(5.0, -1.0, 0.0)));
}

#[test]
fn half_a_second_of_flight_is_rotorpys() {
    let (head, tail) = HUMMINGBIRD.split_once("[initial]").unwrap();
    let (_, reference) = tail.split_once("[reference]").unwrap();
    let mut head = head.replace("lag = 0.005", "lag = 0.03");
    // A different height for each rotor.
    for (place, height) in [
        ("[0.120208, 0.120208,", "0.01"),
        ("[0.120208, -0.120208,", "-0.02"),
        ("[-0.120208, -0.120208,", "0.03"),
        ("[-0.120208, 0.120208,", "0.005"),
    ] {
        assert!(head.contains(place));
        head = head.replace(&format!("{place} 0.0]"), &format!("{place} {height}]"));
    }
    let text = format!(
        "{head}[reference]{reference}
[initial]
position = [0.0, 0.0, 0.0]
velocity = [1.0, 2.0, -3.0]
angular_velocity = [1.5, -2.5, 3.5]
[drag]
frame = [0.5e-2, 0.5e-2, 1e-2]
rotor_across = 1.19e-4
rotor_along = 2.32e-4
translational_lift = 3.39e-3
flapping = 1.3e-7
[wind]
steady = [5.0, -1.0, 0.5]
"
    );
    let mut flying = vehicle(&Scenario::parse(&text, "f").unwrap());
    let attitude = Quaternion::new(0.927311165102597, 0.10003356689348404, -0.20006713378696808, 0.3001007006804521);
    flying.body.place(&BodyState { attitude, ..flying.state });
    let thrust = |speed: f64| (5.57e-6 * speed * speed) as f32;
    flying.propulsion.command(&[500.0, 480.0, 470.0, 505.0].map(thrust));
    for _ in 0..500 {
        flying.advance();
    }
    // RotorPy 2.1.2, `Multirotor.step` over 0.5 s by DOP853 with a relative tolerance of 1e-12.
    let expected = BodyState {
        position: Vector3::new(0.7143132621116034, -0.007902173132514463, -1.3737406469831124),
        velocity: Vector3::new(3.292162895947511, -1.5368015587115453, -2.8866346030827477),
        attitude: Quaternion::new(0.14050857618623921, 0.47299908697919596, 0.11097133061378212, 0.8626787162766736),
        angular_velocity: Vector3::new(4.71663768384977, 1.5263861906582428, 1.9045617735425218),
    };
    // Single-precision vehicle data and speeds: 1e-7 of accelerations up to 200 rad/s^2.
    assert!(gap(flying.state(), &expected) < 2e-5, "{:e}", gap(flying.state(), &expected));
}

#[test]
fn an_offset_centre_of_mass_turns_the_vehicle_by_r_cross_f() {
    let mut offset = direct("[truth]\ncentre_of_mass = [0.004, -0.002, 0.0]");
    offset.hold(&asked(4.5, [0.0; 3]), 1).unwrap();
    let torque = -Vector3::new(0.004, -0.002, 0.0).cross(&Vector3::new(0.0, 0.0, 4.5));
    let inertia = Scenario::paper().unwrap().configuration.vehicle().inertia.map(f64::from);
    let turned = torque.component_div(&inertia) * 1e-3;
    // From rest: products of the rates come in at the third order of the step.
    assert!((offset.state().angular_velocity - turned).norm() < 1e-8, "{}", offset.state().angular_velocity);
}

#[test]
fn a_disturbance_pushes_in_the_world_and_turns_in_the_body_from_its_time_on() {
    let mut pushed = direct(
        "[disturbance]\nacceleration = [1.0, -2.0, 0.5]\nstart = 0.1\n[truth]\nmass = 0.92\n[initial]\neuler_deg = [0, 0, 90]",
    );
    pushed.hold(&asked(0.0, [0.0; 3]), 100).unwrap();
    let fallen = Vector3::z() * (-0.1 * f64::from(9.81_f32));
    assert!((pushed.state().velocity - fallen).norm() < 1e-12);
    pushed.hold(&asked(0.0, [0.0; 3]), 100).unwrap();
    // The force is the model's mass times the acceleration, and the vehicle is twice as heavy.
    let gained = Vector3::new(0.5, -1.0, 0.25) * 0.1 + fallen * 2.0;
    assert!((pushed.state().velocity - gained).norm() < 1e-7, "{}", pushed.state().velocity);
    let mut turned = direct("[disturbance]\ntorque = [0.0, 0.0, 0.0053]");
    turned.hold(&asked(0.0, [0.0; 3]), 1000).unwrap();
    assert!((turned.state().angular_velocity - Vector3::z()).norm() < 1e-6);
}

#[test]
fn true_mass_inertia_and_thrust_scale_act() {
    let mut heavy = direct("[truth]\nmass = 0.92\ninertia = [2e-3, 4e-3, 5e-3]\nthrust_scale = 0.5");
    heavy.hold(&asked(6.0, [0.01, 0.02, -0.03]), 1).unwrap();
    let state = heavy.state();
    assert!((state.velocity.z - (0.5 * 6.0 / 0.92 - f64::from(9.81_f32)) * 1e-3).abs() < 1e-9);
    let turned = Vector3::new(0.005 / 2e-3, 0.01 / 4e-3, -0.015 / 5e-3) * 1e-3;
    // A torque that acts from rest: products of the rates come in at the third order of the step.
    assert!((state.angular_velocity - turned).norm() < 1e-8, "{}", state.angular_velocity);
}

#[test]
fn the_true_lag_is_the_rotors() {
    let thrust_after_its_lag = |sections: &str| {
        let mut lagging = vehicle(&scenario(sections));
        lagging.hold(&asked(9.0, [0.0; 3]), 20).unwrap();
        lagging.thrusts().iter().sum::<f64>()
    };
    let speed = |thrust: f64| (thrust / 4.0 / 5.57e-6).sqrt();
    let expected = speed(9.0) + (speed(0.5 * 9.81) - speed(9.0)) * (-1.0_f64).exp();
    let found = thrust_after_its_lag("[truth]\nlag = 0.02");
    assert!((found - 4.0 * 5.57e-6 * expected * expected).abs() < 1e-5, "{found}");
    assert_ne!(thrust_after_its_lag("[truth]"), found);
}

#[test]
fn where_reality_is_the_model_the_vehicle_is_the_models() {
    let real = scenario("[truth]");
    let mut flying = vehicle(&real);
    let mut model = SimulatedVehicle::new(&scenario(""), &real.configuration);
    let SimulatedVehicle::Model(..) = model else { panic!("the file says nothing of reality") };
    for k in 0..200_u8 {
        let x = f32::from(k);
        let wrench = wrench(4.9 + 0.5 * (0.3 * x).sin(), [0.02 * x.cos(), 0.02 * (0.7 * x).sin(), 0.005 * x.sin()]);
        let (real, modelled) = (
            flying.hold(&ActuatorDemand::Wrench(wrench), 10).unwrap(),
            model.hold(&ActuatorDemand::Wrench(wrench), 10).unwrap(),
        );
        assert_eq!(real, modelled);
    }
    // The model feels the rotors at the middle of each step: (step / lag)^2 / 24 of each change.
    let gap = gap(flying.state(), model.state());
    assert!(gap > 0.0 && gap < 2e-3, "{gap:e}");
    assert!(flying.thrusts().iter().zip(model.thrusts()).all(|(a, b)| (a - b).abs() < 1e-12));
    assert_eq!(flying.surroundings(), Surroundings::default());
}

#[test]
fn a_delay_takes_effect_at_its_step() {
    let moved = |steps: u32| {
        let mut late = direct("[truth]\n[sampling]\ndelay = 0.007");
        late.hold(&asked(6.0, [0.0; 3]), steps).unwrap();
        late.state().velocity.z.abs() > 1e-5
    };
    assert!(!moved(7) && moved(8));
}

#[test]
fn halving_the_step_divides_the_error_by_sixteen_with_drag_and_lag() {
    let sections = "
[drag]
frame = [0.5e-2, 0.5e-2, 1e-2]
rotor_across = 1.19e-4
rotor_along = 2.32e-4
translational_lift = 3.39e-3
[wind]
steady = [3.0, -2.0, 1.0]
gust = { kind = \"one-cosine\", start = 0.0, velocity = [4.0, 2.0, 0.0], duration = 3.0 }
[truth]
centre_of_mass = [0.005, 0.002, -0.003]
[initial]
velocity = [3.0, -1.0, 2.0]
euler_deg = [20.0, -30.0, 50.0]
angular_velocity = [2.0, -1.0, 1.5]
";
    // One second under one command: rotors that lag 30 ms, from hover to unequal speeds.
    let flown = |steps: u32| {
        let (head, _) = HUMMINGBIRD.split_once("[initial]").unwrap();
        let head = head
            .replace("lag = 0.005", "lag = 0.03")
            .replace("step = 0.001", &format!("step = {:e}", 1e-2 / f64::from(steps)));
        let text = format!("{head}[reference]\nkind = \"hover\"\nposition = [0.0, 0.0, 0.0]\n{sections}");
        let mut flying = vehicle(&Scenario::parse(&text, "f").unwrap());
        flying.hold(&asked(5.5, [0.01, -0.008, 0.004]), 100 * steps).unwrap();
        *flying.state()
    };
    let exact = flown(64);
    let errors = [1, 2, 4].map(|steps| gap(&flown(steps), &exact));
    println!("errors at 10, 5, 2.5 ms: {errors:?}, ratios {} {}", errors[0] / errors[1], errors[1] / errors[2]);
    for pair in errors.windows(2) {
        assert!((15.0..17.0).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

#[test]
fn a_vehicle_on_the_ground_stands_until_it_is_lifted_and_again_when_it_falls() {
    let mut standing = direct(
        "[ground]\nheight = 0.0\n[truth]\nmass = 0.5\n[drag]\nlinear = [0.3, 0.3, 0.3]\n[wind]\nsteady = [9.0, 0.0, 0.0]",
    );
    let start = *standing.state();
    // The wind's 2.7 N do not push it where its feet carry 4.9 N.
    standing.hold(&asked(0.0, [0.1, 0.1, 0.1]), 1000).unwrap();
    assert_eq!(*standing.state(), start);
    // Lighter than the true weight of 4.9 N, though not than the model's of 4.5 N: it slides.
    standing.hold(&asked(4.8, [0.1, 0.1, 0.1]), 20).unwrap();
    assert!(standing.state().velocity.x > 0.05 && standing.state().position.z == 0.0);
    assert!(standing.surroundings().standing);
    standing.hold(&asked(6.0, [0.0; 3]), 500).unwrap();
    assert!(!standing.surroundings().standing);
    assert!(standing.state().position.z > 0.1 && standing.state().velocity.x > 0.5);
    standing.hold(&asked(0.0, [0.0; 3]), 5000).unwrap();
    let end = standing.state();
    assert_eq!(end.velocity, Vector3::zeros());
    assert!(standing.surroundings().standing);
    assert!(end.position.z <= 0.0 && end.position.z > -0.01, "{}", end.position.z);
    let before = *end;
    standing.hold(&asked(0.0, [0.1; 3]), 100).unwrap();
    assert_eq!(*standing.state(), before);
}

#[test]
fn what_is_no_number_is_refused_or_ends_the_flight() {
    let mut with_rotors = vehicle(&scenario("[truth]"));
    let refused = with_rotors.hold(&asked(f32::NAN, [0.0; 3]), 10);
    assert!(matches!(refused, Err(ActuationError::Wrench(_))), "{refused:?}");
    let without = direct("[truth]").hold(&asked(f32::NAN, [0.0; 3]), 10);
    assert!(matches!(without, Err(ActuationError::Diverged(_))), "{without:?}");
}
