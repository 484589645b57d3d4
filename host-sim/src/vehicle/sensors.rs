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
//! - In the trials of a search gyro, accelerometer and rotor speeds are late by their filters (`late`), and a pose by
//!   a further number of ticks. On its arrival it corrects what was known of the moment it shows, and what was measured
//!   since carries that on: r is of that moment.
//! - The start of a flight is known: where a vehicle takes off from, it has been standing.
//!
//! The gyro's and accelerometer's noise is that of samples at the control rate. Sources: O. J. Woodman, *An
//! introduction to inertial navigation*, 2007, section 3 (noise and bias of a gyro); P. R. Kalata, *The Tracking
//! Index*, IEEE TAES 20(2), 1984 (the filter).

mod late;
mod propagation;

use crate::vehicle::sensed::Sensed;
use controller_core::state::State;
use late::Late;
use nalgebra::{Quaternion, SVector, UnitQuaternion, Vector3};
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
    /// Bias and noise of the accelerometer's sample, m/s^2.
    accelerometer_error: Vector3<f64>,
    /// Gyro, accelerometer and rotor speeds on their way through filters.
    gyro: Late<3>,
    sensed: Late<7>,
    /// The last ticks, this one last: what a pose that arrives will need of its own.
    past: VecDeque<Past>,
    /// Measurements still under way: states, and what the accelerometer felt before them.
    late: VecDeque<(State, Option<Vector3<f32>>)>,
    /// v' since the last tick, m/s^2, world, as the accelerometer and the attitude at the tick have it.
    acceleration: Option<Vector3<f32>>,
    arrived: Option<Vector3<f32>>,
}

/// What a late pose will need of the tick that it shows.
#[derive(Debug, Clone, Copy)]
struct Past {
    /// The gyro's sample, rad/s.
    gyro: Vector3<f32>,
    /// x, m.
    filtered: Vector3<f64>,
    /// Position, m, and attitude, if one was taken and is to arrive.
    pose: Option<(Vector3<f64>, Quaternion<f32>)>,
}

impl Sensors {
    /// The scenario's, before the first tick; none where it has none.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Option<Self> {
        let what = scenario.reality.sensors?;
        let start = &scenario.initial;
        let rates = single(&start.angular_velocity);
        let late = what.imu_delay / scenario.timing.period();
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
            accelerometer_error: Vector3::zeros(),
            gyro: Late::new(late),
            sensed: Late::new(what.delay_ticks as f64 + late),
            past: VecDeque::new(),
            late: VecDeque::new(),
            acceleration: None,
            arrived: None,
        })
    }

    /// The measured state at this tick, while the vehicle is at `state`.
    pub fn measure(&mut self, state: &BodyState) -> State {
        let rate = self.gyro.take(state.angular_velocity);
        let gyro = single(&(rate + self.what.gyro_bias + self.noise(self.what.gyro_noise)));
        if self.tick > 0 {
            self.carry_on(state, &gyro);
        }
        let seen = self.tick.is_multiple_of(self.what.pose_every) && !self.random.random_bool(self.what.dropout);
        let pose = seen.then(|| self.sample(state));
        self.past.push_back(Past { gyro, filtered: self.filtered, pose });
        if self.past.len() as u64 > self.what.pose_delay_ticks
            && let Some(then) = self.past.pop_front()
            && let Some((position, attitude)) = then.pose
        {
            self.take_pose(&then, &position, attitude);
        }
        if let VelocitySource::Exact { noise } = self.what.velocity {
            self.velocity = state.velocity + self.noise(noise);
        }
        self.true_velocity = state.velocity;
        self.tick += 1;
        let (position, velocity) = (single(&self.position), single(&self.velocity));
        let now = State { position, velocity, attitude: self.attitude.attitude(), angular_velocity: gyro };
        self.late.push_back((now, self.acceleration));
        let (arrived, felt) = self.late.front().copied().unwrap_or((now, self.acceleration));
        self.arrived = felt;
        if self.late.len() as u64 > self.what.delay_ticks {
            self.late.pop_front();
        }
        arrived
    }

    /// v' before the state that [`Self::measure`] gave last, m/s^2, world; none without an accelerometer.
    #[must_use]
    pub fn sensed_force(&self) -> Option<Vector3<f32>> {
        self.arrived
    }

    /// What is sensed at this tick, after its state is measured, while `truth` is what happens.
    pub fn sense(&mut self, truth: &Sensed) -> Sensed {
        let force = truth.specific_force + self.accelerometer_error;
        let mut all = SVector::<f64, 7>::zeros();
        all.fixed_rows_mut::<3>(0).copy_from(&force);
        all.fixed_rows_mut::<4>(3).copy_from(&truth.wrench);
        let late = self.sensed.take(all);
        Sensed { specific_force: late.fixed_rows::<3>(0).into(), wrench: late.fixed_rows::<4>(3).into() }
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
        self.accelerometer_error = bias + self.noise(noise);
        let sample = truly.inverse_transform_vector(&mean) + self.accelerometer_error;
        let believed = Quaternion::from(self.attitude.attitude().coords.map(f64::from));
        let felt = UnitQuaternion::new_normalize(believed) * sample - gravity;
        self.acceleration = Some(single(&felt));
        felt
    }

    /// A pose of this moment: position, m, and attitude.
    fn sample(&mut self, state: &BodyState) -> (Vector3<f64>, Quaternion<f32>) {
        let turned = UnitQuaternion::from_scaled_axis(self.noise(self.what.attitude_noise));
        let attitude = (state.attitude * turned.into_inner()).coords.map(|value| value as f32);
        (state.position + self.noise(self.what.position_noise), Quaternion::from(attitude))
    }

    /// Takes a pose that was true `then`; `past` holds the ticks since.
    fn take_pose(&mut self, then: &Past, position: &Vector3<f64>, attitude: Quaternion<f32>) {
        let mut time = (self.tick - self.past.len() as u64) * self.period_us;
        self.attitude = PropagatedAttitude::new(attitude, then.gyro, time);
        for tick in &self.past {
            time += self.period_us;
            self.attitude.advance(tick.gyro, time);
        }
        let late = self.past.len() as f64 * self.period;
        self.position = position + (self.filtered - then.filtered);
        if let VelocitySource::AlphaBeta { bandwidth } | VelocitySource::Observer { bandwidth, .. } = self.what.velocity
        {
            let between = self.what.pose_every as f64 * self.period;
            let pole = (-bandwidth * between).exp();
            let residual = position - then.filtered;
            let (moves, quickens) =
                (residual * (1.0 - pole * pole), residual * ((1.0 - pole) * (1.0 - pole) / between));
            self.position += quickens * late;
            self.filtered += moves + quickens * late;
            self.velocity += quickens;
            for (tick, past) in self.past.iter_mut().enumerate() {
                past.filtered += moves + quickens * ((tick + 1) as f64 * self.period);
            }
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
