//! Constants from a vehicle's numbers.

use super::Random;
use super::std::string::{String, ToString};
use crate::allocation::{QuadX, Rotors};
use crate::certificate::Certificate;
use crate::extended::controller::Controller;
use crate::extended::defaults::{self, NOTHING_GIVEN};
use crate::extended::parameters::ExtendedParameters;
use crate::extended::tests::example::{self, Craft, given, place};
use crate::reference::ReferenceBounds;
use crate::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
use nalgebra::Vector3;

/// How much of the bounds that the formulas allow are certified, in steps of a tenth; what fails where not even a
/// hundredth is.
fn certified(craft: &Craft, parameters: &ExtendedParameters) -> Result<f32, String> {
    let max = defaults::reference_bounds(&craft.airframe(), parameters);
    let mut share = 1.0;
    loop {
        let bounds = ReferenceBounds {
            horizontal_speed: max.horizontal_speed * share,
            horizontal_acceleration: max.horizontal_acceleration * share,
            vertical_acceleration: max.vertical_acceleration * share,
            jerk: max.jerk * share,
            snap: max.snap * share,
            heading_rate: max.heading_rate * share,
            heading_second_derivative: max.heading_second_derivative * share,
        };
        let certificate = Certificate::new(&craft.configuration(parameters, bounds)).unwrap();
        if certificate.holds() {
            return Ok(share);
        }
        if share < 0.01 {
            return Err(certificate.tightest().unwrap().to_string());
        }
        share *= 0.9;
    }
}

#[test]
fn every_plausible_vehicle_is_certified_with_constants_in_their_ranges() {
    let mut random = Random(21);
    for _ in 0..300 {
        let craft = Craft::random(&mut random);
        let parameters = craft.constants(&NOTHING_GIVEN);
        for (constant, value) in ExtendedParameters::TABLE.iter().zip(parameters.values()) {
            assert_eq!(constant.range.check(value, constant.path), Ok(()), "{craft:?}");
        }
        assert_eq!(Controller::check_period(&craft.law(&parameters).parameters, craft.period), Ok(()), "{craft:?}");
        assert!(certified(&craft, &parameters).is_ok(), "{craft:?}: {:?}", certified(&craft, &parameters));
    }
}

/// What turns about x and y at once pulls about z with the difference of their inertias, here as much as the rotors
/// give.
#[test]
fn a_vehicle_whose_yaw_is_weak_and_whose_tilt_is_uneven_is_certified() {
    let inertia = Vector3::new(0.1, 0.14, 0.22);
    let vehicle = Vehicle::new(VehicleParameters { mass: 2.9, inertia, gravity: 9.81 }).unwrap();
    let quad =
        QuadX { arm: 0.32, thrust_coefficient: 1e-5, drag_coefficient: 5.4e-8, speed_min: 0.0, speed_max: 2_130.0 };
    let rotors = Rotors::quad_x(quad).unwrap();
    let limits = rotors.limits(&vehicle).unwrap();
    let craft = Craft { vehicle, limits, rotors, ..Craft::example() };
    assert_eq!(certified(&craft, &craft.constants(&NOTHING_GIVEN)).err(), None);
}

#[test]
fn what_is_given_is_kept_to_the_bit_and_the_rest_follows() {
    let craft = Craft::example();
    let built = craft.constants(&NOTHING_GIVEN).values();
    for (at, (constant, value)) in ExtendedParameters::TABLE.iter().zip(built).enumerate() {
        let chosen = (0.9 * value).clamp(constant.range.min, constant.range.max);
        let parameters = craft.constants(&given(constant.key, chosen));
        assert_eq!(parameters.values()[at].to_bits(), chosen.to_bits(), "{}", constant.path);
    }
    let others = |key: &str, value: f32, follows: &[&str]| {
        let parameters = craft.constants(&given(key, value)).values();
        for follows in follows {
            assert_ne!(parameters[place(follows)], built[place(follows)], "{follows} with {key}");
        }
    };
    others("k_f", 5.0, &["k_s"]);
    others("k_v_across", 2.0, &["k_v_vertical", "k_p_across", "k_p_vertical"]);
    others("turn_reserve", 1.0, &["m_tilt", "r_0"]);
    others("m_tilt", 0.2, &["r_0"]);
    others("yaw_acceleration", 1.0, &["yaw_rate", "c_1", "c_2"]);
    others("a_down", 4.0, &["force_up"]);
    others("a_across", 4.0, &["force_across"]);
}

#[test]
fn a_vehicle_of_twice_the_size_has_the_same_bandwidths() {
    let craft = Craft::example();
    let of = |factor: f32| {
        let mass = craft.vehicle.mass * factor;
        let inertia = craft.vehicle.inertia * factor;
        let vehicle = Vehicle::new(VehicleParameters { mass, inertia, ..*craft.vehicle }).unwrap();
        let limits = LimitParameters {
            thrust_max: craft.limits.thrust_max * factor,
            torque_max: craft.limits.torque_max * factor,
        };
        let quad = QuadX {
            thrust_coefficient: example::QUAD.thrust_coefficient * factor,
            drag_coefficient: example::QUAD.drag_coefficient * factor,
            ..example::QUAD
        };
        let (limits, rotors) = (Limits::new(limits, &vehicle).unwrap(), Rotors::quad_x(quad).unwrap());
        Craft { vehicle, limits, rotors, ..craft.clone() }.constants(&NOTHING_GIVEN)
    };
    // Forces and torques scale with the mass, accelerations and bandwidths stay.
    let (single, double) = (of(1.0), of(2.0));
    for (constant, (one, two)) in ExtendedParameters::TABLE.iter().zip(single.values().into_iter().zip(double.values()))
    {
        let is_torque = ["N m:", "N m s:", "N:"].iter().any(|unit| constant.about.contains(unit));
        let expected = if is_torque { 2.0 * one } else { one };
        assert!((two - expected).abs() <= 1e-4 * expected, "{}: {one} and {two}", constant.path);
    }
}
