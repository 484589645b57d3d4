//! Which requests are granted.

use super::policies::place;
use super::{Pilot, hold};
use crate::bench::Bench;
use crate::chain::Chain;
use crate::detectors::Detected;
use crate::estimate::Estimate;
use crate::exchange::{Battery, Inputs};
use crate::permission::{self, Start, require};
use crate::policy::Aboard;
use crate::refusal::Refusal;
use crate::request::Request;
use crate::rules::{GROUND_STATION_TIMEOUT_US, Mode, SETPOINTS_REQUEST_MAX_US};
use controller_core::allocation::geometry::ROTORS_MIN;
use controller_core::governor::Setpoint;

impl<'m, P: Aboard> Pilot<'m, P> {
    /// Everything that arming needs.
    pub(super) fn may_arm(&self, inputs: &Inputs, estimate: &Estimate) -> Result<Start, Refusal> {
        self.chain.as_ref().map_err(|grounded| Refusal::Grounded(*grounded))?;
        require(!inputs.killed, Refusal::Killed)?;
        require(!inputs.is_busy, Refusal::Busy)?;
        inputs.lost.map_or(Ok(()), |stored| Err(Refusal::Lost(stored)))?;
        require(!inputs.is_clock_doubtful, Refusal::ClockDoubtful)?;
        require(!inputs.motors_fail, Refusal::MotorsFail)?;
        require(!self.has_lost_a_rotor(), Refusal::RotorLost)?;
        self.rotor_check.grounding(inputs.now).map_or(Ok(()), |fault| Err(Refusal::Rotor(fault)))?;
        require(!matches!(inputs.battery, Battery::Low | Battery::Critical), Refusal::BatteryLow)?;
        require(inputs.battery != Battery::Missing, Refusal::BatteryMissing)?;
        // A failed accelerometer repeats its last value, which looks like rest.
        inputs.imu_fault.map_or(Ok(()), |fault| Err(Refusal::Imu(fault)))?;
        permission::to_arm(estimate, self.is_silent(inputs, GROUND_STATION_TIMEOUT_US))
    }

    /// Readies the chain for a flight from here.
    pub(super) fn prepare_start(&mut self, inputs: &Inputs, estimate: &Estimate) -> Result<(), Refusal> {
        let start = self.may_arm(inputs, estimate)?;
        let chain = self.chain.as_mut().map_err(|grounded| Refusal::Grounded(*grounded))?;
        chain.start(&start.position, &start.heading).map_err(|error| Refusal::Reference(error.field()))
    }

    /// Ends a request for flight by setpoints: at any other request but arming, when the motors are stopped, or on the
    /// ground after a timeout.
    pub(super) fn expire_setpoints_request(&mut self, inputs: &Inputs) {
        let goes_on = matches!(inputs.request, None | Some(Request::Arm | Request::FlySetpoints));
        let stops = inputs.disarm || inputs.killed;
        let since = self.setpoints_requested_since.filter(|_| goes_on && !stops);
        let is_recent = |since: &u64| inputs.now.saturating_sub(*since) < SETPOINTS_REQUEST_MAX_US;
        self.setpoints_requested_since = since.filter(|since| self.mode.is_armed() || is_recent(since));
    }

    /// Whether a request is granted. Granting one readies the chain for it.
    pub(super) fn answer(
        &mut self,
        request: Request,
        inputs: &Inputs,
        estimate: &Estimate,
        detected: &Detected,
    ) -> Result<(), Refusal> {
        // Requests in the tick of a disarm command came before it.
        require(!inputs.disarm, Refusal::DisarmCommanded)?;
        match request {
            // It is so already: a client whose answer was lost repeats its request.
            Request::Arm if self.mode.is_armed() => require(!inputs.killed, Refusal::Killed),
            Request::Arm => {
                permission::to_turn_motors(self.mode)?;
                self.prepare_start(inputs, estimate)
            }
            Request::Disarm => require(!self.is_airborne(), Refusal::InTheAir),
            Request::MotorTest(test) => self.begin_on_the_bench(Bench::Turning(test), inputs),
            Request::EndMotorTest => require(!self.mode.is_armed(), Refusal::AlreadyArmed),
            Request::MotorSetting(setting) => self.begin_on_the_bench(Bench::Setting(setting), inputs),
            Request::TakeOff(height) => self.take_off(height, inputs, estimate),
            Request::FlySetpoints => {
                permission::to_fly_setpoints(self.mode)?;
                if self.mode.is_guided() {
                    self.has_setpoint(inputs.now)?;
                }
                self.end_policy(estimate);
                self.end_mission(inputs.now);
                self.setpoints_requested_since = Some(inputs.now);
                Ok(())
            }
            Request::FlyPolicy => self.start_policy(inputs.now),
            Request::FlyMission(from) => self.start_mission(from, inputs, estimate),
            Request::SetMissionItem(item) => self.set_mission_item(item, inputs),
            Request::Hold => {
                permission::to_hold(self.mode, self.must_land(detected, estimate) || self.has_lost_a_rotor())?;
                self.end_policy(estimate);
                let chain = self.chain.as_mut().map_err(|grounded| Refusal::Grounded(*grounded))?;
                hold(chain, &self.fence, estimate);
                Ok(())
            }
            Request::GoTo(setpoint) => {
                permission::to_hold(self.mode, self.must_land(detected, estimate))?;
                require(self.is_airborne(), Refusal::NotInTheAir)?;
                self.check(&setpoint)?;
                self.end_policy(estimate);
                self.accept(&setpoint, 0.0)?;
                // Without a rotor it lands there.
                self.lands_elsewhere = self.has_lost_a_rotor();
                Ok(())
            }
            Request::Land => {
                let has_landed = matches!(self.mode, Mode::Checks | Mode::Ready);
                let may = has_landed || self.mode.is_armed();
                // If poses are lost in this tick, it is remembered.
                self.must_still_land = self.mode.flies();
                require(may, Refusal::NotInTheAir)
            }
        }
    }

