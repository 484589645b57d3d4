//! The pilot: flight rules, governor, law and allocation in one synchronous tick that cannot fail.
//!
//! In a tick, in this order: the estimator takes what was measured; a jump of the estimate is followed; a request is answered; the
//! rules' conditions are worked out and the table decides; a new mode is entered; a setpoint is taken; and the mode's output
//! is worked out.

use super::chain::{Chain, Flown, Memory};
use super::estimate::{Estimate, Estimation};
use super::permission::{self, MotorTest};
use super::reason::{Grounded, Refusal, field};
use super::rules::{self, Condition, Conditions, GROUND_STATION_SILENCE_MAX, LEVELLING_MAX, Mode, Transition};
use super::thrust_check::ThrustCheck;
use super::{Inputs, Outcome, Output, PERIOD, Request};
use crate::allocation::geometry::ROTORS_MIN;
use crate::certificate::certified::{Certified, Refused};
use crate::error::InputError;
use crate::estimator::Estimator;
use crate::governor::{GovernorLimits, Setpoint};
use crate::measurement::is_fresh;

/// Everything that decides what the motors do. Size: about 2.5 KB, and its [`Memory`] and [`Estimator`].
#[derive(Debug, PartialEq)]
pub struct Pilot<'m> {
    chain: Result<Chain<'m>, Grounded>,
    mode: Mode,
    /// When the mode was entered, us.
    since: u64,
    estimation: Estimation<'m>,
    test: MotorTest,
    thrust_check: ThrustCheck,
}

