//! It balances as the closed form has it, and where there is none it says why.

use super::*;
use crate::Scenario;
use crate::rotor_loss::WithoutARotor;

const CRAZYFLIE: &str = include_str!("../../../../vehicles/published/cf2x-pybullet.toml");

fn relaxed_hover(text: &str, drag: &Drag) -> Result<RelaxedHover, NoHover> {
    let configuration = Scenario::parse(text, "f").unwrap().configuration;
    let law = WithoutARotor::new(&configuration, 0, 0.01).unwrap();
    RelaxedHover::new(configuration.vehicle(), configuration.rotors().unwrap(), drag, 0, &law.axis())
}

#[test]
fn without_air_it_is_the_closed_form() {
    let configuration = Scenario::parse(CRAZYFLIE, "f").unwrap().configuration;
    let vehicle = configuration.vehicle();
    let place = configuration.rotors().unwrap()[0].position;
    let (arm, spin) = (f64::from(place.xy().norm()), configuration.rotors().unwrap()[1].spin.sign());
    let weight = f64::from(vehicle.mass * vehicle.gravity);
    let hover = relaxed_hover(CRAZYFLIE, &Drag::default()).unwrap();
    // The axis leans away from the lost rotor.
    assert!(hover.axis.dot(&place.map(f64::from)) < -0.2 * arm, "{hover:?}");
    // Yaw balances where the opposite rotor gives as much as the other two.
    let opposite = 0.5 * weight / hover.axis.z;
    let [lost, one, two, three] = hover.thrusts;
    let expected = [0.0, 0.5 * opposite, opposite, 0.5 * opposite];
    for (thrust, expected) in [lost, one, two, three].into_iter().zip(expected) {
        assert!((thrust - expected).abs() < 1e-4 * weight, "{hover:?}");
    }
    let sine = hover.axis.xy().norm();
    let flat = f64::from(vehicle.inertia.z - vehicle.inertia.x);
    let rate = f64::from(spin) * (arm * opposite / (flat * sine * hover.axis.z)).sqrt();
    assert!((hover.rate / rate - 1.0).abs() < 1e-4, "{hover:?}, expected {rate}");
}

#[test]
fn drag_of_the_hubs_slows_it_and_spares_the_opposite_rotor() {
    let still = relaxed_hover(CRAZYFLIE, &Drag::default()).unwrap();
    let dragged = relaxed_hover(CRAZYFLIE, &Drag { rotor_across: 1e-5, ..Drag::default() }).unwrap();
    assert!(dragged.rate.abs() < 0.9 * still.rate.abs() && dragged.thrusts[2] < still.thrusts[2], "{dragged:?}");
}

#[test]
fn a_vehicle_without_one_says_why() {
    let none = |text: &str| relaxed_hover(text, &Drag::default()).unwrap_err();
    let weak = none(include_str!("../../../../vehicles/published/x500.toml"));
    assert!(matches!(weak, NoHover::TooLittleThrust(share) if (0.75..0.9).contains(&share)), "{weak:?}");
    assert_eq!(none(include_str!("../../../../vehicles/published/racer-pybullet.toml")), NoHover::Unbounded);
    assert_eq!(none(include_str!("../../../../vehicles/published/firefly.toml")), NoHover::Unbalanced);
}
