//! A flight on the estimator: an IMU that samples at 1 kHz, poses that come late, and the core's estimator between them and the
//! law, as on the boards.
//!
//! ```text
//! every millisecond   omega_m = omega + b_g + n,  f_m = R' ((v_k - v_k-1) / 1 ms + g e3) + b_a + n  -> Conditioner -> Estimator
//! every pose_every    p + n,  exp(n) q  -> pose_delay later -> Estimator
//! every tick          Estimator::state -> law
//! ```
//!
//! Noise densities and the walks of the biases are a BMI088's times `imu_noise`; the biases are drawn once. Before a flight
//! begins the vehicle is carried into its start for [`ALIGNING`], at its velocity and its body rates, by a hand that nobody sees: the
//! estimator begins to work in motion, too.

use crate::sensors::{noise, single};
use controller_core::error::ParameterError;
use controller_core::estimator::{Estimator, EstimatorParameters, Fault, PoseMeasurement, Settings};
use controller_core::flight::{Pose, Stamped, Velocity};
use controller_core::imu::{Calibration, Conditioner, ImuParameters};
use controller_core::state::State;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};
use scenario::Scenario;
use scenario::body::BodyState;
use scenario::reality::estimator::{self, IMU_RATE};
use std::collections::VecDeque;
use std::fmt;

/// How long the vehicle is carried before its flight, us.
pub const ALIGNING: u64 = 3_000_000;

/// Between two samples, us.
const SAMPLE: u64 = 1_000;

/// There is no state to fly on: why, as far as the estimator says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoEstimate(pub Option<Fault>);

impl fmt::Display for NoEstimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(fault) => write!(f, "no state to fly on. {fault}"),
            None => f.write_str("no state to fly on"),
        }
    }
}

/// Sensors and estimator in use.
#[derive(Debug, Clone)]
pub struct Estimation {
    what: estimator::Estimator,
    gravity: f64,
    random: Xoshiro256PlusPlus,
    /// The sensors' clock, us: [`ALIGNING`] when the flight begins.
    clock: u64,
    gyro_bias: Vector3<f64>,
    accelerometer_bias: Vector3<f64>,
    /// m/s, at the last sample.
    velocity: Vector3<f64>,
    conditioner: Conditioner,
    estimator: Estimator,
    /// Poses on their way, with their times of arrival, us.
    late: VecDeque<(u64, Stamped<PoseMeasurement>)>,
    jumps: u32,
}

