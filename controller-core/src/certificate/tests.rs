use super::*;
use crate::gains::{GainParameters, Gains};
use crate::reference::ReferenceBounds;
use crate::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
use nalgebra::Vector3;

/// The paper's experiment, Section VI.
pub(crate) fn paper() -> Configuration {
    let inertia = Vector3::new(2.24e-3, 2.9e-3, 5.3e-3);
    let vehicle = Vehicle::new(VehicleParameters { mass: 0.46, inertia, gravity: 9.81 }).unwrap();
    let torque_max = Vector3::repeat(0.5);
    let limits = Limits::new(LimitParameters { thrust_max: 7.0, torque_max }, &vehicle).unwrap();
    let f = 0.418_879_02_f32;
    let swing = core::f32::consts::PI * f;
    let bounds = ReferenceBounds {
        horizontal_speed: 5.0,
        horizontal_acceleration: f * f,
        vertical_acceleration: f * f,
        jerk: core::f32::consts::SQRT_2 * f * f * f,
        snap: core::f32::consts::SQRT_2 * f * f * f * f,
        heading_rate: swing,
        heading_second_derivative: swing * swing,
    };
    Configuration::new(vehicle, limits, Gains::new(GainParameters::TABLE_1, &vehicle).unwrap(), bounds).unwrap()
}

/// Both forms of what is worked out for the paper's law.
fn printed_and_sharp(configuration: &Configuration) -> [form::Form; 2] {
    let certificate = Certificate::new(configuration).unwrap();
    let paper = certificate.paper().unwrap();
    [paper.printed, paper.sharp]
}

#[test]
fn table_1_is_refused_as_printed_and_in_yaw_only() {
    let printed = printed_and_sharp(&paper())[0];
    assert!(!printed.holds());
    assert!((printed.torque - Vector3::new(0.379, 0.446, 0.664)).amax() < 1e-3, "{}", printed.torque);
    let failing = printed.inequalities.iter().filter(|inequality| !inequality.holds());
    assert!(failing.map(|inequality| inequality.name).eq(["T2 yaw torque"]));
}

#[test]
fn table_1_is_certified_by_the_sharp_bound_within_the_published_figures() {
    let sharp = printed_and_sharp(&paper())[1];
    assert!(sharp.holds());
    let published = Vector3::new(0.29, 0.33, 0.48);
    assert!(sharp.torque.iter().zip(published.iter()).all(|(ours, theirs)| ours <= theirs), "{}", sharp.torque);
    assert!(sharp.thrust.max <= 6.19 && (sharp.thrust.min - 3.512).abs() < 1e-3, "{:?}", sharp.thrust);
}

#[test]
fn theorem_1s_interval_is_the_published_one() {
    let thrust = printed_and_sharp(&paper())[0].thrust;
    assert!((thrust.min - 3.512).abs() < 1e-3 && (thrust.max - 6.188).abs() < 1e-3, "{thrust:?}");
}

#[test]
fn references_that_the_vehicle_cannot_follow_at_all_fail_assumption_1() {
    let paper = paper();
    let fails = |bounds: ReferenceBounds, name: &str| {
        let configuration = paper.with_bounds(bounds).unwrap();
        let certificate = Certificate::new(&configuration).unwrap();
        let failing = |form: &form::Form| form.inequalities.iter().any(|i| i.name == name && !i.holds());
        assert!(printed_and_sharp(&configuration).iter().all(failing) && !certificate.holds(), "{name}");
    };
    // 7 N on 0.46 kg is 15.2 m/s^2: with gravity, less than 12 sideways.
    fails(ReferenceBounds { horizontal_acceleration: 12.0, ..*paper.bounds() }, "A1 thrust for the reference");
    fails(ReferenceBounds { snap: 2500.0, ..*paper.bounds() }, "A1 yaw torque for the reference");
}

#[test]
fn a_reference_that_leaves_no_upward_thrust_is_no_configuration() {
    let paper = paper();
    let falling = ReferenceBounds { vertical_acceleration: 7.9, ..*paper.bounds() };
    assert_eq!(paper.with_bounds(falling).unwrap_err().field, "gains.m_p");
}

#[test]
fn with_a_floor_the_least_thrust_is_the_floors() {
    let configuration = paper().with_thrust_floor(2.0).unwrap();
    for form in printed_and_sharp(&configuration) {
        assert!((form.thrust.min - 2.0).abs() < 1e-3, "{:?}", form.thrust);
    }
}

#[test]
fn nothing_flies_whose_certificate_does_not_hold() {
    let certified = certified::Certified::new(paper()).unwrap();
    assert!(certified.certificate().holds());
    let weak = LimitParameters { thrust_max: 7.0, torque_max: Vector3::new(0.5, 0.5, 0.2) };
    let weak = Limits::new(weak, paper().vehicle()).unwrap();
    let weak = Configuration::new(*paper().vehicle(), weak, *paper().gains().unwrap(), *paper().bounds()).unwrap();
    let certified::Refused::Fails(certificate) = certified::Certified::new(weak).unwrap_err() else { panic!() };
    assert_eq!(certificate.tightest().unwrap().name, "T2 yaw torque");
}
