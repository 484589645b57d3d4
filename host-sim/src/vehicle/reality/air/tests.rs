//! Forces beside RotorPy's own numbers, and beside arithmetic.

use super::*;
use scenario::Scenario;

const HUMMINGBIRD: &str = include_str!("../../../../../vehicles/hummingbird.toml");

fn rotors(heights: [f32; 4]) -> Rotors {
    let scenario = Scenario::parse(HUMMINGBIRD, "hummingbird").unwrap();
    let mut list: Vec<Rotor> = scenario.configuration.rotors().unwrap().to_vec();
    for (rotor, height) in list.iter_mut().zip(heights) {
        rotor.position.z = height;
    }
    Rotors::new(&list).unwrap()
}

fn truth() -> Truth {
    Truth::model(Scenario::parse(HUMMINGBIRD, "hummingbird").unwrap().configuration.vehicle())
}

fn speeds(list: [f64; 4]) -> Delivered {
    let mut speeds = [0.0; ROTORS_MAX];
    speeds[..4].copy_from_slice(&list);
    Delivered::Speeds(speeds)
}

/// RotorPy's Hummingbird; its flapping coefficient is zero, so another one here.
fn rotorpys() -> Drag {
    Drag {
        linear: Vector3::zeros(),
        frame: Vector3::new(0.5e-2, 0.5e-2, 1e-2),
        rotor_across: 1.19e-4,
        rotor_along: 2.32e-4,
        translational_lift: 3.39e-3,
        flapping: 1.3e-7,
    }
}

#[test]
fn the_same_parameters_give_rotorpys_forces_and_moments() {
    let air = Air::new(Some(&rotors([0.01, -0.02, 0.03, 0.005])), &truth(), &rotorpys());
    let airspeed = Vector3::new(3.1, -2.2, 1.7);
    let flow = Flow { airspeed, angular_velocity: Vector3::new(1.5, -2.5, 3.5), ground_effect: 0.0 };
    let (force, torque) = air.act(&flow, &speeds([400.0, 520.0, 610.0, 450.0]));
    // `compute_body_wrench` of RotorPy 2.1.2 with these heights and this flapping.
    let expected_force = Vector3::new(-0.8047750866823368, 0.5737045616700455, 4.9678792595913315);
    let expected_torque = Vector3::new(-0.193395763115101, 0.1052764615839146, -0.03312335325944575);
    // The model's single-precision coefficients are within 6e-8 of RotorPy's.
    assert!((force - expected_force).norm() < 1e-6, "{force} {expected_force}");
    assert!((torque - expected_torque).norm() < 1e-7, "{torque} {expected_torque}");
}

#[test]
fn still_air_leaves_the_thrusts_and_a_centre_of_mass_off_the_middle_turns_with_r_cross_f() {
    let offset = Vector3::new(0.005, -0.003, 0.02);
    let air = Air::new(Some(&rotors([0.0; 4])), &Truth { centre_of_mass: offset, ..truth() }, &Drag::default());
    let still = Flow { airspeed: Vector3::zeros(), angular_velocity: Vector3::zeros(), ground_effect: 0.0 };
    let (force, torque) = air.act(&still, &speeds([450.0; 4]));
    let thrust = 4.0 * 5.57e-6 * 450.0 * 450.0;
    assert!((force - Vector3::z() * thrust).norm() < 1e-6);
    // The thrusts' resultant acts at the origin, -r_c from the centre of mass.
    let expected = Vector3::new(0.003 * thrust, 0.005 * thrust, 0.0);
    assert!((torque - expected).norm() < 1e-7, "{torque}");
    // The same without rotors.
    let direct = Air::new(None, &Truth { centre_of_mass: offset, ..truth() }, &Drag::default());
    let wrench = Delivered::Wrench { thrust, torque: Vector3::zeros() };
    assert!((direct.act(&still, &wrench).1 - torque).norm() < 1e-6);
}

