//! The vehicle in flight: the paper's rigid body, eq. (2), in double precision.
//!
//! ```text
//! p' = v                     v' = -g e3 + R(q) e3 T/m           world frame, z up
//! q' = q (0, omega) / 2      J omega' = (J omega) x omega + tau   body frame
//! ```
//!
//! Thrust T and torque tau act as commanded, clipped to the vehicle's limits, and are held between control ticks. The
//! classical fourth-order Runge-Kutta method advances the state. The equations form a cascade (omega' needs omega only;
//! q' needs q and omega; v' needs q; p' needs v), so [`Plant::step`] runs the four stages of each level before the next
//! level and folds the position's stages into one expression: the same method, about a quarter of the work.
//!
//! It has no rotors, no air and no ground: thrust and torque appear at once, and nothing stops a fall.

use controller_core::state::{State, Wrench};
use controller_core::vehicle::{Limits, Vehicle};
use nalgebra::{Quaternion, Vector3};
use std::fmt;

/// The rigid body's state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyState {
    /// p, m, world frame (z up).
    pub position: Vector3<f64>,
    /// v, m/s, world frame.
    pub velocity: Vector3<f64>,
    /// q, body to world, unit, scalar first.
    pub attitude: Quaternion<f64>,
    /// omega, rad/s, body frame.
    pub angular_velocity: Vector3<f64>,
}

impl BodyState {
    /// The state as the control law sees it: rounded to single precision.
    #[must_use]
    pub fn measured(&self) -> State {
        State {
            position: self.position.map(|value| value as f32),
            velocity: self.velocity.map(|value| value as f32),
            attitude: Quaternion::from(self.attitude.coords.map(|value| value as f32)),
            angular_velocity: self.angular_velocity.map(|value| value as f32),
        }
    }

    /// Yaw psi of R = Rz(yaw) Ry(pitch) Rx(roll), rad, in (-pi, pi].
    #[must_use]
    pub fn yaw(&self) -> f64 {
        let q = &self.attitude;
        (2.0 * (q.w * q.k + q.i * q.j)).atan2(1.0 - 2.0 * (q.j * q.j + q.k * q.k))
    }

    /// Whether every component is a finite number.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        (self.position.sum() + self.velocity.sum() + self.attitude.coords.sum() + self.angular_velocity.sum())
            .is_finite()
    }
}

/// The attitude R = Rz(yaw) Ry(pitch) Rx(roll), angles in rad.
#[must_use]
pub fn attitude_from_euler(roll: f64, pitch: f64, yaw: f64) -> Quaternion<f64> {
    let about = |angle: f64, x: f64, y: f64, z: f64| {
        let (sin, cos) = (0.5 * angle).sin_cos();
        Quaternion::new(cos, sin * x, sin * y, sin * z)
    };
    about(yaw, 0.0, 0.0, 1.0) * about(pitch, 0.0, 1.0, 0.0) * about(roll, 1.0, 0.0, 0.0)
}

/// Which commands the limits cut during one control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Clipping {
    /// Thrust was outside [0, thrust_max].
    pub thrust: bool,
    /// A torque was outside ±torque_max about its axis.
    pub torque: bool,
}

impl Clipping {
    /// Whether anything was cut.
    #[must_use]
    pub fn any(self) -> bool {
        self.thrust || self.torque
    }

