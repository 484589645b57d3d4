//! The AscTec Hummingbird of `vehicles/`, under both laws, for the tests of the crates that read no file.

// Every test crate that includes this module uses a part of it.
#![allow(dead_code)]

use controller_core::allocation::{QuadX, Rotors};
use controller_core::certificate::certified::Certified;
use controller_core::configuration::{Configuration, ExtendedLaw};
use controller_core::extended::actuators::ActuatorParameters;
use controller_core::extended::defaults::{self, Airframe, NOTHING_GIVEN};
use controller_core::extended::parameters::{Extended, ExtendedParameters};
use controller_core::gains::{GainParameters, Gains};
use controller_core::reference::ReferenceBounds;
use controller_core::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
use nalgebra::Vector3;

pub fn vehicle() -> Vehicle {
    let inertia = Vector3::new(3.65e-3, 3.68e-3, 7.03e-3);
    Vehicle::new(VehicleParameters { mass: 0.5, inertia, gravity: 9.81 }).unwrap()
}

pub const QUAD: QuadX =
    QuadX { arm: 0.17, thrust_coefficient: 5.57e-6, drag_coefficient: 1.36e-7, speed_min: 0.0, speed_max: 1500.0 };

pub fn rotors() -> Rotors {
    Rotors::quad_x(QUAD).unwrap()
}

/// What it may be asked to fly under the extended law.
pub const REFERENCES: ReferenceBounds = ReferenceBounds {
    horizontal_speed: 3.0,
    horizontal_acceleration: 2.4675,
    vertical_acceleration: 0.1755,
    jerk: 3.876,
    snap: 6.089,
    heading_rate: 1.316,
    heading_second_derivative: 1.7318,
};

/// Under the paper's law, as in `vehicles/hummingbird-paper-law.toml`, without rotors and without projection.
pub fn paper_law() -> Configuration {
    let limits = LimitParameters { thrust_max: 20.0, torque_max: Vector3::new(1.0, 1.0, 0.2) };
    let limits = Limits::new(limits, &vehicle()).unwrap();
    let gains = GainParameters {
        k_p: 21.867805,
        k_v: 98.16072,
        k_f: 1.6758983,
        k_s: 1.0240563,
        k_theta: 4.7553053,
        k_omega: 0.015616302,
        m_p: 1.5820053,
        m_theta: 0.056425318,
        m_omega: 0.015607581,
        delta: 0.02,
        alpha: 0.25,
    };
    let bounds = ReferenceBounds { horizontal_speed: 5.0, ..REFERENCES };
    Configuration::new(vehicle(), limits, Gains::new(gains, &vehicle()).unwrap(), bounds).unwrap()
}

/// The same with its rotors, certified.
pub fn certified() -> Certified {
    Certified::new(paper_law().with_rotors(rotors()).unwrap()).unwrap()
}

/// Under the extended law, all constants from its numbers but A, which [`REFERENCES`] need.
pub fn extended_law() -> Configuration {
    let limits = LimitParameters { thrust_max: 40.0, torque_max: Vector3::new(1.0, 1.0, 0.4) };
    let limits = Limits::new(limits, &vehicle()).unwrap();
    let (rotors, actuators) = (rotors(), ActuatorParameters { lag: 0.005, delay: 0.0 });
    let airframe =
        Airframe { vehicle: &vehicle(), limits: &limits, rotors: Some(&rotors), actuators, period: 0.01, drag: 0.47 };
    let mut given = NOTHING_GIVEN;
    let place = ExtendedParameters::TABLE.iter().position(|constant| constant.key == "yaw_acceleration").unwrap();
    given[place] = Some(6.0);
    let parameters = Extended::new(defaults::constants(&airframe, &given), &vehicle()).unwrap();
    let law = ExtendedLaw { parameters, actuators };
    Configuration::extended(vehicle(), limits, law, REFERENCES).unwrap().with_rotors(rotors).unwrap()
}
