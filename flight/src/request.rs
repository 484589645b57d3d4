//! Requests to the pilot, and the setpoints that come beside them.

use super::motor::{MotorSetting, MotorTest};
use super::refusal::Refusal;
use controller_core::governor::{Motion, Setpoint};

/// How old a setpoint may be to be flown. One that moves must be renewed as often, or the vehicle holds.
pub const SETPOINT_AGE_MAX_US: u64 = 1_000_000;

/// A request to the pilot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Request {
    /// Arm and idle.
    Arm,
    /// Stop the motors of a vehicle on the ground.
    Disarm,
    /// Go up so high, m, or as high as the settings say; then hold.
    TakeOff(Option<f32>),
    /// Fly the setpoints that come. While disarmed: from arming on, within [`super::rules::SETPOINTS_REQUEST_MAX_US`]
    /// and unless another request comes.
    FlySetpoints,
    /// Come to rest and hold position.
    Hold,
    /// Fly the mission: from an item on, or from where it was left.
    FlyMission(Option<u8>),
    /// Let the policy fly that is built in, to the setpoints' places; in the air.
    FlyPolicy,
    /// Make an item of the mission the next one.
    SetMissionItem(u8),
    /// Fly to a setpoint and hold it.
    GoTo(Setpoint),
    /// Land and disarm; without a pose, as soon as there is one.
    Land,
    /// Turn one motor slowly.
    MotorTest(MotorTest),
    /// End a motor test.
    EndMotorTest,
    /// Send a setting to one motor's controller, while no motor turns.
    MotorSetting(MotorSetting),
}

/// The newest setpoint that may be flown, and the newest refusal of one, each with its time, us.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct NewestSetpoint(Option<(Setpoint, u64)>, Option<(Refusal, u64)>);

impl NewestSetpoint {
    /// Keeps one that came at `now`, us.
    pub fn keep(&mut self, setpoint: &Setpoint, now: u64) {
        self.0 = Some((*setpoint, now));
    }

    /// Remembers why one that came at `now`, us, is not flown.
    pub fn refuse(&mut self, refusal: Refusal, now: u64) {
        self.1 = Some((refusal, now));
    }

    /// Why there is no setpoint at `now`, us.
    pub fn refused(&self, now: u64) -> Refusal {
        let recent = self.1.filter(|(_, came)| now.saturating_sub(*came) < SETPOINT_AGE_MAX_US);
        recent.map_or(Refusal::NoSetpoints, |(refusal, _)| refusal)
    }

    /// It, if it is fresh at `now`, us.
    pub fn fresh(&self, now: u64) -> Option<&Setpoint> {
        self.0
            .as_ref()
            .filter(|(_, came)| now.saturating_sub(*came) < SETPOINT_AGE_MAX_US)
            .map(|(setpoint, _)| setpoint)
    }

    /// Whether it has ended: it moved and was not renewed. A point is flown to for as long as it takes.
    pub fn has_ended(&self, now: u64) -> bool {
        let rests = matches!(self.0, Some((Setpoint { motion: Motion::Position(_), .. }, _)));
        !rests && self.fresh(now).is_none()
    }
}

#[cfg(test)]
mod tests;
