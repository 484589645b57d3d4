//! The vehicle in flight: the paper's rigid body, eq. (2), in double precision.
//!
//! ```text
//! p' = v                     v' = -g e3 + R(q) e3 T/m           world frame, z up
//! q' = q (0, omega) / 2      J omega' = (J omega) x omega + tau   body frame
//! ```
//!
//! Thrust T and torque tau act as commanded, clipped to the vehicle's limits, and are held between control ticks. The
//! classical fourth-order Runge-Kutta method advances the state. The equations form a cascade (omega' needs omega only;
//! q' needs q and omega; v' needs q; p' needs v), so a step runs the four stages of each level before the next level
//! and folds the factors and the position's stages together: the same method, half the work.
//!
//! It has no rotors, no air and no ground: thrust and torque appear at once, and nothing stops a fall. Where a flight needs
//! them, [`crate::actuators`] and [`crate::ground`] stand around it.

use controller_core::state::Wrench;
use controller_core::vehicle::{Limits, Vehicle};
use nalgebra::{Quaternion, Vector3};
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
    /// 1/m, 1/kg.
    inverse_mass: f64,
    /// g, m/s^2.
    gravity: f64,
    /// Diagonal of J^-1, 1/(kg m^2).
    inverse_inertia: Vector3<f64>,
    /// (J_jj - J_kk) / J_ii: what omega_j omega_k adds to omega_i'.
    gyroscopic: Vector3<f64>,
    thrust_max: f64,
    torque_max: Vector3<f64>,
    /// Integration step h, s.
    step: f64,
    state: BodyState,
}

impl Plant {
    /// A vehicle at `state`, integrated in steps of `step` seconds.
    #[must_use]
    pub fn new(vehicle: &Vehicle, limits: &Limits, step: f64, state: BodyState) -> Self {
        let inertia = vehicle.inertia.map(f64::from);
        let differences = Vector3::new(inertia.y - inertia.z, inertia.z - inertia.x, inertia.x - inertia.y);
        Self {
            inverse_mass: 1.0 / f64::from(vehicle.mass),
            gravity: f64::from(vehicle.gravity),
            inverse_inertia: inertia.map(|moment| 1.0 / moment),
            gyroscopic: differences.component_div(&inertia),
            thrust_max: f64::from(limits.thrust_max),
            torque_max: limits.torque_max.map(f64::from),
            step,
            state,
        }
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
        let commanded = (f64::from(wrench.thrust), wrench.torque.map(f64::from));
        let thrust = commanded.0.clamp(0.0, self.thrust_max);
        let torque = commanded.1.zip_map(&self.torque_max, |value, limit| value.clamp(-limit, limit));
        self.advance(thrust, &torque, steps);
        self.check()?;
        Ok(thrust != commanded.0 || torque != commanded.1)
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
        let motion = Motion::new(self, thrust, torque);
        let BodyState { mut position, mut velocity, mut attitude, angular_velocity } = self.state;
        let mut rate = angular_velocity * (0.25 * self.step);
        for _ in 0..steps {
            (position, velocity, attitude, rate) = motion.step(&position, &velocity, &attitude, &rate);
        }
        self.state = BodyState { position, velocity, attitude, angular_velocity: rate * (4.0 / self.step) };
    }
}

const THIRD: f64 = 1.0 / 3.0;

/// The equations of motion under one held command, scaled for one step h.
///
/// With the body rate as r = h omega / 4, half a step of q' is q (0, r) and half a step of r' is
/// r_i += 2 (J_jj - J_kk) / J_ii r_j r_k + h^2 tau_i / (8 J_ii): the factors of the method are spent once per command
/// instead of four times per step.
struct Motion {
    /// 2 (J_jj - J_kk) / J_ii.
    gyroscopic: Vector3<f64>,
    /// h^2 tau_i / (8 J_ii).
    torque: Vector3<f64>,
    /// h.
    step: f64,
    /// Change of velocity in one step per unit of the summed thrust directions, and the same in free fall with T along z.
    velocity: (f64, f64),
    /// Change of position beyond h v, likewise.
    position: (f64, f64),
}

