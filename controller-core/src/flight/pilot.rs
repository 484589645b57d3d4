//! The pilot: flight rules, governor, law and allocation in one synchronous tick that cannot fail.
//!
//! In a tick, in this order: the estimator takes what was measured; a jump of the estimate is followed; the flight is looked at; a
//! request is answered; the rules' conditions are worked out and the table decides; a new mode is entered; a setpoint is
//! taken; and the mode's output is worked out.

use super::chain::{Chain, Flown, Memory};
use super::estimate::{Estimate, Estimation};
use super::exchange::{Battery, Inputs, Outcome, Output, PERIOD};
use super::fence::Fence;
use super::permission::{self, MotorTest, Start, require};
use super::reason::{Grounded, Reason, Refusal, field};
use super::request::Newest;
use super::request::Request;
use super::rules::{
    self, Condition, Conditions, DESCENDING_MAX, GROUND_STATION_SILENCE_MAX, IDLING_MAX, LEVELLING_MAX,
};
use super::rules::{Mode, Transition};
use super::settings::FlightSettings;
use super::thrust_check::ThrustCheck;
use super::watch::{Seen, Watch};
use crate::allocation::geometry::ROTORS_MIN;
use crate::certificate::certified::{Certified, Refused};
use crate::error::InputError;
use crate::estimator::{Estimator, Fault};
use crate::governor::{GovernorLimits, Setpoint};
use crate::measurement::is_fresh;
use nalgebra::Vector3;

/// How near the height of its take-off the reference has to be, m, and how slow, m/s.
const TAKEN_OFF: (f32, f32) = (0.01, 0.01);

/// Everything that decides what the motors do. Size: about 3 KB, and its [`Memory`] and [`Estimator`].
#[derive(Debug, PartialEq)]
pub struct Pilot<'m> {
    chain: Result<Chain<'m>, Grounded>,
    settings: FlightSettings,
    mode: Mode,
    /// When the mode was entered, us.
    since: u64,
    estimation: Estimation<'m>,
    watch: Watch,
    fence: Fence,
    /// Where the vehicle was at the last tick, m, world.
    last_position: Vector3<f32>,
    /// Whether poses were still refused when the vehicle had levelled: they lie, and what they agree on later is no better.
    poses_lie: bool,
    test: MotorTest,
    /// The height of the take-off, m, world.
    rising_to: f32,
    /// The newest setpoint, and whether somebody wants setpoints flown.
    newest: Newest,
    wants_setpoints: bool,
    thrust_check: ThrustCheck,
}

impl<'m> Pilot<'m> {
    /// A pilot at boot for what the certificate said about a configuration, to tick every [`PERIOD`]; configuration time. It flies
    /// on what `estimator` makes of the measurements; its governor and mixer lie in `memory`.
    ///
    /// Without a certified configuration, or with one it cannot fly, it is grounded: it answers and tests motors, but never
    /// arms, and says why.
    #[must_use]
    pub fn new(
        certification: Result<&Certified, &Refused>,
        limits: &GovernorLimits,
        settings: &FlightSettings,
        estimator: &'m mut Estimator,
        memory: &'m mut Memory,
    ) -> Self {
        let settings = settings.within_range();
        Self {
            chain: match certification {
                Ok(certified) => Chain::new(certified, limits, PERIOD as f32 * 1e-6, memory),
                Err(refused) => Err(Grounded::from(refused)),
            },
            settings,
            mode: Mode::Boot,
            since: 0,
            estimation: Estimation::new(estimator),
            watch: Watch::default(),
            fence: Fence::new(&settings),
            last_position: Vector3::zeros(),
            poses_lie: false,
            test: MotorTest::NONE,
            rising_to: 0.0,
            newest: Newest::default(),
            wants_setpoints: false,
            thrust_check: ThrustCheck::default(),
        }
    }

    /// The mode after the last tick.
    #[must_use]
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Why it can never arm, if so.
    #[must_use]
    pub fn grounded(&self) -> Option<Grounded> {
        self.chain.as_ref().err().copied()
    }

    /// One tick: what has arrived since the last, in; what the motors do until the next, out.
    pub fn tick(&mut self, inputs: &Inputs) -> Outcome {
        let estimate = self.estimation.tick(inputs.increments, inputs.poses, self.mode.is_armed(), inputs.now);
        self.decide(inputs, &estimate)
    }

