//! What the suites about the extended law share: the configurations it is tried on, and everything it can be asked for.

pub mod force_generator;
pub mod oracle;
pub mod rounding;
pub mod situation;

use crate::support::random::{self, ChaCha8Rng};
use controller_core::allocation::{QuadX, Rotors};
use controller_core::certificate::Certificate;
use controller_core::certificate::configuration::{Configuration, ExtendedLaw, LawParameters};
use controller_core::certificate::extended::bounds::ExtendedBounds;
use controller_core::extended::actuators::ActuatorParameters;
use controller_core::extended::parameters::{
    AttitudeParameters, EstimateParameters, Extended, ExtendedParameters, HeadingParameters, PositionParameters,
};
use controller_core::reference::ReferenceBounds;
use controller_core::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
use nalgebra::Vector3;
use rand::RngExt;
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

/// Constants within a factor of four of [`EXAMPLE`] wherever the law allows, with any hysteresis and any share of yaw above what
/// the hysteresis asks for.
pub fn random_parameters(rng: &mut ChaCha8Rng) -> ExtendedParameters {
    let ExtendedParameters { position: p, attitude: a, heading: h, estimates: e, .. } = EXAMPLE;
    let delta = random::log_uniform(rng, 0.005, 1.0);
    let square = (1.0 + delta) * (1.0 + delta);
    let qbar = (square - 1.0) / (square + 1.0);
    let mut around = |value: f32| value * random::log_uniform(rng, 0.25, 4.0);
    let k_f = around(p.k_f_across);
    ExtendedParameters {
        position: PositionParameters {
            k_p_across: around(p.k_p_across),
            k_p_vertical: around(p.k_p_vertical),
            k_v_across: around(p.k_v_across),
            k_v_vertical: around(p.k_v_vertical),
            k_f_across: k_f,
            k_f_vertical: around(p.k_f_vertical),
            k_s_across: if k_f > p.k_f_across { k_f } else { around(p.k_s_across) },
            k_s_vertical: around(p.k_s_vertical),
            m_across: around(p.m_across),
            m_up: around(p.m_up),
            m_down: around(p.m_down).min(5.0),
            v_across: around(p.v_across),
            v_up: around(p.v_up),
            v_down: around(p.v_down),
        },
        attitude: AttitudeParameters {
            w: around(a.w),
            eta: (qbar * around(2.0).max(1.1)).min(0.5 + 0.5 * qbar),
            k_t: around(a.k_t),
            m_t: around(a.m_t),
            eta_t: around(a.eta_t).min(1.0),
            k_omega_t: around(a.k_omega_t),
            m_omega_t: around(a.m_omega_t),
            k_omega_z: around(a.k_omega_z),
            m_omega_z: around(a.m_omega_z),
            ease: (around(0.2) - 0.05).clamp(0.0, 0.7),
            delta,
            alpha: a.alpha,
        },
        heading: HeadingParameters {
            acceleration: around(h.acceleration),
            rate: around(h.rate),
            c_1: around(h.c_1),
            c_2: around(h.c_2),
        },
        estimates: EstimateParameters {
            force_across: around(e.force_across),
            force_vertical: around(e.force_vertical),
            force_bandwidth_across: around(e.force_bandwidth_across),
            force_bandwidth_vertical: around(e.force_bandwidth_vertical),
            force_snap_across: around(e.force_snap_across),
            force_snap_vertical: around(e.force_snap_vertical),
            force_smoothing_across: around(e.force_smoothing_across),
            force_smoothing_vertical: around(e.force_smoothing_vertical),
            drag_across: around(e.drag_across),
            torque_tilt: around(e.torque_tilt),
            torque_yaw: around(e.torque_yaw),
            torque_smoothing: around(e.torque_smoothing),
            scale_least: 1.0 - 0.05 * around(1.0),
            scale_greatest: 1.0 + 0.05 * around(1.0),
            scale_rate: around(e.scale_rate),
        },
        floor_margin: around(0.05),
    }
}

/// A body of about half a kilogram.
pub fn random_vehicle(rng: &mut ChaCha8Rng) -> Vehicle {
    let mut around = |value: f32| value * random::log_uniform(rng, 0.5, 2.0);
    // Sums of two of three positive numbers satisfy the triangle inequality of a rigid body.
    let [mass, a, b, c] = [around(0.5), around(3.5e-3), around(3.5e-3), around(1e-3)];
    Vehicle::new(VehicleParameters { mass, inertia: Vector3::new(b + c, c + a, a + b), gravity: 9.81 }).unwrap()
}

/// A body, constants and references near the Hummingbird's, with its rotors idling anywhere, and without limits.
pub fn around_the_example(rng: &mut ChaCha8Rng) -> Configuration {
    let vehicle = random_vehicle(rng);
    let parameters = Extended::new(random_parameters(rng), &vehicle).unwrap();
    let law = ExtendedLaw { parameters, actuators: ActuatorParameters { lag: 0.0, delay: 0.0 } };
    let mut up_to = |most: f32| if rng.random_bool(0.15) { 0.0 } else { random::log_uniform(rng, 0.01 * most, most) };
    let bounds = ReferenceBounds {
        horizontal_speed: up_to(5.0),
        horizontal_acceleration: up_to(5.0),
        vertical_acceleration: up_to(1.5),
        jerk: up_to(10.0),
        snap: up_to(30.0),
        heading_rate: up_to(3.0),
        heading_second_derivative: up_to(6.0),
    };
    let [arm, slowest] = [random::log_uniform(rng, 0.08, 0.3), rng.random_range(0.0..300.0)];
    let quad =
        QuadX { arm, thrust_coefficient: 5.57e-6, drag_coefficient: 1.36e-7, speed_min: slowest, speed_max: 1500.0 };
    let without = f32::MAX;
    let limits = LimitParameters { thrust_max: without, torque_max: Vector3::repeat(without) };
    let limits = Limits::new(limits, &vehicle).unwrap();
    let configuration = Configuration::extended(vehicle, limits, law, bounds).unwrap();
    configuration.with_rotors(Rotors::quad_x(quad).unwrap()).unwrap()
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
