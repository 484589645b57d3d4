//! The pilot: flight rules, governor, law and allocation in one synchronous tick that cannot fail.
//!
//! In a tick, in this order: the newest usable measurements are taken; a request is answered; the rules' conditions are worked
//! out and the table decides; a new mode is entered; a setpoint is taken; and the mode's output is worked out.

use super::chain::{Chain, Flown, Memory};
use super::measurement::{Newest, is_fresh};
use super::permission::{self, MotorTest};
use super::propagation::PropagatedAttitude;
use super::reason::{Grounded, Refusal, field};
use super::rules::{
    self, Condition, Conditions, GROUND_STATION_SILENCE_MAX, IMU_AGE_MAX, LEVELLING_MAX, Mode, POSE_AGE_MAX, Transition,
};
use super::{ImuSample, Inputs, Outcome, Output, PERIOD, Pose, Request};
use crate::allocation::geometry::ROTORS_MIN;
use crate::certificate::certified::{Certified, Refused};
use crate::error::InputError;
use crate::governor::{GovernorLimits, Setpoint};
use crate::state::State;

/// Everything that decides what the motors do. Size: about 2.5 KB, and its [`Memory`].
#[derive(Debug, PartialEq)]
pub struct Pilot<'m> {
    chain: Result<Chain<'m>, Grounded>,
    mode: Mode,
    /// When the mode was entered, us.
    since: u64,
    imu: Newest<ImuSample>,
    pose: Newest<Pose>,
    /// None before the first pose.
    attitude: Option<PropagatedAttitude>,
    test: MotorTest,
}

impl<'m> Pilot<'m> {
    /// A disarmed pilot for what the certificate said about a configuration, to tick every [`PERIOD`]; configuration time. Its
    /// governor and mixer lie in `memory`.
    ///
    /// Without a certified configuration, or with one it cannot fly, it is grounded: it answers and tests motors, but never
    /// arms, and says why.
    #[must_use]
    pub fn new(certification: Result<&Certified, &Refused>, limits: &GovernorLimits, memory: &'m mut Memory) -> Self {
        Self {
            chain: match certification {
                Ok(certified) => Chain::new(certified, limits, PERIOD as f32 * 1e-6, memory),
                Err(refused) => Err(Grounded::from(refused)),
            },
            mode: Mode::Disarmed,
            since: 0,
            imu: Newest::NONE,
            pose: Newest::NONE,
            attitude: None,
            test: MotorTest::NONE,
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
        self.measure(inputs);
        let silent = is_silent(inputs);
        let answer = inputs.request.map(|request| self.answer(request, inputs, silent));
        let transition = rules::transition(self.mode, self.conditions(inputs, answer, silent));
        if let Some(transition) = transition {
            self.enter(&transition, inputs);
        }
        let setpoint = inputs.setpoint.map(|setpoint| self.accept(&setpoint));
        let (output, flown) = self.output(inputs.now);
        Outcome { output, mode: self.mode, transition, answer, setpoint, flown }
    }

    /// Takes the newest measurements, and carries the attitude on.
    fn measure(&mut self, inputs: &Inputs) {
        let now = inputs.now;
        self.imu.offer(&inputs.imu, now);
        let rates = self.imu.within(u64::MAX, now).map_or_else(Default::default, |imu| imu.value.angular_velocity);
        if let Some(pose) = self.pose.offer(&inputs.pose, now) {
            self.attitude = Some(PropagatedAttitude::new(pose.value.attitude(), rates, pose.time));
        }
        if let Some(attitude) = &mut self.attitude {
            attitude.advance(rates, now);
        }
    }

    /// Whether a request is granted. Granting an arm request readies the chain for it.
    fn answer(&mut self, request: Request, inputs: &Inputs, silent: bool) -> Result<(), Refusal> {
        permission::to_leave(self.mode, inputs.disarm)?;
        match request {
            Request::Arm => {
                let chain = self.chain.as_mut().map_err(|grounded| Refusal::Grounded(*grounded))?;
                let start = permission::to_arm(&self.imu, &self.pose, silent, inputs.now)?;
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
    fn conditions(&mut self, inputs: &Inputs, answer: Option<Result<(), Refusal>>, silent: bool) -> Conditions {
        let now = inputs.now;
        let elapsed = now.saturating_sub(self.since);
        let granted = answer == Some(Ok(()));
        let pose = self.pose.within(POSE_AGE_MAX, now);
        let regained = match (self.mode, &mut self.chain, pose) {
            (Mode::Levelling, Ok(chain), Some(pose)) => chain.regain(&pose.value).is_ok(),
            _ => false,
        };
        Conditions::NONE
            .with(Condition::DisarmCommanded, inputs.disarm)
            .with(Condition::ArmingPermitted, granted && inputs.request == Some(Request::Arm))
            .with(Condition::MotorTestPermitted, granted && matches!(inputs.request, Some(Request::MotorTest(_))))
            .with(Condition::Requested, inputs.request.is_some())
            .with(Condition::MotorTestOver, elapsed >= self.test.duration)
            .with(Condition::ImuStale, self.imu.within(IMU_AGE_MAX, now).is_none())
            .with(Condition::ThrustsRefused, self.chain.as_ref().is_ok_and(Chain::is_refused))
            .with(Condition::PoseStale, pose.is_none())
            .with(Condition::PoseRegained, regained)
            .with(Condition::LevellingOver, elapsed >= LEVELLING_MAX)
            .with(Condition::GroundStationSilent, silent)
            .with(Condition::GroundStationHeard, !silent)
    }

    /// Does what entering a mode takes. What arming and regaining the pose take is done where they are found possible.
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
    fn output(&mut self, now: u64) -> (Output, Option<Result<Flown, InputError>>) {
        if self.mode == Mode::MotorTest {
            return (Output::Test { rotor: self.test.rotor, level: self.test.level }, None);
        }
        // Every armed mode has all of these, by the rules.
        let (Ok(chain), Some(imu), Some(pose), Some(attitude)) =
            (&mut self.chain, self.imu.within(IMU_AGE_MAX, now), self.pose.within(u64::MAX, now), &self.attitude)
        else {
            return (Output::Stop, None);
        };
        let (attitude, angular_velocity) = (attitude.attitude(), imu.value.angular_velocity);
        let flown = match self.mode {
            Mode::Disarmed | Mode::MotorTest => return (Output::Stop, None),
            Mode::Levelling => chain.fly_level(attitude, angular_velocity),
            Mode::Flying | Mode::Holding => {
                let (position, velocity) = (pose.value.position(), pose.value.velocity());
                chain.fly(&State { position, velocity, attitude, angular_velocity })
            }
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