    /// The tick on an estimate.
    fn decide(&mut self, inputs: &Inputs, estimate: &Estimate) -> Outcome {
        let followed = self.follow(estimate);
        let seen = self.look(inputs, estimate);
        if let Some(setpoint) = &inputs.setpoint {
            self.newest.keep(setpoint, inputs.now);
        }
        let answer = inputs.request.map(|request| self.answer(request, inputs, estimate, &seen));
        let ready = self.mode.may_arm().then(|| self.may_arm(inputs, estimate).map(|_| ()));
        let conditions = self.requested(inputs, estimate, answer);
        let conditions = self.happened(conditions, inputs, estimate, &seen);
        let conditions = conditions
            .with(Condition::EstimateLost, estimate.is_lost() || !followed)
            .with(Condition::ChecksPass, ready == Some(Ok(())))
            .with(Condition::ChecksFail, ready != Some(Ok(())));
        let transition = rules::transition(self.mode, conditions);
        if let Some(transition) = transition {
            self.enter(&transition, inputs, estimate);
        }
        let setpoint = inputs.setpoint.filter(|_| self.mode == Mode::Flying).map(|setpoint| self.accept(&setpoint));
        let (output, flown) = self.output(estimate, inputs.now);
        let scale = flown.as_ref().and_then(|flown| flown.as_ref().ok()).map(|flown| flown.thrust_scale);
        Outcome {
            output,
            mode: self.mode,
            transition,
            answer,
            ready,
            home: self.home(estimate),
            is_airborne: self.is_airborne(),
            setpoint,
            estimated: estimate.state,
            health: estimate.health,
            pose: estimate.pose,
            flown,
            is_thrust_doubtful: self.thrust_check.is_doubtful(scale, inputs.now),
        }
    }

    /// Goes along where the estimate has jumped in flight; whether that was possible.
    fn follow(&mut self, estimate: &Estimate) -> bool {
        let Some(estimated) = &estimate.state else { return true };
        let position = estimated.state.position;
        let from = core::mem::replace(&mut self.last_position, position);
        match &mut self.chain {
            Ok(chain) if estimate.jumped && self.mode.flies() => {
                self.fence.displace(&from, &position);
                chain.jump(&estimated.state).is_ok()
            }
            _ => true,
        }
    }

    fn look(&mut self, inputs: &Inputs, estimate: &Estimate) -> Seen {
        if !self.mode.is_armed() {
            self.watch = Watch::default();
        }
        let chain = self.chain.as_ref().ok();
        self.watch.tick(self.mode, estimate.state.as_ref(), chain, self.settings.tracking_error_max, inputs)
    }

    fn is_airborne(&self) -> bool {
        self.mode.flies() && self.chain.as_ref().is_ok_and(|chain| !chain.is_standing())
    }

    fn home(&self, estimate: &Estimate) -> Option<Vector3<f32>> {
        match self.mode {
            mode if mode.is_armed() => Some(self.fence.home()),
            _ => estimate.state.as_ref().map(|estimated| estimated.state.position),
        }
    }

    /// Everything that arming needs.
    fn may_arm(&self, inputs: &Inputs, estimate: &Estimate) -> Result<Start, Refusal> {
        self.chain.as_ref().map_err(|grounded| Refusal::Grounded(*grounded))?;
        require(!inputs.killed, Refusal::Killed)?;
        require(!matches!(inputs.battery, Battery::Low | Battery::Critical), Refusal::BatteryLow)?;
        permission::to_arm(estimate, self.is_silent(inputs, GROUND_STATION_SILENCE_MAX))
    }

    /// Readies the chain for a flight from here.
    fn begin(&mut self, inputs: &Inputs, estimate: &Estimate) -> Result<(), Refusal> {
        let start = self.may_arm(inputs, estimate)?;
        let chain = self.chain.as_mut().map_err(|grounded| Refusal::Grounded(*grounded))?;
        chain.start(&start.position, &start.heading).map_err(|error| Refusal::Reference(field(error)))
    }

    /// Whether a request is granted. Granting one readies the chain for it.
    fn answer(&mut self, request: Request, inputs: &Inputs, estimate: &Estimate, seen: &Seen) -> Result<(), Refusal> {
        // Whatever is asked for in the tick of a disarm command came before it.
        require(!inputs.disarm, Refusal::DisarmCommanded)?;
        match request {
            Request::Arm => {
                permission::to_turn_motors(self.mode)?;
                self.begin(inputs, estimate)
            }
            Request::Disarm => require(!self.is_airborne(), Refusal::InTheAir),
            Request::MotorTest(test) => {
                permission::to_turn_motors(self.mode)?;
                require(!inputs.killed, Refusal::Killed)?;
                permission::to_test(&test, self.chain.as_ref().map_or(ROTORS_MIN, Chain::rotors))?;
                self.test = test;
                Ok(())
            }
            Request::TakeOff(height) => self.take_off(height, inputs, estimate),
            Request::FlySetpoints => {
                let may = self.mode.may_arm() || self.mode == Mode::Idling || self.mode.is_guided();
                require(may && self.mode != Mode::Landing, Refusal::NotInTheAir)?;
                require(!self.mode.is_guided() || self.newest.fresh(inputs.now).is_some(), Refusal::NoSetpoints)?;
                self.wants_setpoints = true;
                Ok(())
            }
            Request::Hold => {
                permission::to_hold(self.mode, self.must_land(seen, estimate))?;
                self.with_chain(|chain| {
                    chain.hold();
                    Ok(())
                })
            }
            Request::GoTo(setpoint) => {
                permission::to_hold(self.mode, self.must_land(seen, estimate))?;
                self.accept(&setpoint)
            }
            Request::Land => {
                let may = self.mode == Mode::Idling || self.mode.flies();
                require(may, Refusal::NotInTheAir)
            }
        }
    }

