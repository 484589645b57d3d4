//! Letting a policy fly, and taking over from it.

use super::Pilot;
use crate::estimate::Estimate;
use crate::permission;
use crate::policy::{Aboard, corners};
use crate::refusal::Refusal;
use crate::settings::FlightSettings;
use controller_core::governor::{Motion, Setpoint};
use controller_core::reference::Reference;
use core::mem;
use nalgebra::Vector3;

impl<P: Aboard> Pilot<'_, P> {
    /// Lets the policy fly, from here, to the newest setpoint's place.
    pub(super) fn start_policy(&mut self, now: u64) -> Result<(), Refusal> {
        permission::to_fly_policy::<P>(self.mode, self.is_airborne())?;
        if self.flies_policy {
            // A client that repeats its request does not take the vehicle from the law.
            self.policy.ask_again();
            return Ok(());
        }
        let chain = self.chain.as_ref().map_err(|grounded| Refusal::Grounded(*grounded))?;
        let Reference { position, heading, .. } = chain.reference();
        let goal = self.newest.fresh(now).and_then(place).unwrap_or(*position);
        let FlightSettings { fence_radius, fence_height, .. } = self.settings;
        self.policy.begin(corners(&self.fence.home(), fence_radius, fence_height), &goal, heading)?;
        self.mission = self.mission.paused();
        self.flies_policy = true;
        Ok(())
    }

    /// Flies on without the policy, if it flies: the governor starts where the vehicle is.
    pub(super) fn end_policy(&mut self, estimate: &Estimate) {
        if mem::take(&mut self.flies_policy)
            && let (Ok(chain), Some(estimated)) = (&mut self.chain, &estimate.state)
        {
            // Out of its range it goes on from where it was.
            let _ = chain.take_up(&estimated.state);
        }
    }
}

/// The place that a setpoint names, if it does.
pub(super) fn place(setpoint: &Setpoint) -> Option<Vector3<f32>> {
    match setpoint.motion {
        Motion::Position(position) | Motion::PositionVelocityAcceleration { position, .. } => Some(position),
        _ => None,
    }
}