impl<'m> Pilot<'m> {
    /// A disarmed pilot for what the certificate said about a configuration, to tick every [`PERIOD`]; configuration time. It flies
    /// on what `estimator` makes of the measurements; its governor and mixer lie in `memory`.
    ///
    /// Without a certified configuration, or with one it cannot fly, it is grounded: it answers and tests motors, but never
    /// arms, and says why.
    #[must_use]
    pub fn new(
        certification: Result<&Certified, &Refused>,
        limits: &GovernorLimits,
        estimator: &'m mut Estimator,
        memory: &'m mut Memory,
    ) -> Self {
        Self {
            chain: match certification {
                Ok(certified) => Chain::new(certified, limits, PERIOD as f32 * 1e-6, memory),
                Err(refused) => Err(Grounded::from(refused)),
            },
            mode: Mode::Disarmed,
            since: 0,
            estimation: Estimation::new(estimator),
            test: MotorTest::NONE,
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
        let silent = is_silent(inputs);
        let followed = self.follow(estimate);
        let answer = inputs.request.map(|request| self.answer(request, inputs, estimate, silent));
        let conditions = self.conditions(inputs, estimate, answer, silent);
        let conditions = conditions.with(Condition::EstimateLost, estimate.is_lost() || !followed);
        let transition = rules::transition(self.mode, conditions);
        if let Some(transition) = transition {
            self.enter(&transition, inputs);
        }
        let setpoint = inputs.setpoint.map(|setpoint| self.accept(&setpoint));
        let (output, flown) = self.output(estimate);
        let Estimate { state: estimated, health, pose, .. } = *estimate;
        let scale = flown.as_ref().and_then(|flown| flown.as_ref().ok()).map(|flown| flown.thrust_scale);
        let is_thrust_doubtful = self.thrust_check.is_doubtful(scale, inputs.now);
        let mode = self.mode;
        Outcome { output, mode, transition, answer, setpoint, flown, estimated, health, pose, is_thrust_doubtful }
    }

    /// Goes along where the estimate has jumped in flight; whether that was possible.
    fn follow(&mut self, estimate: &Estimate) -> bool {
        match (&mut self.chain, &estimate.state) {
            (Ok(chain), Some(estimated)) if estimate.jumped && self.mode.is_armed() => {
                chain.jump(&estimated.state).is_ok()
            }
            _ => true,
        }
    }

    /// Whether a request is granted. Granting an arm request readies the chain for it.
    fn answer(&mut self, request: Request, inputs: &Inputs, estimate: &Estimate, silent: bool) -> Result<(), Refusal> {
        permission::to_leave(self.mode, inputs.disarm)?;
        match request {
            Request::Arm => {
                let chain = self.chain.as_mut().map_err(|grounded| Refusal::Grounded(*grounded))?;
                let start = permission::to_arm(estimate, silent)?;
                chain.start(&start.position, &start.heading).map_err(|error| Refusal::Reference(field(error)))
            }
            Request::MotorTest(test) => {
                permission::to_test(&test, self.chain.as_ref().map_or(ROTORS_MIN, Chain::rotors))?;
                self.test = test;
                Ok(())
            }
        }
    }

    /// What the rules need to know in this tick.
    fn conditions(
        &mut self,
        inputs: &Inputs,
        estimate: &Estimate,
        answer: Option<Result<(), Refusal>>,
        silent: bool,
    ) -> Conditions {
        let elapsed = inputs.now.saturating_sub(self.since);
        let granted = answer == Some(Ok(()));
        let regained = match (self.mode, &mut self.chain, &estimate.state) {
            (Mode::Levelling, Ok(chain), Some(estimated)) if estimate.is_found() => {
                chain.regain(&estimated.state).is_ok()
            }
            _ => false,
        };
        Conditions::NONE
            .with(Condition::DisarmCommanded, inputs.disarm)
            .with(Condition::ArmingPermitted, granted && inputs.request == Some(Request::Arm))
            .with(Condition::MotorTestPermitted, granted && matches!(inputs.request, Some(Request::MotorTest(_))))
            .with(Condition::Requested, inputs.request.is_some())
            .with(Condition::MotorTestOver, elapsed >= self.test.duration)
            .with(Condition::ImuStale, estimate.state.is_none())
            .with(Condition::ThrustsRefused, self.chain.as_ref().is_ok_and(Chain::is_refused))
            .with(Condition::PoseRegained, regained)
            .with(Condition::LevellingOver, elapsed >= LEVELLING_MAX)
            .with(Condition::GroundStationSilent, silent)
            .with(Condition::GroundStationHeard, !silent)
    }

    /// Does what entering a mode takes. What arming and finding the pose again take is done where they are found possible.
    fn enter(&mut self, transition: &Transition, inputs: &Inputs) {
        self.mode = transition.to;
        self.since = inputs.now;
        match (&mut self.chain, transition.to) {
            (Ok(chain), Mode::Holding) => chain.hold(),
            (Ok(chain), Mode::Levelling) => chain.level(),
            _ => {}
        }
    }

    fn accept(&mut self, setpoint: &Setpoint) -> Result<(), Refusal> {
        match (&mut self.chain, self.mode) {
            (Ok(chain), Mode::Flying) => chain.accept(setpoint).map_err(Refusal::Setpoint),
            _ => Err(Refusal::NotFlying),
        }
    }

    /// What the mode does in this tick.
    fn output(&mut self, estimate: &Estimate) -> (Output, Option<Result<Flown, InputError>>) {
        if self.mode == Mode::MotorTest {
            return (Output::Test { rotor: self.test.rotor, level: self.test.level }, None);
        }
        // Every armed mode has both, by the rules.
        let (Ok(chain), Some(estimated)) = (&mut self.chain, &estimate.state) else {
            return (Output::Stop, None);
        };
        let state = &estimated.state;
        let flown = match self.mode {
            Mode::Disarmed | Mode::MotorTest => return (Output::Stop, None),
            Mode::Levelling => chain.fly_level(state.attitude, state.angular_velocity),
            Mode::Flying | Mode::Holding => chain.fly(state),
        };
        let output = chain.thrusts().map_or(Output::Stop, |thrusts| Output::Thrusts(thrusts.clone()));
        (output, Some(flown))
    }
}

/// Whether the ground station has been silent for too long.
fn is_silent(inputs: &Inputs) -> bool {
    !inputs.ground_station.is_some_and(|heard| is_fresh(heard, GROUND_STATION_SILENCE_MAX - 1, inputs.now))
}

#[cfg(test)]
mod tests;
