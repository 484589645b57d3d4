//! The vehicle in flight: the paper's rigid body, eq. (2), in double precision.
//!
//! ```text
//! p' = v                     v' = -g e3 + R(q) e3 T/m           world frame, z up
//! q' = q (0, omega) / 2      J omega' = (J omega) x omega + tau   body frame
//! ```
//!
//! Thrust T and torque tau act as commanded, clipped to the vehicle's limits, and are held between control ticks. The
//! classical fourth-order Runge-Kutta method advances the state.
//!
//! | module | what it holds |
//! |---|---|
//! | [`body`] | the vehicle's numbers in the equations |
//! | [`motion`] | the equations and the method, for any number of vehicles side by side |
//! | [`lanes`] | numbers of several vehicles in one register |
//! | [`rows`] | many vehicles that move at the same time |
//!
//! It has no rotors, no air and no ground: thrust and torque appear at once, and nothing stops a fall. Where a flight
//! needs them, [`crate::vehicle::actuators`] and [`crate::vehicle::ground`] stand around it.

pub mod body;
pub mod lanes;
pub mod motion;
pub mod rows;

use body::Body;
use controller_core::state::Wrench;
use controller_core::vehicle::{Limits, Vehicle};
use lanes::{Lanes, Vectors};
use motion::BodyMotion;
use nalgebra::{Quaternion, Vector3, Vector4};
use pulp::Scalar;
use scenario::body::BodyState;
use std::fmt;

/// The simulated motion left the finite numbers; nothing after it means anything.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Diverged;

impl fmt::Display for Diverged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the vehicle's state is no longer finite")
    }
}

impl std::error::Error for Diverged {}

/// A rigid body under held thrust and torque.
#[derive(Debug, Clone)]
pub struct Plant {
    body: Body,
    state: BodyState,
}

impl Plant {
    /// A vehicle at `state`, integrated in steps of `step` seconds.
    #[must_use]
    pub fn new(vehicle: &Vehicle, limits: &Limits, step: f64, state: BodyState) -> Self {
        Self { body: Body::new(vehicle, limits, step), state }
    }

    /// The vehicle's numbers.
    #[must_use]
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// The present state.
    #[must_use]
    pub fn state(&self) -> &BodyState {
        &self.state
    }

    /// Holds `wrench`, clipped to the limits, for `steps` integration steps. Returns whether the limits cut anything.
    ///
    /// # Errors
    /// [`Diverged`] if the state is not finite afterwards.
    pub fn hold(&mut self, wrench: &Wrench, steps: u32) -> Result<bool, Diverged> {
        let (thrust, torque, clipped) = self.body.clipped(wrench);
        self.advance(thrust, &torque, steps);
        self.check()?;
        Ok(clipped)
    }

    /// One integration step under thrust, N, and torque, N m, as they are.
    pub fn act(&mut self, thrust: f64, torque: &Vector3<f64>) {
        self.advance(thrust, torque, 1);
    }

    /// Puts the body elsewhere, as a contact does.
    pub fn place(&mut self, state: BodyState) {
        self.state = state;
    }

    /// # Errors
    /// [`Diverged`] if the state is not finite.
    pub fn check(&self) -> Result<(), Diverged> {
        if self.state.is_finite() { Ok(()) } else { Err(Diverged) }
    }

    fn advance(&mut self, thrust: f64, torque: &Vector3<f64>, steps: u32) {
        let BodyState { position, velocity, attitude, angular_velocity } = self.state;
        let moving = BodyMotion {
            position: alone(position.into()),
            velocity: alone(velocity.into()),
            attitude: alone(attitude.coords.into()),
            angular_velocity: alone(angular_velocity.into()),
        };
        let moved = moving.advanced(Scalar, &self.body, Lanes::new(Scalar, thrust), alone((*torque).into()), steps);
        self.state = BodyState {
            position: Vector3::from(numbers(moved.position)),
            velocity: Vector3::from(numbers(moved.velocity)),
            attitude: Quaternion::from(Vector4::from(numbers(moved.attitude))),
            angular_velocity: Vector3::from(numbers(moved.angular_velocity)),
        };
    }
}

/// A vector of one vehicle.
fn alone<const N: usize>(vector: [f64; N]) -> Vectors<Scalar, N> {
    Vectors(vector.map(|number| Lanes::new(Scalar, number)))
}

/// The components of a vector of one vehicle.
fn numbers<const N: usize>(vector: Vectors<Scalar, N>) -> [f64; N] {
    vector.0.map(Lanes::numbers)
}

#[cfg(test)]
mod tests;
