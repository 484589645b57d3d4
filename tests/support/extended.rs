//! What the suites about the extended law share: the configurations it is tried on, and everything it can be asked for.

pub mod force_generator;
pub mod situation;

use controller_core::certificate::Certificate;
use controller_core::certificate::configuration::{Configuration, ExtendedLaw, LawParameters};
use controller_core::certificate::extended::bounds::ExtendedBounds;
use controller_core::extended::actuators::ActuatorParameters;
use controller_core::extended::parameters::{
    AttitudeParameters, EstimateParameters, Extended, ExtendedParameters, HeadingParameters, PositionParameters,
};
use scenario::Scenario;
use std::path::Path;

/// Constants for a vehicle of half a kilogram.
pub const EXAMPLE: ExtendedParameters = ExtendedParameters {
    position: PositionParameters {
        k_p_across: 6.0,
        k_p_vertical: 6.0,
        k_v_across: 4.0,
        k_v_vertical: 4.0,
        k_f_across: 6.0,
        k_f_vertical: 4.0,
        k_s_across: 6.0,
        k_s_vertical: 4.0,
        m_across: 2.0,
        m_up: 6.0,
        m_down: 1.5,
        v_across: 5.0,
        v_up: 4.0,
        v_down: 3.0,
    },
    attitude: AttitudeParameters {
        w: 0.6,
        eta: 0.1,
        k_t: 1.0,
        m_t: 0.1,
        eta_t: 0.5,
        k_omega_t: 0.05,
        m_omega_t: 0.2,
        k_omega_z: 0.03,
        m_omega_z: 0.04,
        ease: 0.0,
        delta: 0.02,
        alpha: 0.25,
    },
    heading: HeadingParameters { acceleration: 3.0, rate: 1.5, c_1: 9.0, c_2: 6.0 },
    estimates: EstimateParameters {
        force_across: 2.6,
        force_vertical: 0.5,
        force_bandwidth_across: 10.0,
        force_bandwidth_vertical: 15.0,
        force_snap_across: 28.0,
        force_snap_vertical: 20.0,
        force_smoothing_across: 10.0,
        force_smoothing_vertical: 20.0,
        drag_across: 0.47,
        torque_tilt: 0.03,
        torque_yaw: 0.005,
        torque_smoothing: 3.0,
        scale_least: 0.8,
        scale_greatest: 1.3,
        scale_rate: 0.3,
    },
    floor_margin: 0.05,
};

/// A vehicle of `vehicles/`, by its file's name.
pub fn vehicle(name: &str) -> Scenario {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vehicles");
    Scenario::load(&folder.join(format!("{name}.toml"))).unwrap()
}

/// The paper's vehicle, limits and reference under the extended law with [`EXAMPLE`], without rotors.
pub fn paper_vehicle() -> Configuration {
    let Scenario { configuration: paper, .. } = Scenario::paper().unwrap();
    let parameters = Extended::new(EXAMPLE, paper.vehicle()).unwrap();
    let law = ExtendedLaw { parameters, actuators: ActuatorParameters { lag: 0.0, delay: 0.0 } };
    Configuration::extended(*paper.vehicle(), *paper.limits(), law, *paper.bounds()).unwrap()
}

/// The law of a configuration of the extended law.
pub fn law(configuration: &Configuration) -> ExtendedLaw {
    match configuration.law() {
        LawParameters::Extended(law) => *law,
        LawParameters::Paper(_) => panic!("a configuration of the paper's law"),
    }
}

/// What the certificate says the extended law can command under a configuration of it.
pub fn bounds(configuration: &Configuration) -> ExtendedBounds {
    match Certificate::new(configuration).unwrap() {
        Certificate::Extended(certificate) => certificate.bounds,
        Certificate::Paper(_) => panic!("a certificate of the paper's law"),
    }
}
