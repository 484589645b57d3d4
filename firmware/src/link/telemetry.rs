//! Telemetry: the vehicle's state, as MAVLink messages in MAVLink's frames.
//!
//! - [`kind`]: which messages there are: an entry each;
//! - [`vehicle`]: what it is doing: heartbeat, modes, sensors, battery, events, parameters;
//! - [`motion`]: how it moves: attitude, position, odometry, target, home;
//! - [`controllers`]: what the motors' controllers answer;
//! - [`mod@bench`]: what a person on the bench looks at, before there is a pose;
//! - [`identity`]: what it is.

pub mod bench;
pub mod controllers;
pub mod identity;
pub mod kind;
pub mod motion;
pub mod vehicle;

use super::origin::Origin;
use crate::esc::controller::{Controller, RotorSpeeds};
use crate::hardware::MOTOR_COUNT;
use crate::shared::report::{Calibrated, Report, Traffic};
use estimation::imu::VibrationReport;
use flight::{ImuSample, Stamped};

/// The inputs of a message.
#[derive(Debug, Clone)]
pub struct View {
    /// The vehicle's clock, us.
    pub now: u64,
    /// Control's last report, if it is recent.
    pub report: Option<Stamped<Report>>,
    /// The newest inertial sample, if it is recent.
    pub imu: Option<Stamped<ImuSample>>,
    /// How much the accelerometer is shaken, if that is recent.
    pub vibration: Option<VibrationReport>,
    /// What has been calibrated.
    pub calibrated: Calibrated,
    /// Which of the [named values](bench::named) has its turn.
    pub turn: usize,
    /// V, if it is known.
    pub voltage: Option<f32>,
    /// The line's counts.
    pub traffic: Traffic,
    /// Whether a simulator has sensors and motors.
    pub simulated: bool,
    /// Whether flights are logged, if there is a card.
    pub is_logged: Option<bool>,
    /// How fast the rotors turn, if that was measured within the last second.
    pub rotor_speeds: Option<Stamped<RotorSpeeds>>,
    /// What their controllers have answered, likewise.
    pub controllers: Option<[Controller; MOTOR_COUNT]>,
    /// Where the local frame is on the globe.
    pub origin: Origin,
}

impl View {
    /// Control's last report.
    fn report(&self) -> Option<&Report> {
        self.report.as_ref().map(|report| &report.value)
    }

    /// The time of that report, us.
    fn time(&self) -> Option<u64> {
        self.report.as_ref().map(|report| report.time)
    }
}