impl Motion {
    fn new(plant: &Plant, thrust: f64, torque: &Vector3<f64>) -> Self {
        let h = plant.step;
        let specific_thrust = thrust * plant.inverse_mass;
        let vertical = specific_thrust - plant.gravity;
        Self {
            gyroscopic: plant.gyroscopic * 2.0,
            torque: torque.component_mul(&plant.inverse_inertia) * (0.125 * h * h),
            step: h,
            velocity: (specific_thrust * h / 3.0, vertical * h),
            position: (specific_thrust * h * h / 3.0, vertical * 0.5 * h * h),
        }
    }

    /// One Runge-Kutta step of position (m), velocity (m/s), attitude and scaled rate.
    #[inline(always)]
    fn step(
        &self,
        p: &Vector3<f64>,
        v: &Vector3<f64>,
        q: &Quaternion<f64>,
        r: &Vector3<f64>,
    ) -> (Vector3<f64>, Vector3<f64>, Quaternion<f64>, Vector3<f64>) {
        // The stages r_2 to r_4; with e_4 the last half step, the weighted mean of all four changes is
        // (r_2 + 2 r_3 + r_4 - r + e_4) / 3 added up from the stages themselves.
        let (gyroscopic, torque) = (&self.gyroscopic, &self.torque);
        let pushed = r + torque;
        let r_2 = pushed + gyroscopic.component_mul(&products(r));
        let r_3 = pushed + gyroscopic.component_mul(&products(&r_2));
        let half_step_3 = torque + gyroscopic.component_mul(&products(&r_3));
        let r_4 = r + (half_step_3 + half_step_3);
        let half_step_4 = torque + gyroscopic.component_mul(&products(&r_4));
        let r_next = ((r_2 + r_3) + (r_3 + r_4) - r + half_step_4) * THIRD;

        let q_2 = turned(q, q, r);
        let q_3 = turned(q, &q_2, &r_2);
        let q_4 = turned(q, &q_3, &(r_3 + r_3));
        let sum = (q_2 + q_3) + (q_3 + q_4) - q;
        // One Newton step towards unit length; taken from the length before the step, so that nothing waits for it.
        let to_unit = 1.5 - 0.5 * q.norm_squared();
        let q_next = turned(&sum, &q_4, &r_4) * (to_unit * THIRD);

        // The weights of v' = a are 1, 2, 2, 1 sixths; those of p, whose stages are v + h a / 2 and so on, 1, 1, 1, 0.
        let middle = lean(&q_2) + lean(&q_3);
        let p_lean = lean(q) + middle;
        let v_lean = p_lean + middle + lean(&q_4);
        (
            p + v * self.step + p_lean * self.position.0 + Vector3::z() * self.position.1,
            v + v_lean * self.velocity.0 + Vector3::z() * self.velocity.1,
            q_next,
            r_next,
        )
    }
}

/// What the gyroscopic term multiplies.
#[inline(always)]
fn products(r: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(r.y * r.z, r.z * r.x, r.x * r.y)
}

/// `from` after half a step of q' = q (0, omega) / 2: from + q (0, r).
#[inline(always)]
fn turned(from: &Quaternion<f64>, q: &Quaternion<f64>, r: &Vector3<f64>) -> Quaternion<f64> {
    Quaternion::new(
        (from.w - q.i * r.x) - (q.j * r.y + q.k * r.z),
        (from.i + q.w * r.x) + (q.j * r.z - q.k * r.y),
        (from.j + q.w * r.y) + (q.k * r.x - q.i * r.z),
        (from.k + q.w * r.z) + (q.i * r.y - q.j * r.x),
    )
}

/// Half of R(q) e3 - e3: how far the thrust axis leans.
#[inline(always)]
fn lean(q: &Quaternion<f64>) -> Vector3<f64> {
    Vector3::new(q.i * q.k + q.w * q.j, q.j * q.k - q.w * q.i, -(q.i * q.i + q.j * q.j))
}

#[cfg(test)]
mod tests;