#[test]
fn each_scale_acts_on_its_rotors_thrust_and_drag_torque() {
    let scaled = Truth { thrust_scale: 0.8, rotor_scales: vec![1.0, 0.5, 1.0, 1.0], ..truth() };
    let air = Air::new(Some(&rotors([0.0; 4])), &scaled, &Drag::default());
    let still = Flow { airspeed: Vector3::zeros(), angular_velocity: Vector3::zeros(), ground_effect: 0.0 };
    let (force, torque) = air.act(&still, &speeds([500.0; 4]));
    let whole = 5.57e-6 * 500.0 * 500.0;
    assert!((force.z - 0.8 * 3.5 * whole).abs() < 1e-6);
    // Rotor 2 at (0.12, -0.12) lacks 0.4 of its thrust: rolled by -y and pitched by +x of what is missing.
    let arm = f64::from(0.120208_f32);
    let expected = Vector3::new(arm * 0.4 * whole, arm * 0.4 * whole, 0.4 * 1.36e-7 * 500.0 * 500.0);
    assert!((torque - expected).norm() < 1e-6, "{torque}");
    let mut list = [0.0; ROTORS_MAX];
    list[..4].fill(500.0);
    let thrusts = air.thrusts(&list);
    assert!((thrusts[1] - 0.4 * whole).abs() < 1e-6 && (thrusts[0] - 0.8 * whole).abs() < 1e-6 && thrusts.len() == 4);
}

#[test]
fn frame_drag_acts_at_the_origin_and_grows_with_the_square() {
    let drag = Drag { frame: Vector3::new(0.01, 0.02, 0.03), linear: Vector3::new(0.1, 0.2, 0.3), ..Drag::default() };
    let offset = Vector3::new(0.0, 0.0, -0.05);
    let air = Air::new(None, &Truth { centre_of_mass: offset, ..truth() }, &drag);
    let none = Delivered::Wrench { thrust: 0.0, torque: Vector3::zeros() };
    let at = |airspeed: Vector3<f64>| {
        air.act(&Flow { airspeed, angular_velocity: Vector3::zeros(), ground_effect: 0.0 }, &none)
    };
    let (force, torque) = at(Vector3::new(3.0, 0.0, 4.0));
    // |V| = 5.
    let expected = Vector3::new(-(0.01 * 5.0 + 0.1) * 3.0, 0.0, -(0.03 * 5.0 + 0.3) * 4.0);
    assert!((force - expected).norm() < 1e-12);
    assert!((torque + offset.cross(&expected)).norm() < 1e-12);
    // A body that turns about its centre of mass drags its origin through the air.
    let turning = Flow { airspeed: Vector3::zeros(), angular_velocity: Vector3::y() * 10.0, ground_effect: 0.0 };
    let moving = -Vector3::new(0.0, 10.0, 0.0).cross(&offset);
    let (force, _) = air.act(&turning, &none);
    assert!((force.x + (0.01 * moving.norm() + 0.1) * moving.x).abs() < 1e-12 && force.x != 0.0);
}

#[test]
fn the_ground_lifts_rotors_by_a_third_where_they_stand_and_by_little_above() {
    assert!((ground_effect(0.1, 0.0) - 1.0 / 3.0).abs() < 1e-12 && ground_effect(0.1, -1.0) == ground_effect(0.1, 0.0));
    assert!((ground_effect(0.1, 0.05) - 1.0 / 15.0).abs() < 1e-12 && ground_effect(0.1, 1.0) < 1e-3);
    assert_eq!(ground_effect(0.0, 0.0), 0.0);
    let air = Air::new(Some(&rotors([0.0; 4])), &truth(), &Drag::default());
    let at = |ground_effect: f64| {
        let flow = Flow { airspeed: Vector3::zeros(), angular_velocity: Vector3::zeros(), ground_effect };
        air.act(&flow, &speeds([450.0; 4])).0.z
    };
    assert!((at(0.25) / at(0.0) - 1.25).abs() < 1e-12);
}
