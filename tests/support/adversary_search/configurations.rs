//! Configurations to attack: the paper's, and random ones around it.

use crate::support::random::{self, ChaCha8Rng};
use controller_core::configuration::Configuration;
use controller_core::gains::{GainParameters, Gains};
use controller_core::reference::ReferenceBounds;
use controller_core::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
use nalgebra::Vector3;
use rand::RngExt;
use scenario::Scenario;

/// Limits that are never reached, for tests that are not about limits.
pub fn without_limits(vehicle: Vehicle, gains: Gains, bounds: ReferenceBounds) -> Configuration {
    limited(vehicle, gains, bounds, f64::from(f32::MAX), &Vector3::repeat(f64::from(f32::MAX)))
}

/// `vehicle` and `gains` within the limits given, N and N m.
pub fn limited(
    vehicle: Vehicle,
    gains: Gains,
    bounds: ReferenceBounds,
    thrust_max: f64,
    torque_max: &Vector3<f64>,
) -> Configuration {
    let limits = LimitParameters { thrust_max: thrust_max as f32, torque_max: torque_max.cast() };
    Configuration::new(vehicle, Limits::new(limits, &vehicle).unwrap(), gains, bounds).unwrap()
}

/// The paper's experiment, Section VI: vehicle, limits, Table I, and the bounds of its reference.
pub fn paper() -> Configuration {
    Scenario::paper().unwrap().configuration
}

/// A vehicle of 0.1 to 10 times the paper's mass, gains within a factor of `spread` of Table I, and a reference that
/// asks for much, for little or for nothing of each kind. Without limits.
pub fn around_table_1(rng: &mut ChaCha8Rng, spread: f32) -> Configuration {
    let mass = 0.46 * random::log_uniform(rng, 0.1, 10.0);
    let [a, b, c] = [(); 3].map(|()| mass * random::log_uniform(rng, 2e-3, 8e-3));
    let inertia = Vector3::new(b + c, c + a, a + b);
    let vehicle = Vehicle::new(VehicleParameters { mass, inertia, gravity: 9.81 }).unwrap();

    let mut around = |value: f32| value * random::log_uniform(rng, 1.0 / spread, spread);
    let table = GainParameters::TABLE_1;
    let parameters = GainParameters {
        k_p: around(table.k_p),
        k_v: around(table.k_v),
        k_f: around(table.k_f),
        k_s: around(table.k_s),
        k_theta: around(table.k_theta).min(900.0),
        k_omega: around(table.k_omega),
        m_p: around(table.m_p).min(7.5),
        m_theta: around(table.m_theta),
        m_omega: around(table.m_omega),
        delta: around(table.delta),
        alpha: table.alpha,
    };
    let mut up_to =
        |value: f32| if rng.random_bool(0.15) { 0.0 } else { random::log_uniform(rng, 0.01 * value, value) };
    let bounds = ReferenceBounds {
        // The paper's law does not depend on it.
        horizontal_speed: 1e3,
        horizontal_acceleration: up_to(5.0),
        vertical_acceleration: up_to(2.0),
        jerk: up_to(10.0),
        snap: up_to(30.0),
        heading_rate: up_to(3.0),
        heading_second_derivative: up_to(6.0),
    };
    without_limits(vehicle, Gains::new(parameters, &vehicle).unwrap(), bounds)
}
