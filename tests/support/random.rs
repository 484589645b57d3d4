//! Random vehicles, gains, states and references for the tests, reproducible from a seed.

use controller_core::gains::{GainParameters, Gains};
use controller_core::heading::Heading;
use controller_core::reference::Reference;
use controller_core::state::State;
use controller_core::vehicle::{Vehicle, VehicleParameters};
use nalgebra::{Quaternion, Vector2, Vector3};
pub use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use scenario::Scenario;
use std::sync::LazyLock;

static PAPER: LazyLock<Scenario> = LazyLock::new(|| Scenario::paper().unwrap());

/// The generator of one test.
pub fn generator(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// The vehicle of the paper's Section VI.
pub fn paper_vehicle() -> Vehicle {
    *PAPER.configuration.vehicle()
}

/// Table I, validated for `vehicle`.
pub fn paper_gains(vehicle: &Vehicle) -> Gains {
    Gains::new(GainParameters::TABLE_1, vehicle).unwrap()
}

/// From palm-sized to agricultural, on the Moon or on Jupiter.
pub fn vehicle(rng: &mut ChaCha8Rng) -> Vehicle {
    let mass = log_uniform(rng, 0.03, 20.0);
    // Sums of two of three positive numbers satisfy the triangle inequality of a rigid body.
    let [a, b, c] = [(); 3].map(|()| mass * log_uniform(rng, 1e-3, 0.05));
    let inertia = Vector3::new(b + c, c + a, a + b);
    Vehicle::new(VehicleParameters { mass, inertia, gravity: rng.random_range(1.6..25.0) }).unwrap()
}

/// Gains far from Table I in every direction; k_f = k_s in one of ten.
pub fn gains(rng: &mut ChaCha8Rng, vehicle: &Vehicle) -> Gains {
    let k_f = log_uniform(rng, 0.3, 50.0);
    let parameters = GainParameters {
        k_p: log_uniform(rng, 0.3, 50.0),
        k_v: log_uniform(rng, 0.5, 30.0),
        k_f,
        k_s: if rng.random_bool(0.1) { k_f } else { log_uniform(rng, 0.3, 200.0) },
        k_theta: log_uniform(rng, 0.5, 500.0),
        k_omega: log_uniform(rng, 0.005, 2.0),
        m_p: vehicle.gravity * rng.random_range(0.05..0.8),
        m_theta: log_uniform(rng, 0.02, 2.0),
        m_omega: log_uniform(rng, 0.01, 1.0),
        delta: log_uniform(rng, 0.005, 0.5),
        alpha: rng.random_range(0.05..0.95),
    };
    Gains::new(parameters, vehicle).unwrap()
}

/// Log-uniform in [low, high].
pub fn log_uniform(rng: &mut ChaCha8Rng, low: f32, high: f32) -> f32 {
    rng.random_range(low.ln()..high.ln()).exp()
}

/// A vector with each component uniform in ±`magnitude`.
pub fn vector(rng: &mut ChaCha8Rng, magnitude: f32) -> Vector3<f32> {
    Vector3::from_fn(|_, _| magnitude * rng.random_range(-1.0..=1.0))
}

/// A point of the box ±`level`; one of its corners in one of four.
pub fn in_box(rng: &mut ChaCha8Rng, level: f32) -> Vector3<f32> {
    if rng.random_bool(0.25) {
        Vector3::from_fn(|_, _| if rng.random_bool(0.5) { level } else { -level })
    } else {
        vector(rng, level)
    }
}

/// A direction, uniform on the sphere.
pub fn direction(rng: &mut ChaCha8Rng) -> Vector3<f32> {
    loop {
        let v = vector(rng, 1.0);
        if (1e-3..1.0).contains(&v.norm()) {
            return v.normalize();
        }
    }
}

/// An attitude, uniform on SO(3), as a unit quaternion of either sign.
pub fn attitude(rng: &mut ChaCha8Rng) -> Quaternion<f32> {
    loop {
        let mut component = || rng.random_range(-1.0..=1.0);
        let q = Quaternion::new(component(), component(), component(), component());
        if (1e-3..1.0).contains(&q.norm()) {
            return q.normalize();
        }
    }
}

/// A heading anywhere on the circle, at rest.
pub fn heading_at_rest(rng: &mut ChaCha8Rng) -> Heading {
    let (sin, cos) = rng.random_range(-std::f32::consts::PI..std::f32::consts::PI).sin_cos();
    Heading::new(Vector2::new(cos, sin), 0.0, 0.0).unwrap()
}

/// A heading anywhere on the circle, turning at up to 8 rad/s and 30 rad/s^2.
pub fn heading(rng: &mut ChaCha8Rng) -> Heading {
    let direction = heading_at_rest(rng).direction();
    Heading::new(direction, rng.random_range(-8.0..8.0), rng.random_range(-30.0..30.0)).unwrap()
}

/// K_a3 of the references below.
fn greatest_vertical_acceleration(vehicle: &Vehicle, gains: &Gains) -> f32 {
    0.8 * (vehicle.gravity - gains.m_p)
}

/// The floor of the thrust projection, on in one case of four: anywhere up to m (g - M_p - K_a3).
pub fn thrust_floor(rng: &mut ChaCha8Rng, vehicle: &Vehicle, gains: &Gains) -> Option<f32> {
    let greatest = vehicle.mass * (vehicle.gravity - gains.m_p - greatest_vertical_acceleration(vehicle, gains));
    rng.random_bool(0.25).then(|| greatest * rng.random_range(0.01..1.0))
}

/// A reference in a generous Omega_r: K_a12 = 6 m/s^2, K_a3 = 0.8 (g - M_p), jerk to 20 m/s^3, snap to 60 m/s^4.
pub fn reference(rng: &mut ChaCha8Rng, vehicle: &Vehicle, gains: &Gains) -> Reference {
    let vertical = greatest_vertical_acceleration(vehicle, gains);
    let (sin, cos) = rng.random_range(0.0..std::f32::consts::TAU).sin_cos();
    let horizontal = rng.random_range(0.0..6.0_f32);
    let far = log_uniform(rng, 0.1, 1e3);
    Reference {
        position: vector(rng, far),
        velocity: vector(rng, 20.0),
        acceleration: Vector3::new(horizontal * cos, horizontal * sin, rng.random_range(-vertical..vertical)),
        jerk: direction(rng) * rng.random_range(0.0..20.0),
        snap: direction(rng) * rng.random_range(0.0..60.0),
        heading: heading(rng),
    }
}

/// A state at any attitude, as far from `reference` as 0.1 mm or 1 km, with body rates to 20 rad/s.
pub fn state_around(rng: &mut ChaCha8Rng, reference: &Reference) -> State {
    let (away, fast) = (log_uniform(rng, 1e-4, 1e3), log_uniform(rng, 1e-4, 1e2));
    State {
        position: reference.position + vector(rng, away),
        velocity: reference.velocity + vector(rng, fast),
        attitude: attitude(rng),
        angular_velocity: vector(rng, 20.0),
    }
}
