//! The sensors' measurements of the period that a command began.
//!
//! Where the scenario has `[estimator]`, its [`Instruments`] do: a sample of the IMU each millisecond, and the poses
//! that arrive within the period, late and noisy; its IMU has no filters of its own, because a simulator's samples are
//! true at the times they carry. Elsewhere the sensors are exact: one sample and one pose, of the period's end.
//! `[sensors]` is not used: it describes the measurements of a law without an estimator.
//!
//! Every time is the flight controller's own: that of a command and what the vehicle has moved since.

use super::vehicle::Moved;
use crate::sessions::answer::{Answer, MeasuredPose, answered_speed};
use crate::sessions::messages::MOTOR_COUNT;
use crate::vehicle::instruments::{Instruments, SAMPLE_PERIOD_US};
use flight::{ImuSample, Stamped};
use nalgebra::{UnitQuaternion, Vector3};
use scenario::Scenario;
use scenario::body::BodyState;

/// A vehicle's sensors.
#[derive(Debug, Clone)]
pub struct Senses {
    /// us.
    period: u64,
    /// With the deviations that they say their poses have, m and rad.
    instruments: Option<(Instruments, (f32, f32))>,
}

impl Senses {
    /// The scenario's, of a vehicle at rest.
    pub fn new(scenario: &Scenario) -> Self {
        let gravity = scenario.configuration.vehicle().gravity;
        let instruments = scenario.reality.estimator.map(|what| {
            let believed = what.believed(gravity);
            let deviations = (believed.position_noise, believed.attitude_noise);
            (Instruments::new(&what, gravity.into(), Vector3::zeros(), 0).prompt(), deviations)
        });
        Self { period: scenario.timing.period_us, instruments }
    }

    /// How many states of a period they must be shown, evenly spaced. With `[estimator]` a scenario's plant steps fall
    /// on every millisecond: its file is refused otherwise.
    pub fn instants(&self) -> u64 {
        if self.instruments.is_some() { self.period / SAMPLE_PERIOD_US } else { 1 }
    }

    /// The measurements of a motion that a command of time `command`, us, began.
    pub fn answer(&mut self, command: u64, moved: &Moved) -> Answer {
        let Some((instruments, deviations)) = &mut self.instruments else {
            return exact(command + self.period, moved);
        };
        let mut answer =
            Answer { poses: Vec::new(), rotor_speeds: turned(command + self.period, moved), samples: Vec::new() };
        for (state, time) in moved.path.iter().zip((command + SAMPLE_PERIOD_US..).step_by(SAMPLE_PERIOD_US as usize)) {
            answer.samples.push(Stamped { value: instruments.sample(state, time), time });
            while let Some(Stamped { value: pose, time }) = instruments.arrived() {
                let (position, attitude) = (pose.position(), pose.attitude());
                let value = MeasuredPose { position, attitude, motion: None, deviations: Some(*deviations) };
                answer.poses.push(Stamped { value, time });
            }
        }
        answer
    }
}

/// Exact measurements at the end of a motion, at `time`, us.
fn exact(time: u64, moved: &Moved) -> Answer {
    let state: &BodyState = &moved.state;
    let measured = state.measured();
    let velocity = UnitQuaternion::new_unchecked(state.attitude).inverse() * state.velocity;
    let pose = MeasuredPose {
        position: measured.position,
        attitude: measured.attitude,
        motion: Some((velocity.map(|component| component as f32), measured.angular_velocity)),
        deviations: None,
    };
    let specific_force = moved.specific_force.map(|component| component as f32);
    let sample = ImuSample { angular_velocity: measured.angular_velocity, specific_force };
    Answer {
        poses: vec![Stamped { value: pose, time }],
        rotor_speeds: turned(time, moved),
        samples: vec![Stamped { value: sample, time }],
    }
}

/// How fast the rotors turn at the end of a motion, at `time`, us, as their controllers answer.
fn turned(time: u64, moved: &Moved) -> Option<Stamped<[f32; MOTOR_COUNT]>> {
    let speeds: Vec<f32> = moved.speeds.iter().map(|speed| answered_speed(*speed)).collect();
    speeds.try_into().ok().map(|value| Stamped { value, time })
}

#[cfg(test)]
mod tests;