    /// What either cut.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self { thrust: self.thrust || other.thrust, torque: self.torque || other.torque }
    }
}

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
    /// The greatest angle, rad, that a step may turn: beyond it the integrator no longer follows the rotation.
    pub const GREATEST_TURN_PER_STEP: f64 = 0.5;

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

    /// Holds `wrench`, clipped to the limits, for `steps` integration steps.
    ///
    /// # Errors
    /// [`Diverged`] if the state is not finite afterwards.
    pub fn hold(&mut self, wrench: &Wrench, steps: u32) -> Result<Clipping, Diverged> {
        let commanded = (f64::from(wrench.thrust), wrench.torque.map(f64::from));
        let thrust = commanded.0.clamp(0.0, self.thrust_max);
        let torque = commanded.1.zip_map(&self.torque_max, |value, limit| value.clamp(-limit, limit));
        let specific_thrust = thrust * self.inverse_mass;
        let torque_share = torque.component_mul(&self.inverse_inertia);
        for _ in 0..steps {
            self.step(specific_thrust, &torque_share);
        }
        self.check()?;
        Ok(Clipping { thrust: thrust != commanded.0, torque: torque != commanded.1 })
    }

    /// One integration step under thrust, N, and torque, N m, as they are.
    pub fn act(&mut self, thrust: f64, torque: &Vector3<f64>) {
        self.step(thrust * self.inverse_mass, &torque.component_mul(&self.inverse_inertia));
    }

    /// # Errors
    /// [`Diverged`] if the state is not finite.
    pub fn check(&self) -> Result<(), Diverged> {
        if self.state.is_finite() { Ok(()) } else { Err(Diverged) }
    }

    /// One Runge-Kutta step under the specific thrust T/m (m/s^2) and J^-1 tau (rad/s^2).
    #[inline]
    fn step(&mut self, specific_thrust: f64, torque_share: &Vector3<f64>) {
        let (h, half, sixth) = (self.step, 0.5 * self.step, self.step / 6.0);
        let BodyState { position: p, velocity: v, attitude: q, angular_velocity: w } = self.state;

        let w_rate_1 = self.angular_acceleration(&w, torque_share);
        let w_2 = w + w_rate_1 * half;
        let w_rate_2 = self.angular_acceleration(&w_2, torque_share);
        let w_3 = w + w_rate_2 * half;
        let w_rate_3 = self.angular_acceleration(&w_3, torque_share);
        let w_4 = w + w_rate_3 * h;
        let w_rate_4 = self.angular_acceleration(&w_4, torque_share);

        let q_rate_1 = attitude_rate(&q, &w);
        let q_2 = q + q_rate_1 * half;
        let q_rate_2 = attitude_rate(&q_2, &w_2);
        let q_3 = q + q_rate_2 * half;
        let q_rate_3 = attitude_rate(&q_3, &w_3);
        let q_4 = q + q_rate_3 * h;
        let q_rate_4 = attitude_rate(&q_4, &w_4);

        let v_rate_1 = self.acceleration(&q, specific_thrust);
        let v_rate_2 = self.acceleration(&q_2, specific_thrust);
        let v_rate_3 = self.acceleration(&q_3, specific_thrust);
        let v_rate_4 = self.acceleration(&q_4, specific_thrust);

        let q = q + (q_rate_1 + (q_rate_2 + q_rate_3) * 2.0 + q_rate_4) * sixth;
        self.state = BodyState {
            // The stages of p' = v are v, v + h/2 v_1', v + h/2 v_2', v + h v_3': their weighted sum in closed form.
            position: p + (v + (v_rate_1 + v_rate_2 + v_rate_3) * sixth) * h,
            velocity: v + (v_rate_1 + (v_rate_2 + v_rate_3) * 2.0 + v_rate_4) * sixth,
            // One Newton step of 1/|q|: the length is off by far less than the root of the rounding error.
            attitude: q * (1.5 - 0.5 * q.norm_squared()),
            angular_velocity: w + (w_rate_1 + (w_rate_2 + w_rate_3) * 2.0 + w_rate_4) * sixth,
        };
    }

    /// omega' = J^-1 ((J omega) x omega + tau).
    #[inline(always)]
    fn angular_acceleration(&self, w: &Vector3<f64>, torque_share: &Vector3<f64>) -> Vector3<f64> {
        self.gyroscopic.component_mul(&Vector3::new(w.y * w.z, w.z * w.x, w.x * w.y)) + torque_share
    }

    /// v' = -g e3 + R(q) e3 T/m.
    #[inline(always)]
    fn acceleration(&self, q: &Quaternion<f64>, specific_thrust: f64) -> Vector3<f64> {
        let twice = 2.0 * specific_thrust;
        Vector3::new(
            twice * (q.i * q.k + q.w * q.j),
            twice * (q.j * q.k - q.w * q.i),
            (specific_thrust - self.gravity) - twice * (q.i * q.i + q.j * q.j),
        )
    }
}

/// q' = q (0, omega) / 2.
#[inline(always)]
fn attitude_rate(q: &Quaternion<f64>, w: &Vector3<f64>) -> Quaternion<f64> {
    let (x, y, z) = (0.5 * w.x, 0.5 * w.y, 0.5 * w.z);
    Quaternion::new(
        -q.i * x - q.j * y - q.k * z,
        q.w * x + q.j * z - q.k * y,
        q.w * y + q.k * x - q.i * z,
        q.w * z + q.i * y - q.j * x,
    )
}

#[cfg(test)]
mod tests;