    fn begin_on_the_bench(&mut self, bench: Bench, inputs: &Inputs) -> Result<(), Refusal> {
        let elapsed = inputs.now.saturating_sub(self.since);
        let permission = permission::to_turn_motors(self.mode);
        require(!inputs.killed, Refusal::Killed)?;
        require(!inputs.is_busy, Refusal::Busy)?;
        bench.check(self.chain.as_ref().map_or(ROTORS_MIN, Chain::rotors))?;
        match bench {
            Bench::Turning(test) if self.mode == Mode::MotorTest && self.bench.renew(&test, elapsed) => Ok(()),
            _ => permission.map(|()| self.bench = bench),
        }
    }

    pub(super) fn take_off(
        &mut self,
        height: Option<f32>,
        inputs: &Inputs,
        estimate: &Estimate,
    ) -> Result<(), Refusal> {
        let height = height.unwrap_or(self.settings.take_off_height);
        if self.mode == Mode::TakingOff && self.chain.as_ref().is_ok_and(|chain| chain.takes_off_to(height)) {
            return Ok(());
        }
        require((0.5..=50.0).contains(&height), Refusal::TakeOffHeight)?;
        permission::to_take_off(self.mode)?;
        require(height <= self.settings.fence_height, Refusal::OutsideFence)?;
        self.prepare_start(inputs, estimate)?;
        self.with_chain(|chain| chain.rise(height).map_err(Refusal::Setpoint))
    }

    pub(super) fn with_chain(
        &mut self,
        act: impl FnOnce(&mut Chain<'m>) -> Result<(), Refusal>,
    ) -> Result<(), Refusal> {
        self.chain.as_mut().map_err(|grounded| Refusal::Grounded(*grounded)).and_then(act)
    }

    /// Whether something makes the vehicle land, whatever requests come.
    pub(super) fn must_land(&self, detected: &Detected, estimate: &Estimate) -> bool {
        let Detected { battery_critical, tracking_lost, saturated, overrun, .. } = *detected;
        battery_critical || tracking_lost || saturated || overrun || self.is_outside(estimate)
    }

    pub(super) fn has_lost_a_rotor(&self) -> bool {
        self.chain.as_ref().is_ok_and(|chain| chain.lost().is_some())
    }

    pub(super) fn is_outside(&self, estimate: &Estimate) -> bool {
        let state = estimate.state.as_ref();
        self.mode.is_guided() && state.is_some_and(|estimated| !self.fence.contains(&estimated.state.position))
    }

    pub(super) fn accept(&mut self, setpoint: &Setpoint, late: f32) -> Result<(), Refusal> {
        self.check(setpoint)?;
        self.with_chain(|chain| chain.accept(setpoint, late).map_err(Refusal::Setpoint))
    }

    /// Whether a setpoint may be flown.
    #[inline(never)] // or its three callers would each get a copy
    pub(super) fn check(&self, setpoint: &Setpoint) -> Result<(), Refusal> {
        // First, because a position that is not finite is outside of any fence.
        setpoint.check().map_err(|error| Refusal::Setpoint(error.field()))?;
        require(self.fence.allows(setpoint), Refusal::OutsideFence)
    }

    /// Remembers a setpoint, or why it is refused: that one does not keep a stream alive. The fence is placed by
    /// arming, so it is not checked before.
    pub(super) fn keep_setpoint(&mut self, inputs: &Inputs) {
        let Some(setpoint) = &inputs.setpoint else { return };
        match self.check(setpoint) {
            Err(refusal) if self.mode.is_armed() || refusal != Refusal::OutsideFence => {
                self.newest.refuse(refusal, inputs.now);
            }
            _ => self.newest.keep(setpoint, inputs.now),
        }
    }

    /// Gives the governor a setpoint where setpoints are flown; where a requested flight waits for one, why it does not
    /// begin.
    pub(super) fn fly_setpoint(&mut self, inputs: &Inputs, estimate: &Estimate) -> Option<Result<(), Refusal>> {
        let setpoint = inputs.setpoint?;
        match self.mode {
            Mode::Flying if self.mission.is_flown => None,
            Mode::Flying if self.flies_policy => Some(self.check(&setpoint).map(|()| {
                if let Some(goal) = place(&setpoint) {
                    self.policy.go_to(&goal);
                }
            })),
            Mode::Flying => Some(self.accept(&setpoint, inputs.setpoint_late)),
            Mode::Idling if self.setpoints_requested_since.is_some() => {
                let may_begin = self.check(&setpoint).and_then(|()| self.may_arm(inputs, estimate).map(|_| ()));
                may_begin.err().map(Err)
            }
            _ => None,
        }
    }

    /// Whether there is a setpoint to be flown now, and why not.
    pub(super) fn has_setpoint(&self, now: u64) -> Result<(), Refusal> {
        let setpoint = self.newest.fresh(now).ok_or_else(|| self.newest.refused(now))?;
        require(self.fence.allows(setpoint), Refusal::OutsideFence)
    }
}
