//! Who is blamed, for terms and thrusts that leave no doubt.

use super::*;
use controller_core::allocation::Shape;
use controller_core::certificate::Certificate;
use controller_core::certificate::form::Interval;

fn terms(sets: &[(&'static str, Shape)]) -> Vec<TorqueTerm> {
    sets.iter().map(|(name, shape)| TorqueTerm::new(name, *shape).unwrap()).collect()
}

/// The Hummingbird's rotor 3, upwards: a newton metre of yaw costs it 10.24 N, one of roll or pitch 2.08 N.
const ROTOR_3_ROW: Vector4<f64> = Vector4::new(0.25, -2.08, 2.08, 10.24);

fn form(least: f64, greatest: f64) -> Form {
    let paper = scenario::Scenario::paper().unwrap();
    let certificate = Certificate::new(&paper.configuration).unwrap().paper().unwrap().clone();
    Form { thrust: Interval { min: least, max: greatest }, ..certificate.sharp }
}

#[test]
fn the_largest_displacement_is_blamed_and_the_costliest_axis_named() {
    let ball = |radius| Shape::Ball { radius };
    let balls = terms(&[("small", ball(0.01)), ("large", ball(0.2))]);
    assert_eq!(cause(&form(5.0, 5.0), &balls, &-ROTOR_3_ROW, 0.0).0, "large");
    assert_eq!(weak_axis(&balls, &torque_part(&ROTOR_3_ROW)).0, "yaw");
    let rolling = terms(&[("roll", Shape::Ellipsoid { semi_axes: Vector3::new(0.3, 0.1, 0.001) })]);
    assert_eq!(weak_axis(&rolling, &torque_part(&ROTOR_3_ROW)).0, "roll");
}

#[test]
fn the_thrust_is_blamed_for_its_swing_and_for_a_share_beyond_the_limit() {
    let small = terms(&[("small", Shape::Ball { radius: 0.01 })]);
    assert_eq!(cause(&form(5.0, 60.0), &small, &ROTOR_3_ROW, 12.5).0, "thrust");
    let large = terms(&[("large", Shape::Ball { radius: 0.5 })]);
    let (blame, beyond) = cause(&form(60.0, 60.0), &large, &ROTOR_3_ROW, 12.5);
    assert!(blame == "thrust" && (beyond - 2.5).abs() < 1e-12);
}
