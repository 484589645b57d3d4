//! Telemetry: the vehicle's state, as MAVLink messages in MAVLink's frames.
//!
//! - [`vehicle`]: what it is doing: heartbeat, modes, sensors, battery, events, parameters;
//! - [`motion`]: how it moves: attitude, position, odometry, target, home;
//! - [`identity`]: what it is.

pub mod identity;
pub mod kind;
pub mod motion;
pub mod vehicle;

use kind::Kind;

use super::origin::Origin;
use super::time_sync;
use super::writer::Writer;
use crate::shared::{Report, Traffic};
use flight::Stamped;

/// The inputs of a message.
#[derive(Debug, Clone)]
pub struct View {
    /// The vehicle's clock, us.
    pub now: u64,
    /// Control's last report, if it is recent.
    pub report: Option<Stamped<Report>>,
    /// V, if it is known.
    pub voltage: Option<f32>,
    /// The line's counts.
    pub traffic: Traffic,
    /// Whether a simulator has sensors and motors.
    pub simulated: bool,
    /// Whether flights are logged, if there is a card.
    pub is_logged: Option<bool>,
    /// Where the local frame is on the globe.
    pub origin: Origin,
}

impl View {
    /// Writes the message as `system`'s; whether there was a value to send.
    pub fn write(&self, kind: Kind, system: u8, writer: &mut Writer) -> bool {
        let Some(report) = &self.report else { return self.write_without_report(kind, system, writer) };
        let (time, report) = (report.time, &report.value);
        match kind {
            Kind::Attitude => writer.write_some(system, motion::attitude(time, report)),
            Kind::AttitudeQuaternion => writer.write_some(system, motion::attitude_quaternion(time, report)),
            Kind::Position => writer.write_some(system, motion::position(time, report)),
            Kind::GlobalPosition => writer.write_some(system, motion::global_position(time, report, &self.origin)),
            Kind::Odometry => writer.write_some(system, motion::odometry(time, report)),
            Kind::PositionTarget => writer.write_some(system, motion::position_target(time, report)),
            Kind::HomePosition => writer.write_some(system, motion::home(report, &self.origin)),
            Kind::EstimatorStatus => writer.write_some(system, Some(motion::estimator_status(time, report))),
            Kind::ExtendedState => writer.write_some(system, Some(vehicle::extended_state(report))),
            Kind::MissionCurrent => writer.write_some(system, Some(vehicle::mission_current(report))),
            Kind::CurrentMode => writer.write_some(system, Some(vehicle::current_mode(&report.into()))),
            _ => self.write_without_report(kind, system, writer),
        }
    }

    /// Messages that do not depend on control.
    fn write_without_report(&self, kind: Kind, system: u8, writer: &mut Writer) -> bool {
        let report = self.report.as_ref().map(|report| &report.value);
        match kind {
            Kind::Heartbeat => {
                writer.write(system, &vehicle::heartbeat(report.map(Into::into), self.simulated));
            }
            Kind::SystemStatus => {
                writer.write(system, &vehicle::status(self.voltage, report, self.traffic, self.is_logged))
            }
            Kind::BatteryStatus => writer.write(system, &vehicle::battery(self.voltage)),
            Kind::SystemTime => writer.write(system, &motion::system_time(self.now)),
            Kind::TimeSync => writer.write(system, &time_sync::question(self.now)),
            Kind::GlobalOrigin => writer.write(system, &motion::origin(&self.origin)),
            Kind::AutopilotVersion => writer.write(system, &identity::autopilot_version()),
            Kind::ProtocolVersion => writer.write(system, &identity::protocol_version()),
            _ => return false,
        }
        true
    }
}