    fn take_off(&mut self, height: Option<f32>, inputs: &Inputs, estimate: &Estimate) -> Result<(), Refusal> {
        require(self.mode == Mode::Idling, Refusal::NotIdling)?;
        let height = height.unwrap_or(self.settings.take_off_height);
        require((0.5..=50.0).contains(&height), Refusal::TakeOffHeight)?;
        require(height <= self.settings.fence_height, Refusal::OutsideFence)?;
        self.begin(inputs, estimate)?;
        self.with_chain(|chain| chain.rise(height).map_err(Refusal::Setpoint))?;
        self.rising_to = height + self.chain.as_ref().map_or(0.0, |chain| chain.reference().position.z);
        Ok(())
    }

    fn with_chain(&mut self, act: impl FnOnce(&mut Chain<'m>) -> Result<(), Refusal>) -> Result<(), Refusal> {
        self.chain.as_mut().map_err(|grounded| Refusal::Grounded(*grounded)).and_then(act)
    }

    /// Whether what makes a vehicle land, whoever would like to fly on, is so.
    fn must_land(&self, seen: &Seen, estimate: &Estimate) -> bool {
        let Seen { battery_critical, tracking_lost, saturated, overrun, .. } = *seen;
        battery_critical || tracking_lost || saturated || overrun || self.is_outside(estimate)
    }

    fn is_outside(&self, estimate: &Estimate) -> bool {
        let state = estimate.state.as_ref();
        self.mode.is_guided() && state.is_some_and(|estimated| !self.fence.contains(&estimated.state.position))
    }

    /// What was asked for and granted.
    fn requested(&mut self, inputs: &Inputs, estimate: &Estimate, answer: Option<Result<(), Refusal>>) -> Conditions {
        let granted = inputs.request.filter(|_| answer == Some(Ok(())));
        let is = |wanted: fn(&Request) -> bool| granted.as_ref().is_some_and(wanted);
        let fresh = self.wants_setpoints && self.newest.fresh(inputs.now).is_some();
        let setpoints = fresh && (self.mode != Mode::Idling || self.begin(inputs, estimate).is_ok());
        Conditions::NONE
            .with(Condition::Disarmed, inputs.disarm || is(|request| *request == Request::Disarm))
            .with(Condition::Killed, inputs.killed)
            .with(Condition::ArmingPermitted, is(|request| *request == Request::Arm))
            .with(Condition::MotorTestPermitted, is(|request| matches!(request, Request::MotorTest(_))))
            .with(Condition::Requested, inputs.request.is_some())
            .with(Condition::TakeOffRequested, is(|request| matches!(request, Request::TakeOff(_))))
            .with(Condition::HoldRequested, is(|request| matches!(request, Request::Hold | Request::GoTo(_))))
            .with(Condition::LandRequested, is(|request| *request == Request::Land))
            .with(Condition::SetpointsRequested, setpoints)
    }

    /// What happened besides.
    fn happened(&mut self, conditions: Conditions, inputs: &Inputs, estimate: &Estimate, seen: &Seen) -> Conditions {
        let elapsed = inputs.now.saturating_sub(self.since);
        if elapsed < LEVELLING_MAX {
            self.poses_lie = matches!(estimate.health.last, Some(Err(_)));
        }
        let may = estimate.is_found() && (elapsed < LEVELLING_MAX || !self.poses_lie);
        let regained = match (self.mode, &mut self.chain, &estimate.state) {
            (Mode::Descending, Ok(chain), Some(estimated)) if may => chain.regain(&estimated.state).is_ok(),
            _ => false,
        };
        let patience = (self.settings.ground_station_patience * 1e6) as u64;
        conditions
            .with(Condition::Started, estimate.state.is_some() || !estimate.health.faults.contain(Fault::ImuStale))
            .with(Condition::Uncertified, self.chain.is_err())
            .with(Condition::MotorTestOver, elapsed >= self.test.duration)
            .with(Condition::IdlingOver, elapsed >= IDLING_MAX)
            .with(Condition::TakenOff, self.has_taken_off())
            .with(Condition::Landed, seen.landed)
            .with(Condition::Crashed, seen.crashed)
            .with(Condition::ImuStale, estimate.state.is_none())
            .with(Condition::ThrustsRefused, self.chain.as_ref().is_ok_and(Chain::is_refused))
            .with(Condition::ImuDoubtful, seen.imu_doubtful)
            .with(Condition::PoseRegained, regained)
            .with(Condition::DescendingOver, elapsed >= DESCENDING_MAX)
            .with(Condition::GroundStationSilent, self.is_silent(inputs, GROUND_STATION_SILENCE_MAX))
            .with(Condition::GroundStationGone, self.is_silent(inputs, patience))
            .with(Condition::SetpointsLost, self.newest.has_ended(inputs.now))
            .with(Condition::BatteryLow, seen.battery_low)
            .with(Condition::BatteryCritical, seen.battery_critical)
            .with(Condition::FenceBreached, self.is_outside(estimate))
            .with(Condition::TrackingLost, seen.tracking_lost)
            .with(Condition::Saturated, seen.saturated)
            .with(Condition::Overrun, seen.overrun)
    }

    fn has_taken_off(&self) -> bool {
        let (near, slow) = TAKEN_OFF;
        self.chain.as_ref().is_ok_and(|chain| {
            let reference = chain.reference();
            (reference.position.z - self.rising_to).abs() < near && reference.velocity.norm_squared() < slow * slow
        })
    }

    /// Does what entering a mode takes. What a request and finding the pose again take is done where they are found possible.
    fn enter(&mut self, transition: &Transition, inputs: &Inputs, estimate: &Estimate) {
        (self.mode, self.since) = (transition.to, inputs.now);
        if transition.from.is_armed() && transition.to != Mode::Flying {
            self.wants_setpoints = false;
        }
        if transition.reason == Reason::BatteryLow {
            self.watch.tell_low();
        }
        let Ok(chain) = &mut self.chain else { return };
        match (transition.to, transition.reason) {
            (Mode::Idling, _) => self.fence.place(&chain.reference().position),
            (Mode::Flying, _) => {
                if let Some(setpoint) = self.newest.fresh(inputs.now).filter(|setpoint| self.fence.allows(setpoint)) {
                    // One that is refused leaves the vehicle where it is.
                    let _ = chain.accept(setpoint);
                }
            }
            // A request has said already what the reference does.
            (Mode::Holding, Reason::HoldCommanded | Reason::PoseRegained) => {}
            (Mode::Holding, _) => chain.hold(),
            (Mode::Descending, _) => {
                let certain = !estimate.health.faults.contain(Fault::Uncertain);
                let known = estimate.state.filter(|_| certain).map(|estimated| estimated.state.velocity.z);
                chain.level(known.unwrap_or(0.0));
            }
            _ => {}
        }
    }

    fn accept(&mut self, setpoint: &Setpoint) -> Result<(), Refusal> {
        require(self.fence.allows(setpoint), Refusal::OutsideFence)?;
        self.with_chain(|chain| chain.accept(setpoint).map_err(Refusal::Setpoint))
    }

    /// What the mode does in this tick.
    fn output(&mut self, estimate: &Estimate, now: u64) -> (Output, Option<Result<Flown, InputError>>) {
        match self.mode {
            Mode::MotorTest => return (Output::Test { rotor: self.test.rotor, level: self.test.level }, None),
            Mode::Idling => return (Output::Idle, None),
            _ => {}
        }
        // Every mode that flies has both, by the rules.
        let (true, Ok(chain), Some(estimated)) = (self.mode.flies(), &mut self.chain, &estimate.state) else {
            return (Output::Stop, None);
        };
        let flown = if self.mode == Mode::Descending {
            chain.fly_level(estimated, now.saturating_sub(self.since) >= LEVELLING_MAX)
        } else {
            if self.mode == Mode::Landing {
                chain.sink(self.settings.landing_speed);
            }
            chain.fly(&estimated.state)
        };
        let output = chain.thrusts().map_or(Output::Stop, |thrusts| Output::Thrusts(thrusts.clone()));
        (output, Some(flown))
    }

    /// Whether the ground station has been silent for so long, us.
    fn is_silent(&self, inputs: &Inputs, patience: u64) -> bool {
        !inputs.ground_station.is_some_and(|heard| is_fresh(heard, patience.saturating_sub(1), inputs.now))
    }
}

#[cfg(test)]
mod tests;
