//! The pilot: flight rules, governor, law and allocation in one synchronous tick that cannot fail.
//!
//! `tick` holds the order; `answers` grants requests, `missions` flies a mission, `policies` lets a policy fly,
//! `conditions` evaluates the rules' inputs.

use super::bench::Bench;
use super::chain::{Chain, Flown, Memory};
use super::detectors::{Detected, Detectors};
use super::estimate::{Estimate, Estimation};
use super::exchange::{Inputs, Output};
use super::fall::Fall;
use super::fence::Fence;
use super::lean::Lean;
use super::mission::Progress;
use super::policy::{Aboard, Handover, NoPolicy};
use super::reason::Reason;
use super::refusal::Grounded;
use super::request::NewestSetpoint;
use super::rotor_check::{RotorCheck, RotorFindings, SPEEDS_STALE_AFTER_US, Turning};
use super::rules::{self, BRAKING_MAX_US, Conditions, IMU_AGE_MAX_US, LEVELLING_MAX_US, Mode, Transition};
use super::settings::FlightSettings;
use super::stream_check::StreamCheck;
use super::thrust_check::ThrustCheck;
use super::trust::Trust;
use controller_core::allocation::remaining::LostRotor;
use controller_core::certificate::certified::{Certified, Refused};
use controller_core::error::InputError;
use controller_core::governor::{FollowingReport, GovernorLimits};
use estimation::estimator::{Accepted, EstimatedState, Estimator, Fault};
use estimation::measurement::is_fresh;
use nalgebra::Vector3;

/// Everything that decides what the motors do. Size: about 6.3 KB, and its [`Memory`] and [`Estimator`].
#[derive(Debug, PartialEq)]
pub struct Pilot<'m, P = NoPolicy> {
    chain: Result<Chain<'m>, Grounded>,
    /// The time between ticks, us.
    period: u64,
    settings: FlightSettings,
    mode: Mode,
    /// When the mode was entered, us.
    since: u64,
    estimation: Estimation<'m>,
    detectors: Detectors,
    fall: Fall,
    fence: Fence,
    bench: Bench,
    /// The newest setpoint that may be flown, and since when flight by setpoints is requested, us.
    newest: NewestSetpoint,
    setpoints_requested_since: Option<u64>,
    mission: Progress,
    /// Whether a vehicle without a pose was landing, or was commanded to land: it lands once there is a pose.
    must_still_land: bool,
    /// Whether poses may still be believed in this flight.
    trust: Trust,
    /// How high above the place of arming a landing has been, m.
    landing_from: f32,
    thrust_check: ThrustCheck,
    rotor_check: RotorCheck,
    stream_check: StreamCheck,
    /// Whether a vehicle that has lost a rotor was told where to land.
    lands_elsewhere: bool,
    policy: P,
    /// Whether it is let fly.
    flies_policy: bool,
}

impl<'m> Pilot<'m> {
    /// [`Pilot::carrying`] no policy.
    #[must_use]
    pub fn new(
        certification: Result<&Certified, &Refused>,
        limits: &GovernorLimits,
        settings: &FlightSettings,
        period: u64,
        estimator: &'m mut Estimator,
        memory: &'m mut Memory,
    ) -> Self {
        Self::carrying(certification, limits, settings, period, estimator, memory, NoPolicy)
    }
}

impl<'m, P: Aboard> Pilot<'m, P> {
    /// A pilot at boot for the verdict of the certificate on a configuration, to tick every `period` us. It flies on
    /// the state of `estimator`; its governor and mixer lie in `memory`.
    ///
    /// Without a certified configuration, or with one it cannot fly, it is grounded: it answers and tests motors, but
    /// never arms, and reports why.
    #[must_use]
    pub fn carrying(
        certification: Result<&Certified, &Refused>,
        limits: &GovernorLimits,
        settings: &FlightSettings,
        period: u64,
        estimator: &'m mut Estimator,
        memory: &'m mut Memory,
        mut policy: P,
    ) -> Self {
        let settings = settings.within_range();
        if let Ok(certified) = certification {
            policy.fit(certified.configuration(), period as f32 * 1e-6);
        }
        Self {
            chain: match certification {
                Ok(certified) => Chain::new(certified, limits, period, memory),
                Err(refused) => Err(Grounded::from(refused)),
            },
            period,
            settings,
            mode: Mode::Boot,
            since: 0,
            estimation: Estimation::new(estimator),
            detectors: Detectors::new(period),
            fall: Fall::default(),
            fence: Fence::new(&settings),
            bench: Bench::NONE,
            newest: NewestSetpoint::default(),
            setpoints_requested_since: None,
            mission: Progress::default(),
            must_still_land: false,
            trust: Trust::default(),
            landing_from: 0.0,
            thrust_check: ThrustCheck::default(),
            rotor_check: RotorCheck::of(certification.ok().map(Certified::configuration), period),
            stream_check: StreamCheck::default(),
            lands_elsewhere: false,
            policy,
            flies_policy: false,
        }
    }

