//! Flying a mission, item by item.

use super::{Pilot, hold};
use crate::estimate::Estimate;
use crate::exchange::Inputs;
use crate::mission::{Leg, MissionItem, MissionRefusal, MissionStep, Progress};
use crate::permission::{self, require};
use crate::policy::Aboard;
use crate::refusal::Refusal;
use crate::request::Request;
use crate::rules::Mode;
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use nalgebra::Vector3;

impl<P: Aboard> Pilot<'_, P> {
    /// The number of the mission's item that the next tick needs, if that brings this request.
    #[must_use]
    pub fn mission_item(&self, request: Option<&Request>) -> Option<u8> {
        match request {
            Some(Request::FlyMission(Some(item)) | Request::SetMissionItem(item)) => Some(*item),
            Some(Request::FlyMission(None)) => Some(self.mission.next),
            _ => self.mission.is_flown.then_some(self.mission.next),
        }
    }

    /// Begins at an item, or goes on. From the ground, and in a take-off, a vehicle rises to the first item's height.
    pub(super) fn start_mission(
        &mut self,
        from: Option<u8>,
        inputs: &Inputs,
        estimate: &Estimate,
    ) -> Result<(), Refusal> {
        permission::to_fly_mission(self.mode)?;
        let item = inputs.mission_item.ok_or(Refusal::Mission(MissionRefusal::NoItem))?;
        item.check(&self.fence.home(), &self.settings).map_err(Refusal::Mission)?;
        if self.mode == Mode::Idling {
            require(!item.lands(), Refusal::NotInTheAir)?;
            self.prepare_start(inputs, estimate)?;
        }
        let rises = matches!(self.mode, Mode::Idling | Mode::TakingOff) && item.leg == Leg::Waypoint;
        // One that is flown goes on as it is.
        self.end_policy(estimate);
        if from.is_some() || !self.mission.is_flown {
            self.mission = Progress { is_flown: true, rises, ..self.mission.at(from.unwrap_or(self.mission.next)) };
        }
        Ok(())
    }

    /// Makes an item the next one, flown or not, the first even without a mission. It is checked when it is flown.
    pub(super) fn set_mission_item(&mut self, item: u8, inputs: &Inputs) -> Result<(), Refusal> {
        require(item == 0 || inputs.mission_item.is_some(), Refusal::Mission(MissionRefusal::NoItem))?;
        self.mission = self.mission.at(item);
        Ok(())
    }

    /// Whether it flies a mission's items, and not setpoints.
    pub(super) fn flies_mission(&self) -> bool {
        self.mode == Mode::Flying && self.mission.is_flown
    }

    /// Setpoints are flown in its place: from the newest on.
    pub(super) fn end_mission(&mut self, now: u64) {
        if self.flies_mission()
            && let (Ok(chain), Some(setpoint)) = (&mut self.chain, self.newest.fresh(now))
        {
            // It was checked when it came.
            let _ = chain.accept(setpoint, 0.0);
        }
        self.mission = self.mission.paused();
    }

    /// One tick of a mission, before the rules: its end is a request of its own.
    pub(super) fn fly_mission(&mut self, inputs: &Inputs, estimate: &Estimate) -> Option<MissionStep> {
        if !self.flies_mission() || matches!(inputs.request, Some(Request::SetMissionItem(_))) {
            return None;
        }
        let next = self.mission.next;
        let Some(item) = inputs.mission_item else {
            // The governor keeps the last item's place. A mission that is over begins again.
            self.mission = Progress::default();
            return Some(MissionStep::Over);
        };
        if estimate.jumped_from.is_some() {
            self.mission.target = None;
        }
        let target = match self.mission.target {
            Some(target) => target,
            None => match self.aim(&item) {
                Ok(target) => target,
                Err(refusal) => {
                    self.mission = self.mission.paused();
                    // Without a chain nothing flies.
                    if let Ok(chain) = &mut self.chain {
                        hold(chain, &self.fence, estimate);
                    }
                    return Some(MissionStep::Refused(next, refusal));
                }
            },
        };
        let reference = self.chain.as_ref().ok()?.reference();
        let (away, speed) = ((reference.position - target).norm(), reference.velocity.norm());
        if !item.is_reached(away, speed, self.mission.rises) {
            return None;
        }
        if self.mission.rises {
            self.mission = self.mission.at(next);
            return None;
        }
        let since = *self.mission.since.get_or_insert(inputs.now);
        if inputs.now.saturating_sub(since) < item.hold {
            return None;
        }
        self.mission = self.mission.at(next.saturating_add(1));
        if !item.lands() {
            return Some(MissionStep::Reached(next));
        }
        self.mission = Progress::default();
        // If poses are lost in this tick, it is remembered.
        self.must_still_land = true;
        Some(MissionStep::Lands(next))
    }

    /// Gives the governor an item's place; where that is.
    fn aim(&mut self, item: &MissionItem) -> Result<Vector3<f32>, MissionRefusal> {
        let home = self.fence.home();
        item.check(&home, &self.settings)?;
        let rises = self.mission.rises;
        let turn = if rises { HeadingSetpoint::Keep } else { item.turn };
        let aimed = self.chain.as_mut().map_err(|_| MissionRefusal::NoItem).and_then(|chain| {
            let target = item.target(&chain.reference().position, &home, rises);
            let setpoint = Setpoint { motion: Motion::Position(target), turn };
            chain.accept(&setpoint, 0.0).map(|()| target).map_err(|_| MissionRefusal::Number)
        })?;
        self.mission.target = Some(aimed);
        Ok(aimed)
    }
}
