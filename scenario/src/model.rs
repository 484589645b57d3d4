//! A light model of a vehicle: a rigid body whose thrust and torque follow the law's commands late and with a lag.
//!
//! ```text
//! p' = v                     v' = -g e3 + R(q) e3 T/m + delta     world frame, z up
//! q' = q (0, omega) / 2      J omega' = (J omega) x omega + tau   body frame
//! T' = (T_cmd(t - delay) - T) / lag, tau likewise
//! ```
//!
//! There is no air but a drag across, and no rotor reaches a limit: what the law commands is proven to fit. Lag,
//! inertia and delta may be other than the law believes.

use crate::body::BodyState;
use crate::sampled_loop::LoopTiming;
use controller_core::state::Wrench;
use controller_core::vehicle::Vehicle;
use nalgebra::{Quaternion, Vector3};
use std::collections::VecDeque;

const STEP_MAX_S: f64 = 2e-3;

/// The model in flight.
#[derive(Debug, Clone)]
pub struct Model {
    /// Where it is.
    pub body: BodyState,
    /// J, kg m^2, the diagonal, body axes.
    pub inertia: Vector3<f64>,
    /// Across, per velocity, 1/s.
    pub drag_across: f64,
    /// delta, the force per mass that acts until it is changed, m/s^2, world frame.
    pub push: Vector3<f64>,
    mass: f64,
    gravity: f64,
    step: f64,
    steps: u32,
    /// What a step keeps of the difference to the command.
    kept: f64,
    /// T, N, and tau, N m, as they act.
    thrust: f64,
    torque: Vector3<f64>,
    /// Commands under way, one for each step.
    coming: VecDeque<(f64, Vector3<f64>)>,
}

impl Model {
    /// `vehicle` in still air at `body`, its rotors at hover; `timing` has the lag that they have.
    #[must_use]
    pub fn new(vehicle: &Vehicle, timing: &LoopTiming, body: BodyState) -> Self {
        let steps = (timing.period / STEP_MAX_S).ceil();
        let step = timing.period / steps;
        let thrust = f64::from(vehicle.mass) * f64::from(vehicle.gravity);
        let waiting = (timing.delay_samples * steps).round() as usize;
        Self {
            body,
            inertia: vehicle.inertia.map(f64::from),
            drag_across: 0.0,
            push: Vector3::zeros(),
            mass: f64::from(vehicle.mass),
            gravity: f64::from(vehicle.gravity),
            step,
            steps: steps as u32,
            kept: if timing.rotor_lag > 0.0 { (-step / timing.rotor_lag).exp() } else { 0.0 },
            thrust,
            torque: Vector3::zeros(),
            coming: VecDeque::from(vec![(thrust, Vector3::zeros()); waiting]),
        }
    }

    /// Of the law, s.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.step * f64::from(self.steps)
    }

    /// Holds a command for a period.
    pub fn advance(&mut self, wrench: &Wrench) {
        let command = (f64::from(wrench.thrust), wrench.torque.map(f64::from));
        for _ in 0..self.steps {
            self.coming.push_back(command);
            let (thrust, torque) = self.coming.pop_front().unwrap_or(command);
            self.thrust = thrust + (self.thrust - thrust) * self.kept;
            self.torque = torque + (self.torque - torque) * self.kept;
            self.step();
        }
    }

    /// One step by the midpoint rule.
    fn step(&mut self) {
        let (h, BodyState { attitude, angular_velocity, .. }) = (self.step, self.body);
        let accelerated = |omega: &Vector3<f64>| {
            let momentum = self.inertia.component_mul(omega);
            (momentum.cross(omega) + self.torque).component_div(&self.inertia)
        };
        let turned = |omega: &Vector3<f64>, time: f64| {
            let next = attitude + attitude * Quaternion::from_imag(omega * (0.5 * time));
            next / next.norm()
        };
        let middle = angular_velocity + accelerated(&angular_velocity) * (0.5 * h);
        let between = BodyState { attitude: turned(&angular_velocity, 0.5 * h), ..self.body };
        let drag = Vector3::new(self.body.velocity.x, self.body.velocity.y, 0.0) * self.drag_across;
        let acceleration =
            between.thrust_axis() * (self.thrust / self.mass) - Vector3::z() * self.gravity - drag + self.push;
        self.body.attitude = turned(&middle, h);
        self.body.angular_velocity += accelerated(&middle) * h;
        self.body.position += (self.body.velocity + acceleration * (0.5 * h)) * h;
        self.body.velocity += acceleration * h;
    }
}

#[cfg(test)]
mod tests;