    /// Other settings from now on, while disarmed; an armed vehicle keeps those that it was armed with.
    pub fn use_settings(&mut self, settings: &FlightSettings) {
        if !self.mode.is_armed() {
            self.settings = settings.within_range();
            self.fence.resize(&self.settings);
        }
    }

    /// The time between ticks, us.
    #[must_use]
    pub fn period(&self) -> u64 {
        self.period
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

    /// Moves the reference along with a jump of the estimate; in flight, whether that was possible.
    fn follow_jump(&mut self, estimate: &Estimate) -> bool {
        match (&mut self.chain, &estimate.jumped_from, &estimate.state) {
            (Ok(chain), Some(before), Some(EstimatedState { state, .. })) if self.mode.is_armed() => {
                // A body that is found again has not moved with its frame.
                if !(self.mode.flies() && estimate.pose == Some(Ok(Accepted::Refound))) {
                    self.fence.displace(before, state);
                }
                !self.mode.flies() || chain.jump(before, state, self.mode).is_ok()
            }
            _ => true,
        }
    }

    /// What the detectors find: a touchdown, a crash, lost tracking, a low battery.
    fn detect(&mut self, inputs: &Inputs, estimate: &Estimate) -> Detected {
        if !self.mode.is_armed() {
            self.detectors = Detectors::new(self.period);
        }
        let chain = self.chain.as_ref().ok();
        let detected =
            self.detectors.tick(self.mode, estimate.state.as_ref(), chain, self.settings.tracking_error_max, inputs);
        if let (true, Ok(chain)) = (detected.touches, &mut self.chain) {
            chain.stop_sinking();
        }
        detected
    }

    /// Counts the evidence against the source of poses in this flight.
    fn judge_poses(&mut self, estimate: &Estimate, detected: &Detected, now: u64) {
        if detected.lied {
            self.trust.give_up();
        }
        if self.mode.flies() {
            self.trust.judge(estimate.pose, !estimate.health.faults.contain(Fault::GyroBias), now);
        } else if !self.mode.is_armed() {
            self.trust = Trust::default();
        }
    }

    /// What the rotors' speeds tell; the law gets them.
    fn check_rotors(&mut self, inputs: &Inputs) -> RotorFindings {
        let recent = inputs.rotor_speeds.filter(|speeds| speeds.age(inputs.now) < SPEEDS_STALE_AFTER_US);
        let speeds = recent.map(|speeds| speeds.value);
        let Ok(chain) = &mut self.chain else { return RotorFindings::default() };
        chain.take_speeds(speeds);
        let turning = match self.mode {
            Mode::Idling => Turning::Idling,
            // What is left of a rotor is learnt from the motion.
            mode if mode.flies() && chain.lost().is_none() => {
                chain.thrusts().map_or(Turning::No, |f| Turning::Flying(f))
            }
            _ => Turning::No,
        };
        self.rotor_check.tick(turning, speeds, inputs.now)
    }

    /// The rotors' thrust over the commanded thrust, where the law flew.
    fn delivered_share(&self, flown: &Option<Result<Flown, InputError>>) -> Option<f32> {
        match (&self.chain, flown) {
            (Ok(chain), Some(Ok(_))) => Some(chain.delivered_share()),
            _ => None,
        }
    }

    /// How a stream of setpoints is followed, where setpoints are flown.
    fn following(&self) -> Option<FollowingReport> {
        self.chain.as_ref().ok().filter(|_| self.mode == Mode::Flying).and_then(Chain::following)
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

    /// Prepares a mode that is entered. A request's preparation, and that of finding the pose again, is done where they
    /// are granted.
    fn enter(&mut self, transition: &Transition, inputs: &Inputs, estimate: &Estimate, touched: bool) {
        (self.mode, self.since) = (transition.to, inputs.now);
        if transition.from.is_armed() {
            self.setpoints_requested_since = None;
            // What was stopped begins anew.
            self.mission = if transition.to.is_armed() { self.mission } else { Progress::default() };
        }
        if transition.to != Mode::Flying {
            self.mission = self.mission.paused();
            self.end_policy(estimate);
        }
        self.must_still_land |= transition.from == Mode::Landing;
        self.must_still_land &= transition.to == Mode::Descending;
        if transition.reason == Reason::BatteryLow {
            self.detectors.latch_low();
        }
        if transition.reason == Reason::LandingOver {
            self.trust.give_up();
        }
        let lied = self.trust.has_lied();
        if transition.to == Mode::Descending && lied {
            self.estimation.distrust();
        }
        let Ok(chain) = &mut self.chain else { return };
        match (transition.to, transition.reason) {
            (Mode::Idling, _) => {
                self.fence.place(&chain.reference().position);
                // What is armed was at rest.
                self.fall = Fall::default();
            }
            (Mode::Flying, _) if self.mission.is_flown || self.flies_policy => {}
            (Mode::Flying, _) => {
                if let Some(setpoint) = self.newest.fresh(inputs.now).filter(|setpoint| self.fence.allows(setpoint)) {
                    // It was checked when it came.
                    let _ = chain.accept(setpoint, 0.0);
                }
            }
            // The request has set the reference already.
            (Mode::Holding, Reason::HoldCommanded | Reason::PoseRegained) => {}
            (Mode::Holding, _) => hold(chain, &self.fence, estimate),
            (Mode::Descending, _) => {
                let certain = !estimate.health.faults.contain(Fault::Uncertain);
                let known = estimate.state.filter(|_| certain).map(|estimated| estimated.state.velocity.z);
                let climbs = if lied { Some(self.estimation.climb()) } else { known };
                chain.level(if touched { Some(0.0) } else { climbs }, lied);
            }
            (Mode::Landing, _) => {
                self.landing_from = 0.0;
                if let Some(estimated) = &estimate.state {
                    chain.land(&estimated.state, self.settings.landing_speed);
                }
            }
            _ => {}
        }
    }

    /// The transition that the rules find, done.
    fn change_mode(
        &mut self,
        conditions: Conditions,
        inputs: &Inputs,
        estimate: &Estimate,
        detected: &Detected,
    ) -> Option<Transition> {
        let transition = rules::transition(self.mode, conditions);
        let was_airborne = self.is_airborne();
        if let Some(transition) = transition {
            self.enter(&transition, inputs, estimate, detected.touched);
        }
        let has_landed = transition.is_some_and(|transition| transition.reason == Reason::Landed);
        let is_stopped = was_airborne && !self.mode.flies() && !has_landed;
        self.fall.tick(is_stopped, estimate.state.as_ref(), inputs.now);
        transition
    }

    /// How a vehicle leans whose motors the law does not drive, by the accelerometer.
    fn lean(&self, inputs: &Inputs) -> Option<Lean> {
        let is_fresh = |time| is_fresh(time, IMU_AGE_MAX_US, inputs.now);
        let force = inputs.specific_force.filter(|force| is_fresh(force.time))?;
        let rate = inputs.body_rate.filter(|rate| is_fresh(rate.time))?;
        if self.mode.is_armed() || self.fall.may_fall() { None } else { Lean::felt(&force.value, &rate.value) }
    }

    /// What the mode does in this tick.
    fn output(&mut self, estimate: &Estimate, touched: bool, lost: Option<LostRotor>, now: u64) -> TickOutput {
        match self.mode {
            Mode::MotorTest => {
                return TickOutput::without(self.bench.output(now.saturating_sub(self.since), self.period));
            }
            Mode::Idling => return TickOutput::without(Output::Idle),
            _ => {}
        }
        // Every mode that flies has both, by the rules.
        let (true, Ok(chain), Some(estimated)) = (self.mode.flies(), &mut self.chain, &estimate.state) else {
            return TickOutput::without(Output::Stop);
        };
        chain.take_measured(estimate.felt, lost);
        let mut handover = None;
        let flown = if self.mode == Mode::Descending {
            // Poses that are given up do not come back.
            let descends = touched || self.trust.is_given_up() || now.saturating_sub(self.since) >= LEVELLING_MAX_US;
            chain.fly_level(estimated, descends)
        } else if P::EXISTS && self.flies_policy {
            chain.fly_policy(&mut self.policy, &estimated.state, &mut handover)
        } else {
            if self.mode == Mode::Landing {
                chain.descend(self.settings.landing_speed, now.saturating_sub(self.since) < BRAKING_MAX_US);
            }
            chain.fly(&estimated.state)
        };
        let output = chain.thrusts().map_or(Output::Stop, |thrusts| Output::Thrusts(thrusts.clone()));
        TickOutput { output, flown: Some(flown), handover }
    }
}

/// Brings the vehicle to rest where it is known, not below the place of arming.
fn hold(chain: &mut Chain, fence: &Fence, estimate: &Estimate) {
    if let Some(estimated) = &estimate.state {
        chain.hold(&estimated.state, fence.home().z);
    }
}

/// What a mode did in a tick.
struct TickOutput {
    output: Output,
    flown: Option<Result<Flown, InputError>>,
    handover: Option<Handover>,
}

impl TickOutput {
    /// Without the law.
    fn without(output: Output) -> Self {
        Self { output, flown: None, handover: None }
    }
}

mod answers;
mod conditions;
mod missions;
mod policies;
#[cfg(test)]
mod tests;
mod tick;