impl Estimation {
    /// The scenario's, aligned; none where it has none.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Option<Self> {
        let what = scenario.reality.estimator?;
        let gravity = scenario.configuration.vehicle().gravity;
        // Both are checked: the file's numbers when it was read.
        let (conditioner, settings) = Self::parts(&what, gravity).ok()?;
        let mut random = Xoshiro256PlusPlus::seed_from_u64(what.seed);
        let mut bias = |deviation: f32| noise(&mut random, what.imu_noise * f64::from(deviation));
        let real = EstimatorParameters::BMI088;
        let (gyro_bias, accelerometer_bias) = (bias(real.gyro_bias), bias(real.accelerometer_bias));
        let mut estimation = Self {
            what,
            gravity: gravity.into(),
            random,
            clock: 0,
            gyro_bias,
            accelerometer_bias,
            velocity: scenario.initial.velocity,
            conditioner,
            estimator: Estimator::new(&settings),
            late: VecDeque::new(),
            jumps: 0,
        };
        while estimation.clock < ALIGNING {
            let left = (ALIGNING - estimation.clock - SAMPLE) as f64 * 1e-6;
            estimation.sample(&before(&scenario.initial, left));
        }
        estimation.jumps = estimation.estimator.health(ALIGNING).jumps;
        Some(estimation)
    }

    fn parts(what: &estimator::Estimator, gravity: f32) -> Result<(Conditioner, Settings), ParameterError> {
        let conditioner = Conditioner::new(&ImuParameters::BMI088, &Calibration::NONE)?;
        Ok((conditioner, Settings::new(&what.believed(gravity))?))
    }

    /// How many samples there are in a period, us.
    #[must_use]
    pub fn samples(&self, period: u64) -> u32 {
        (period / SAMPLE) as u32
    }

    /// Takes the sample of a vehicle at `state`, a millisecond after the last, and the poses that arrive now.
    pub fn sample(&mut self, state: &BodyState) {
        self.clock += SAMPLE;
        let real = EstimatorParameters::BMI088;
        let scale = |density: f32| self.what.imu_noise * f64::from(density);
        let (each, walk) = (IMU_RATE.sqrt(), 1.0 / IMU_RATE.sqrt());
        self.gyro_bias += noise(&mut self.random, scale(real.gyro_walk) * walk);
        self.accelerometer_bias += noise(&mut self.random, scale(real.accelerometer_walk) * walk);
        let acceleration = (state.velocity - self.velocity) * IMU_RATE;
        self.velocity = state.velocity;
        let attitude = UnitQuaternion::new_normalize(state.attitude);
        let force = attitude.inverse_transform_vector(&(acceleration + Vector3::z() * self.gravity));
        let rate = state.angular_velocity + self.gyro_bias + noise(&mut self.random, scale(real.gyro_noise) * each);
        let force = force + self.accelerometer_bias + noise(&mut self.random, scale(real.accelerometer_noise) * each);
        if let Some(increment) = self.conditioner.sample(self.clock, &single(&rate), Some(&single(&force))).increment {
            self.estimator.imu(&increment);
        }
        if (self.clock / SAMPLE).is_multiple_of(self.what.pose_every) {
            self.look(state, &attitude);
        }
        while let Some((_, pose)) = self.late.pop_front_if(|(arrival, _)| *arrival <= self.clock) {
            // What became of it, the estimator's health says.
            let _ = self.estimator.pose(&pose, self.clock);
        }
    }

    /// What the law is told at this moment, and whether the estimate has jumped since it was told last.
    ///
    /// # Errors
    /// [`NoEstimate`].
    pub fn told(&mut self) -> Result<(State, bool), NoEstimate> {
        let Some(estimated) = self.estimator.state(self.clock) else {
            return Err(NoEstimate(self.estimator.health(self.clock).faults.worst()));
        };
        let jumped = estimated.jumps != self.jumps;
        self.jumps = estimated.jumps;
        Ok((estimated.state, jumped))
    }

    /// The pose source takes a picture.
    fn look(&mut self, state: &BodyState, attitude: &UnitQuaternion<f64>) {
        let position = state.position + noise(&mut self.random, self.what.position_noise);
        let turned = UnitQuaternion::from_scaled_axis(noise(&mut self.random, self.what.attitude_noise));
        let attitude = (turned * attitude).into_inner().coords.map(|value| value as f32);
        if self.random.random_bool(self.what.dropout) || self.is_out() {
            return;
        }
        let nothing = Velocity::World(Vector3::zeros());
        // A vehicle that is too far away for a pose has none.
        if let Ok(pose) = Pose::new(single(&position), nothing, Quaternion::from(attitude)) {
            let value = PoseMeasurement::new(&pose);
            self.late.push_back((self.clock + self.what.pose_delay * SAMPLE, Stamped { value, time: self.clock }));
        }
    }

    /// Whether poses are out, a delay before they would arrive.
    fn is_out(&self) -> bool {
        let arrival = (self.clock + self.what.pose_delay * SAMPLE) as f64 * 1e-6 - ALIGNING as f64 * 1e-6;
        self.what.outage.is_some_and(|outage| (outage.start..outage.start + outage.duration).contains(&arrival))
    }
}

/// A state that leads to `state` in `seconds`, carried there at its velocity and body rates.
fn before(state: &BodyState, seconds: f64) -> BodyState {
    let turned = UnitQuaternion::from_scaled_axis(state.angular_velocity * -seconds);
    BodyState {
        position: state.position - state.velocity * seconds,
        attitude: state.attitude * turned.into_inner(),
        ..*state
    }
}
