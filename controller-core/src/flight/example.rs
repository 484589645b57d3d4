//! A vehicle to test with: the AscTec Hummingbird of `vehicles/hummingbird.toml`.

use crate::allocation::{QuadX, Rotors};
use crate::certificate::certified::Certified;
use crate::certificate::configuration::Configuration;
use crate::gains::{GainParameters, Gains};
use crate::reference::ReferenceBounds;
use crate::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
use nalgebra::Vector3;

pub(crate) fn certified() -> Certified {
    let inertia = Vector3::new(3.65e-3, 3.68e-3, 7.03e-3);
    let vehicle = Vehicle::new(VehicleParameters { mass: 0.5, inertia, gravity: 9.81 }).unwrap();
    let torque_max = Vector3::new(1.0, 1.0, 0.2);
    let limits = Limits::new(LimitParameters { thrust_max: 20.0, torque_max }, &vehicle).unwrap();
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
    let bounds = ReferenceBounds {
        horizontal_speed: 5.0,
        horizontal_acceleration: 2.4675,
        vertical_acceleration: 0.1755,
        jerk: 3.876,
        snap: 6.089,
        heading_rate: 1.316,
        heading_second_derivative: 1.7318,
    };
    let quad =
        QuadX { arm: 0.17, thrust_coefficient: 5.57e-6, drag_coefficient: 1.36e-7, speed_min: 0.0, speed_max: 1500.0 };
    let configuration = Configuration::new(vehicle, limits, Gains::new(gains, &vehicle).unwrap(), bounds);
    let configuration = configuration.unwrap().with_rotors(Rotors::quad_x(quad).unwrap()).unwrap();
    Certified::new(configuration).unwrap()
}
