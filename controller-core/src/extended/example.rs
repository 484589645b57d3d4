//! A vehicle and constants to test with: the Hummingbird's.

use super::parameters::{
    AttitudeParameters, EstimateParameters, ExtendedParameters, HeadingParameters, PositionParameters,
};
use crate::allocation::{QuadX, Rotors};
use crate::reference::ReferenceBounds;
use crate::vehicle::{Vehicle, VehicleParameters};
use nalgebra::Vector3;

pub(crate) const PARAMETERS: ExtendedParameters = ExtendedParameters {
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

pub(crate) fn vehicle() -> Vehicle {
    let inertia = Vector3::new(3.65e-3, 3.68e-3, 7.03e-3);
    Vehicle::new(VehicleParameters { mass: 0.5, inertia, gravity: 9.81 }).unwrap()
}

pub(crate) const QUAD: QuadX =
    QuadX { arm: 0.17, thrust_coefficient: 5.57e-6, drag_coefficient: 1.36e-7, speed_min: 0.0, speed_max: 1500.0 };

pub(crate) fn rotors() -> Rotors {
    Rotors::quad_x(QUAD).unwrap()
}

/// What it may be asked to fly.
pub(crate) const REFERENCES: ReferenceBounds = ReferenceBounds {
    horizontal_speed: 3.0,
    horizontal_acceleration: 2.4675,
    vertical_acceleration: 0.1755,
    jerk: 3.876,
    snap: 6.089,
    heading_rate: 1.316,
    heading_second_derivative: 1.7318,
};
