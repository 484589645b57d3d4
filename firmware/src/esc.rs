//! The motors' speed controllers: what they answer, kept and published.
//!
//! | module | what it holds |
//! |---|---|
//! | [`answer`] | what an answer says |
//! | [`gcr`] | its line code |
//! | [`samples`] | a line's samples as the line code's levels |
//! | [`request`] | when controllers are asked for extended answers |
//!
//! ```text
//! samples -> levels -> 12 bits -> Answer -> Controllers -> shared.rotor_speeds, shared.controllers
//! ```
//!
//! Nothing is published before a first answer: with controllers that do not answer everything is as if there were none
//! that could. An answer that comes garbled counts as none. A speed is published until it is [`SPEED_AGE_MAX_US`] old;
//! what a controller says of itself is kept, with its time.

pub mod answer;
pub mod gcr;
pub mod request;
pub mod samples;

use crate::hardware::{Clock, Fault, MOTOR_COUNT, MotorCommand, Motors};
use crate::parameters::table::Name;
use crate::shared::MotorsView;
use answer::Answer;
use embassy_sync::blocking_mutex::raw::RawMutex;
use flight::Stamped;

/// How long a speed counts: some seventeen frames.
pub const SPEED_AGE_MAX_US: u64 = 20_000;

/// How fast the rotors turn, rad/s, in their order; none of a rotor whose controller has not answered of late.
pub type RotorSpeeds = [Option<f32>; MOTOR_COUNT];

/// A controller, as its answers tell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Controller {
    /// The motor's speed, rad/s.
    pub speed: Option<Stamped<f32>>,
    /// Degrees Celsius.
    pub temperature: Option<u8>,
    /// V.
    pub voltage: Option<f32>,
    /// A.
    pub current: Option<u8>,
    /// See [`Answer::Stress`].
    pub stress: Option<u8>,
    /// See [`Answer::Status`].
    pub status: Option<u8>,
    /// Answers, and frames without a valid one since the first; each count starts again after 2^32.
    pub answered: u32,
    /// See [`Self::answered`].
    pub missed: u32,
}

impl Controller {
    /// Takes an answer, or that there was none, at `now`, us, of a motor of so many `poles`.
    fn take(&mut self, answer: Option<Answer>, poles: f32, now: u64) {
        let Some(answer) = answer else {
            self.missed = self.missed.wrapping_add(u32::from(self.answered > 0));
            return;
        };
        self.answered = self.answered.wrapping_add(1);
        match answer {
            Answer::Period(_) | Answer::AtRest => {
                self.speed = answer.speed(poles).map(|value| Stamped { value, time: now });
            }
            Answer::Temperature(degrees) => self.temperature = Some(degrees),
            Answer::Voltage(volts) => self.voltage = Some(volts),
            Answer::Current(amperes) => self.current = Some(amperes),
            Answer::Stress(stress) => self.stress = Some(stress),
            Answer::Status(status) => self.status = Some(status),
            Answer::Debug(..) => {}
        }
    }
}

/// All of them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Controllers([Controller; MOTOR_COUNT]);

impl Controllers {
    /// Takes the `answers` to a frame at `now`, us, of motors of so many `poles`, and publishes what is known.
    pub fn take<M: RawMutex>(
        &mut self,
        answers: [Option<Answer>; MOTOR_COUNT],
        poles: f32,
        now: u64,
        shared: MotorsView<'_, M>,
    ) {
        for (controller, answer) in self.0.iter_mut().zip(answers) {
            controller.take(answer, poles, now);
        }
        if self.0.iter().any(|controller| controller.answered > 0) {
            shared.rotor_speeds().put(self.speeds(now), now);
            shared.controllers().put(self.0, now);
        }
    }

    fn speeds(&self, now: u64) -> RotorSpeeds {
        let young = |speed: &Stamped<f32>| speed.age(now) < SPEED_AGE_MAX_US;
        self.0.map(|controller| controller.speed.filter(young).map(|speed| speed.value))
    }
}

/// Motors whose controllers' answers are published after each frame, unless a simulator has the motors.
pub struct Published<'a, M: RawMutex, T, C> {
    /// The motors.
    pub motors: T,
    /// Where to.
    pub shared: MotorsView<'a, M>,
    /// The board's time.
    pub clock: C,
    controllers: Controllers,
}

impl<'a, M: RawMutex, T: Motors, C: Clock> Published<'a, M, T, C> {
    /// Nothing answered yet.
    pub fn new(motors: T, shared: MotorsView<'a, M>, clock: C) -> Self {
        Self { motors, shared, clock, controllers: Controllers::default() }
    }

    /// Publishes what was answered of late.
    pub fn publish(&mut self) {
        let answers = self.motors.answers();
        if !self.shared.hil().is_raised() {
            let poles = self.shared.parameters().get(Name::MotorPoles);
            self.controllers.take(answers, poles, self.clock.now(), self.shared);
        }
    }
}

impl<M: RawMutex, T: Motors, C: Clock> Motors for Published<'_, M, T, C> {
    async fn write(&mut self, command: MotorCommand) -> Result<(), Fault> {
        let written = self.motors.write(command).await;
        self.publish();
        written
    }
}

#[cfg(test)]
mod tests;
