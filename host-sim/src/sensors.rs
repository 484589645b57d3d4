//! The measured state that the controller gets at each control tick.
//!
//! White normal noise n, drawn anew for each sample, on each axis alone; T is the time between ticks.
//!
//! ```text
//! gyro            omega_m = omega + bias + n
//! pose            p_m = p + n,   q_m = q * exp(n / 2)              n about the body's axes, rad
//! accelerometer   f_m = R' ((v_k - v_k-1) / T + g e3) + bias + n     the mean since the last tick
//! ```
//!
//! - Attitude: the last pose's, carried on with the gyro (`propagation`).
//! - Velocity, position: where a pose comes at every tick and the velocity is exact (plus noise), the pose and that
//!   velocity. From an alpha-beta filter otherwise, with a double pole rho = exp(-bandwidth T_p), T_p the time between
//!   poses:
//!
//! ```text
//! each tick   x+ = x + T v + T^2/2 a,   v+ = v + T a,     a = 0, or with an accelerometer R_m f_m - g e3
//! each pose   r = p_m - x,   x += (1 - rho^2) r,   v += (1 - rho)^2 r / T_p
//! ```
//!
//!   and the controller's position is the pose's at a pose and carried on from it with v between poses.
//! - A pose drops out with a given probability. Everything arrives a number of ticks late; until the first sample does,
//!   it is all there is.
//! - The start of a flight is known: where a vehicle takes off from, it has been standing.
//!
//! The gyro's and accelerometer's noise is that of samples at the control rate. Sources: O. J. Woodman, *An
//! introduction to inertial navigation*, 2007, section 3 (noise and bias of a gyro); P. R. Kalata, *The Tracking
//! Index*, IEEE TAES 20(2), 1984 (the filter).

mod propagation;

use controller_core::state::State;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use propagation::PropagatedAttitude;
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use scenario::Scenario;
use scenario::body::BodyState;
use scenario::reality::sensors::{self, VelocitySource};
use std::collections::VecDeque;

/// Sensors in use.
#[derive(Debug, Clone)]
pub struct Sensors {
    what: sensors::Sensors,
    /// T, s, and in us.
    period: f64,
    period_us: u64,
    gravity: f64,
    random: Xoshiro256PlusPlus,
    tick: u64,
    /// The controller's position, m.
    position: Vector3<f64>,
    attitude: PropagatedAttitude,
    /// x, m.
    filtered: Vector3<f64>,
    /// v, m/s.
    velocity: Vector3<f64>,
    /// The true velocity at the last tick, m/s: the accelerometer's.
    true_velocity: Vector3<f64>,
    /// Measurements still under way.
    late: VecDeque<State>,
}

impl Sensors {
    /// The scenario's, before the first tick; none where it has none.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Option<Self> {
        let what = scenario.reality.sensors?;
        let start = &scenario.initial;
        let rates = single(&start.angular_velocity);
        Some(Self {
            what,
            period: scenario.timing.period(),
            period_us: scenario.timing.period_us,
            gravity: f64::from(scenario.configuration.vehicle().gravity),
            random: Xoshiro256PlusPlus::seed_from_u64(what.seed),
            tick: 0,
            position: start.position,
            attitude: PropagatedAttitude::new(start.measured().attitude, rates, 0),
            filtered: start.position,
            velocity: start.velocity,
            true_velocity: start.velocity,
            late: VecDeque::new(),
        })
    }

    /// The measured state at this tick, while the vehicle is at `state`.
    pub fn measure(&mut self, state: &BodyState) -> State {
        let gyro = single(&(state.angular_velocity + self.what.gyro_bias + self.noise(self.what.gyro_noise)));
        if self.tick > 0 {
            self.carry_on(state, &gyro);
        }
        if self.tick.is_multiple_of(self.what.pose_every) && !self.random.random_bool(self.what.dropout) {
            self.take_pose(state, &gyro);
        }
        if let VelocitySource::Exact { noise } = self.what.velocity {
            self.velocity = state.velocity + self.noise(noise);
        }
        self.true_velocity = state.velocity;
        self.tick += 1;
        let (position, velocity) = (single(&self.position), single(&self.velocity));
        let now = State { position, velocity, attitude: self.attitude.attitude(), angular_velocity: gyro };
        self.late.push_back(now);
        let arrived = self.late.front().copied().unwrap_or(now);
        if self.late.len() as u64 > self.what.delay_ticks {
            self.late.pop_front();
        }
        arrived
    }

    fn noise(&mut self, deviation: f64) -> Vector3<f64> {
        noise(&mut self.random, deviation)
    }

    /// Brings what is known to this tick.
    fn carry_on(&mut self, state: &BodyState, gyro: &Vector3<f32>) {
        self.attitude.advance(*gyro, self.tick * self.period_us);
        let (period, acceleration) = (self.period, self.acceleration(state));
        let moved = self.velocity * period + acceleration * (0.5 * period * period);
        self.position += moved;
        self.filtered += moved;
        self.velocity += acceleration * period;
    }

    /// a, m/s^2, world.
    fn acceleration(&mut self, state: &BodyState) -> Vector3<f64> {
        let VelocitySource::Observer { noise, bias, .. } = self.what.velocity else {
            return Vector3::zeros();
        };
        let gravity = Vector3::z() * self.gravity;
        let mean = (state.velocity - self.true_velocity) / self.period + gravity;
        let truly = UnitQuaternion::new_unchecked(state.attitude);
        let sample = truly.inverse_transform_vector(&mean) + bias + self.noise(noise);
        let believed = Quaternion::from(self.attitude.attitude().coords.map(f64::from));
        UnitQuaternion::new_normalize(believed) * sample - gravity
    }

    /// Takes a pose that was true now.
    fn take_pose(&mut self, state: &BodyState, gyro: &Vector3<f32>) {
        let turned = UnitQuaternion::from_scaled_axis(self.noise(self.what.attitude_noise));
        let attitude = (state.attitude * turned.into_inner()).coords.map(|value| value as f32);
        self.attitude = PropagatedAttitude::new(Quaternion::from(attitude), *gyro, self.tick * self.period_us);
        self.position = state.position + self.noise(self.what.position_noise);
        if let VelocitySource::AlphaBeta { bandwidth } | VelocitySource::Observer { bandwidth, .. } = self.what.velocity
        {
            let between = self.what.pose_every as f64 * self.period;
            let pole = (-bandwidth * between).exp();
            let residual = self.position - self.filtered;
            self.filtered += residual * (1.0 - pole * pole);
            self.velocity += residual * ((1.0 - pole) * (1.0 - pole) / between);
        }
    }
}

/// Normal noise of this standard deviation on three axes.
pub(crate) fn noise(random: &mut Xoshiro256PlusPlus, deviation: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| StandardNormal.sample(random)) * deviation
}

/// Rounded to single precision.
pub(crate) fn single(vector: &Vector3<f64>) -> Vector3<f32> {
    vector.map(|value| value as f32)
}

#[cfg(test)]
mod tests;
