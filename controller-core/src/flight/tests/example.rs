//! A vehicle to test with: the AscTec Hummingbird of `vehicles/hummingbird.toml`.

use crate::certificate::certified::Certified;
use crate::certificate::configuration::Configuration;
use crate::extended;
use crate::gains::{GainParameters, Gains};
use crate::reference::ReferenceBounds;
use crate::vehicle::{LimitParameters, Limits};
use nalgebra::Vector3;

pub(crate) fn certified() -> Certified {
    let vehicle = extended::tests::example::vehicle();
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
    let bounds = ReferenceBounds { horizontal_speed: 5.0, ..extended::tests::example::REFERENCES };
    let configuration = Configuration::new(vehicle, limits, Gains::new(gains, &vehicle).unwrap(), bounds);
    let configuration = configuration.unwrap().with_rotors(extended::tests::example::rotors()).unwrap();
    Certified::new(configuration).unwrap()
}
