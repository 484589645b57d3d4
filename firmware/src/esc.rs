//! The motors' speed controllers: what they answer, kept and published.
//!
//! | module | what it holds |
//! |---|---|
//! | [`answer`] | what an answer says |
//! | [`controller`] | what a controller's answers tell of it |
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
pub mod controller;
pub mod gcr;
pub mod request;
pub mod samples;

use crate::hardware::{Clock, Fault, MOTOR_COUNT, MotorCommand, Motors};
use crate::parameters::table::Name;
use crate::shared::MotorsView;
use answer::Answer;
use controller::{Controller, RotorSpeeds, SPEED_AGE_MAX_US};
use embassy_sync::blocking_mutex::raw::RawMutex;
use flight::Stamped;

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
