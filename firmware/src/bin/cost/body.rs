//! A rigid body between two ticks, so that the states which the law is measured at are those of a flight.

use controller_core::state::{State, Wrench};
use controller_core::vehicle::Vehicle;
use nalgebra::{Quaternion, Vector3};

/// Steps between two ticks.
const STEPS_PER_TICK: u32 = 10;

/// Advances `state` by `period` seconds with `wrench` held: ideal actuators, semi-implicit Euler steps.
pub fn advance(state: &mut State, vehicle: &Vehicle, wrench: &Wrench, period: f32) {
    let (inertia, step) = (&vehicle.inertia, period / STEPS_PER_TICK as f32);
    for _ in 0..STEPS_PER_TICK {
        let omega = state.angular_velocity;
        let gyroscopic = omega.cross(&inertia.component_mul(&omega));
        state.angular_velocity += (wrench.torque - gyroscopic).component_div(inertia) * step;
        let turn = Quaternion::from_parts(1.0, state.angular_velocity * (0.5 * step));
        state.attitude = (state.attitude * turn).normalize();
        let thrust_axis = state.attitude * Quaternion::from_imag(Vector3::z()) * state.attitude.conjugate();
        let acceleration = thrust_axis.imag() * (wrench.thrust / vehicle.mass) - Vector3::z() * vehicle.gravity;
        state.velocity += acceleration * step;
        state.position += state.velocity * step;
    }
}
