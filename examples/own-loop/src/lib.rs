//! What both loops fly: a certified Hummingbird, and a rigid body in place of the real one.

use controller_core::prelude::*;

/// The Hummingbird's numbers, and what is proven of them.
pub fn hummingbird() -> Result<(Certified, Rotors), ParameterError> {
    let inertia = Vector3::new(3.65e-3, 3.68e-3, 7.03e-3); // kg m^2
    let vehicle = Vehicle::new(VehicleParameters { mass: 0.5, inertia, gravity: 9.81 })?;
    let rotors = Rotors::quad_x(QuadX {
        arm: 0.17,
        thrust_coefficient: 5.57e-6,
        drag_coefficient: 1.36e-7,
        speed_min: 0.0,
        speed_max: 1500.0,
    })?;
    let airframe = Airframe {
        vehicle: &vehicle,
        limits: &rotors.limits(&vehicle)?,
        rotors: Some(&rotors),
        actuators: ActuatorParameters { lag: 0.0, delay: 0.0 },
        period: 0.01,
        drag: 0.0,
    };
    let certified = Certified::new(Configuration::from_airframe(&airframe)?).expect("its limits hold");
    Ok((certified, rotors))
}

/// Upside down and at rest, 2 m above the ground.
pub const UPSIDE_DOWN: State = State {
    position: Vector3::new(0.0, 0.0, 2.0),
    velocity: Vector3::new(0.0, 0.0, 0.0),
    attitude: Quaternion::new(0.0, 1.0, 0.0, 0.0),
    angular_velocity: Vector3::new(0.0, 0.0, 0.0),
};

/// The state after `duration`, s, under a held wrench.
pub fn advanced(state: &State, vehicle: &Vehicle, wrench: &Wrench, duration: f32) -> State {
    let (mut state, steps) = (*state, 10);
    let (step, inertia) = (duration / steps as f32, vehicle.inertia);
    for _ in 0..steps {
        let w = state.angular_velocity;
        let turning = wrench.torque - w.cross(&inertia.component_mul(&w));
        state.angular_velocity += turning.component_div(&inertia) * step;
        let rate = state.attitude * Quaternion::from_parts(0.0, state.angular_velocity) * 0.5;
        state.attitude = (state.attitude + rate * step).normalize();
        let q = state.attitude;
        let thrust = (q * Quaternion::from_parts(0.0, Vector3::z() * wrench.thrust) * q.conjugate()).imag();
        state.velocity += (thrust / vehicle.mass - Vector3::z() * vehicle.gravity) * step;
        state.position += state.velocity * step;
    }
    state
}
