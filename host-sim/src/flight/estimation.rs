//! A flight on the estimator: [`Instruments`], and the core's estimator between them and the law, as on the boards.
//!
//! ```text
//! every millisecond   a sample of the IMU -> Conditioner -> Estimator
//! every pose_every    a pose -> pose_delay later -> Estimator
//! every tick          Estimator::state -> law
//! ```
//!
//! Before a flight the vehicle moves into its start for [`ALIGNMENT_US`], at constant velocity and body rates, without
//! forces: so the estimator aligns in motion, too.

use crate::vehicle::instruments::{Instruments, SAMPLE_PERIOD_US};
use crate::vehicle::sensed::Sensed;
use controller_core::error::ParameterError;
use controller_core::state::State;
use estimation::estimator::{Estimator, Fault, PoseMeasurement, Settings, VELOCITY_LATE_S};
use estimation::imu::{Calibration, Conditioner, INCREMENT_US, ImuParameters};
use flight::Stamped;
use nalgebra::{UnitQuaternion, Vector3, Vector4};
use scenario::Scenario;
use scenario::body::BodyState;
use scenario::reality::estimator;
use std::collections::VecDeque;
use std::fmt;

/// How long the vehicle is carried before its flight.
pub const ALIGNMENT_US: u64 = 3_000_000;

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

/// How late the velocity of a law's states is at most, where the thrust has just changed, s: zero without an estimator.
pub fn velocity_late(scenario: &Scenario) -> f32 {
    if scenario.reality.estimator.is_some() { VELOCITY_LATE_S } else { 0.0 }
}

/// Sensors and estimator in use.
#[derive(Debug, Clone)]
pub struct Estimation {
    instruments: Instruments,
    /// The sensors' clock, us: [`ALIGNMENT_US`] when the flight begins.
    clock: u64,
    conditioner: Conditioner,
    estimator: Estimator,
    jumps: u32,
    /// v' since the last tick, m/s^2, world, by accelerometer.
    felt: Option<Vector3<f32>>,
    /// f, m/s^2, body, of the last estimate: without the accelerometer's bias, the mean over two increments.
    specific_force: Vector3<f64>,
    /// Wrenches of the rotors, one a tick, over as long.
    acted: VecDeque<Vector4<f64>>,
    /// Between ticks, us.
    period: u64,
    gravity: f32,
}

impl Estimation {
    /// The scenario's, aligned; none where it has none.
    pub fn new(scenario: &Scenario) -> Option<Self> {
        let what = scenario.reality.estimator?;
        let gravity = scenario.configuration.vehicle().gravity;
        // Both are checked: the file's numbers when it was read.
        let (conditioner, settings) = Self::parts(&what, gravity, scenario.timing.period_us).ok()?;
        let mut estimation = Self {
            instruments: Instruments::new(&what, gravity.into(), scenario.initial.velocity, ALIGNMENT_US),
            clock: 0,
            conditioner,
            estimator: Estimator::new(&settings),
            jumps: 0,
            felt: None,
            specific_force: Vector3::z() * f64::from(gravity),
            acted: VecDeque::new(),
            period: scenario.timing.period_us,
            gravity,
        };
        while estimation.clock < ALIGNMENT_US {
            let left = (ALIGNMENT_US - estimation.clock - SAMPLE_PERIOD_US) as f64 * 1e-6;
            estimation.sample(&before(&scenario.initial, left));
        }
        estimation.jumps = estimation.estimator.health(ALIGNMENT_US).jumps;
        Some(estimation)
    }

    fn parts(
        what: &estimator::Estimator,
        gravity: f32,
        period: u64,
    ) -> Result<(Conditioner, Settings), ParameterError> {
        let conditioner = Conditioner::new(&ImuParameters::BMI088, &Calibration::NONE, period)?;
        Ok((conditioner, Settings::new(&what.believed(gravity))?))
    }

    /// How many samples there are in a period, us.
    pub fn samples(&self, period: u64) -> u32 {
        (period / SAMPLE_PERIOD_US) as u32
    }

    /// Takes the sample of a vehicle at `state`, a millisecond after the last, and the poses that arrive now.
    pub fn sample(&mut self, state: &BodyState) {
        self.clock += SAMPLE_PERIOD_US;
        let sample = self.instruments.sample(state, self.clock);
        let force = Some(&sample.specific_force);
        if let Some(increment) = self.conditioner.sample(self.clock, &sample.angular_velocity, force).increment {
            self.estimator.imu(&increment);
        }
        while let Some(Stamped { value, time }) = self.instruments.arrived() {
            // The estimator's health shows what became of it.
            let _ = self.estimator.pose(&Stamped { value: PoseMeasurement::new(&value), time }, self.clock);
        }
    }

    /// The estimate at this moment, and whether it has jumped since the last one.
    pub fn state(&mut self) -> Result<(State, bool), NoEstimate> {
        let (newest, under_way) = (self.conditioner.newest(), self.conditioner.under_way());
        let estimated = newest
            .and_then(|newest| self.estimator.state(self.clock, &newest.value.angular_velocity, under_way.as_ref()));
        let Some(estimated) = estimated else {
            return Err(NoEstimate(self.estimator.health(self.clock).faults.worst()));
        };
        self.felt = self.estimator.mean_acceleration(self.clock, under_way.as_ref());
        let jumped = estimated.jumps != self.jumps;
        self.jumps = estimated.jumps;
        let force = estimated.acceleration + Vector3::z() * self.gravity;
        let attitude = UnitQuaternion::new_unchecked(estimated.state.attitude);
        self.specific_force = attitude.inverse_transform_vector(&force).map(f64::from);
        Ok((estimated.state, jumped))
    }

    /// v' from the last estimate but one to the last, m/s^2, world, by accelerometer.
    pub fn sensed_force(&self) -> Option<Vector3<f32>> {
        self.felt
    }

    /// What is known beside the last estimate, while the rotors act with `truth`: the mean over the same time of both.
    pub fn sense(&mut self, truth: &Sensed) -> Sensed {
        self.acted.push_front(truth.wrench);
        self.acted.truncate((2 * INCREMENT_US).div_ceil(self.period) as usize);
        let wrench = self.acted.iter().sum::<Vector4<f64>>() / self.acted.len() as f64;
        Sensed { specific_force: self.specific_force, wrench }
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

#[cfg(test)]
mod tests;
