//! The conditions of the rules, evaluated in a tick.

use super::Pilot;
use crate::chain::Chain;
use crate::detectors::Detected;
use crate::estimate::Estimate;
use crate::exchange::Inputs;
use crate::mission::MissionStep;
use crate::policy::Aboard;
use crate::refusal::Refusal;
use crate::request::Request;
use crate::rules::{
    ARRIVING_MIN_US, Condition, Conditions, DESCENDING_MAX_US, GROUND_STATION_TIMEOUT_US, IDLING_MAX_US,
    LANDING_TIMEOUT_EXTRA_S, LANDING_TIMEOUT_FACTOR, LEVELLING_MAX_US, Mode,
};
use estimation::estimator::{EstimatedState, Fault};
use estimation::measurement::is_fresh;

impl<P: Aboard> Pilot<'_, P> {
    /// The conditions that a granted request fulfils, or a mission that ends.
    pub(super) fn conditions_from_request(
        &mut self,
        inputs: &Inputs,
        estimate: &Estimate,
        answer: Option<Result<(), Refusal>>,
        mission: Option<MissionStep>,
    ) -> Conditions {
        let granted = inputs.request.filter(|_| answer == Some(Ok(())));
        let is = |matches: fn(&Request) -> bool| granted.as_ref().is_some_and(matches);
        // A later request overrides a landing that could not go on.
        self.must_still_land &= granted.is_none_or(|request| request == Request::Land);
        let is_ready = self.setpoints_requested_since.is_some() && self.has_setpoint(inputs.now).is_ok();
        let setpoints = is_ready && (self.mode != Mode::Idling || self.prepare_start(inputs, estimate).is_ok());
        let holds = matches!(mission, Some(MissionStep::Over | MissionStep::Refused(..)));
        let lands = matches!(mission, Some(MissionStep::Lands(_)));
        // The motor turns on.
        let is_renewed = self.mode == Mode::MotorTest && is(|request| matches!(request, Request::MotorTest(_)));
        let begins = is(|request| matches!(request, Request::FlyMission(_) | Request::FlyPolicy));
        Conditions::NONE
            .with(Condition::Disarmed, inputs.disarm || is(|request| *request == Request::Disarm))
            .with(Condition::Killed, inputs.killed)
            .with(Condition::ArmingPermitted, is(|request| *request == Request::Arm))
            .with(
                Condition::MotorTestPermitted,
                is(|request| matches!(request, Request::MotorTest(_) | Request::MotorSetting(_))),
            )
            .with(Condition::Requested, inputs.request.is_some() && !is_renewed)
            .with(Condition::TakeOffRequested, is(|request| matches!(request, Request::TakeOff(_))))
            .with(Condition::HoldRequested, holds || is(|request| matches!(request, Request::Hold | Request::GoTo(_))))
            .with(Condition::LandRequested, lands || is(|request| *request == Request::Land))
            .with(Condition::SetpointsRequested, setpoints || begins)
    }

    /// The conditions that follow from the flight.
    pub(super) fn add_flight_conditions(
        &mut self,
        conditions: Conditions,
        inputs: &Inputs,
        estimate: &Estimate,
        detected: &Detected,
    ) -> Conditions {
        let elapsed = inputs.now.saturating_sub(self.since);
        let is_levelled = self.mode == Mode::Descending && elapsed >= LEVELLING_MAX_US;
        if let (Some(pose), false) = (estimate.pose, is_levelled) {
            self.trust.note(pose, inputs.now);
        }
        let believed = estimate.is_found() && !detected.touched && !self.trust.is_given_up();
        let may = believed
            && (elapsed < LEVELLING_MAX_US || !self.trust.lied_until(self.since.saturating_add(LEVELLING_MAX_US)));
        if let (true, Ok(chain), Some(EstimatedState { state, .. })) = (may, &self.chain, &estimate.state) {
            // A vehicle that cannot hold above the ground lands.
            self.must_still_land |= !chain.stops_within(state.position.z - self.fence.home().z, state);
        }
        let regained = match (self.mode, &mut self.chain, &estimate.state) {
            (Mode::Descending, Ok(chain), Some(estimated)) if may && self.trust.regain(self.must_still_land) => {
                chain.regain(&estimated.state, self.fence.home().z).is_ok()
            }
            _ => false,
        };
        let stands = self.chain.as_ref().is_ok_and(Chain::is_standing);
        let is_there = elapsed >= ARRIVING_MIN_US && self.chain.as_ref().is_ok_and(Chain::rests);
        let is_under_way = self.mode == Mode::Holding && self.lands_elsewhere && !is_there;
        let height = estimate.state.map_or(0.0, |estimated| estimated.state.position.z - self.fence.home().z);
        self.landing_from = self.landing_from.max(height.min(self.settings.fence_height));
        let landing_max =
            LANDING_TIMEOUT_EXTRA_S + LANDING_TIMEOUT_FACTOR * self.landing_from / self.settings.landing_speed;
        let timeout = (self.settings.ground_station_timeout * 1e6) as u64;
        conditions
            .with(Condition::Started, estimate.state.is_some() || !estimate.health.faults.contain(Fault::ImuStale))
            .with(Condition::Uncertified, self.chain.is_err())
            .with(Condition::MotorTestOver, self.bench.is_over(elapsed))
            .with(Condition::IdlingOver, elapsed >= IDLING_MAX_US)
            .with(Condition::HeldOnGround, stands && (self.mode == Mode::Holding || elapsed >= IDLING_MAX_US))
            .with(Condition::TakenOff, self.chain.as_ref().is_ok_and(Chain::has_risen))
            .with(Condition::Landed, detected.landed)
            .with(Condition::Crashed, detected.crashed)
            .with(Condition::ImuStale, estimate.state.is_none())
            .with(Condition::ThrustsRefused, self.chain.as_ref().is_ok_and(Chain::is_refused))
            .with(Condition::PosesGivenUp, self.trust.is_given_up())
            .with(Condition::LandingOver, elapsed as f32 * 1e-6 >= landing_max)
            .with(Condition::ImuDoubtful, detected.imu_doubtful)
            .with(Condition::PoseRegained, regained && !self.must_still_land)
            .with(Condition::PoseRegainedToLand, regained && self.must_still_land)
            .with(Condition::DescendingOver, elapsed >= DESCENDING_MAX_US)
            .with(Condition::GroundStationSilent, self.is_silent(inputs, GROUND_STATION_TIMEOUT_US))
            .with(Condition::GroundStationGone, self.is_silent(inputs, timeout))
            .with(
                Condition::SetpointsLost,
                !self.mission.is_flown && !self.flies_policy && self.newest.has_ended(inputs.now),
            )
            .with(Condition::BatteryLow, detected.battery_low)
            .with(Condition::BatteryCritical, detected.battery_critical)
            .with(Condition::FenceBreached, self.is_outside(estimate))
            .with(Condition::TrackingLost, detected.tracking_lost)
            .with(Condition::RotorLost, self.has_lost_a_rotor() && !is_under_way)
            .with(Condition::Saturated, detected.saturated)
            .with(Condition::Overrun, detected.overrun)
    }

    /// Whether the estimate can be flown, and the checks before arming pass.
    pub(super) fn add_check_conditions(
        &self,
        conditions: Conditions,
        estimate: &Estimate,
        followed: bool,
        ready: Option<Result<(), Refusal>>,
    ) -> Conditions {
        let is_ready = ready == Some(Ok(()));
        conditions
            .with(Condition::EstimateLost, estimate.is_lost() || !followed)
            .with(Condition::ChecksPass, is_ready)
            .with(Condition::ChecksFail, !is_ready)
    }

    /// Whether the ground station has been silent for so long, us.
    pub(super) fn is_silent(&self, inputs: &Inputs, timeout: u64) -> bool {
        !inputs.ground_station.is_some_and(|last| is_fresh(last, timeout.saturating_sub(1), inputs.now))
    }
}
