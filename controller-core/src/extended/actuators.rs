//! The past commands through the rotors' delay and lag: a model of the wrench that acts.
//! Section 10 of `docs/extended-law.md`.
//!
//! A command of tick k acts from k + d on, d = n + f samples late (n whole, 0 <= f < 1), and the wrench follows it with
//! the rotors' time constant. So between two ticks the command c_(k-n-1) acts for a time f h, then c_(k-n), and with x
//! the wrench and e(t) = e^(-t / lag), its end and its mean over the interval are linear in x, c_(k-n-1) and c_(k-n):
//! `Response`.
//!
//! The estimates compare accelerations averaged over an interval with this mean. The rotors' speeds lag, not their
//! thrusts; the difference is of second order in the command's step.

use crate::error::{ParameterError, Reason, require, require_finite};
use crate::math;
use nalgebra::Vector4;

/// The number of remembered commands, a power of two, so that an index wraps by a remainder.
const COMMANDS_KEPT: usize = 32;

/// The greatest delay of the model, samples.
pub const DELAY_MAX_TICKS: usize = 31;

/// The greatest rounding error of a delay in single precision, samples.
const DELAY_ROUNDING_TICKS: f64 = 1e-5;

/// How a vehicle's wrench follows its commands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActuatorParameters {
    /// Time constant of the thrust, s.
    pub lag: f32,
    /// From a tick to the moment its command reaches the rotors, s.
    pub delay: f32,
}

impl ActuatorParameters {
    /// After how many ticks a command no longer matters to the wrench that acts: its delay and five lags, rounded up,
    /// and one.
    pub fn settling(&self, period: f32) -> u32 {
        // Converting to an integer rounds towards zero, and ends at the greatest.
        (((self.delay + 5.0 * self.lag) / period) as u32).saturating_add(2)
    }
}

/// Weights of x, the older and the newer command.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Response {
    state: f32,
    older: f32,
    newer: f32,
}

impl Response {
    fn apply(&self, state: &Vector4<f32>, older: &Vector4<f32>, newer: &Vector4<f32>) -> Vector4<f32> {
        state * self.state + older * self.older + newer * self.newer
    }
}

/// The model's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActuatorModel {
    /// n.
    whole_delay: usize,
    /// Lag, the part of a period that a command is late beyond whole ones, and the period, s.
    lag: f32,
    late: f32,
    period: f32,
    end: Response,
    mean: Response,
}

/// The model's memory: the past commands, and the acting wrench. A wrench is (T, tau) in N and N m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActuatorState {
    acting: Vector4<f32>,
    /// A ring of commands, with the index of the newest.
    commanded: [Vector4<f32>; COMMANDS_KEPT],
    newest: usize,
}

impl ActuatorState {
    /// The memory after the same command for ever.
    pub fn steady(wrench: Vector4<f32>) -> Self {
        Self { acting: wrench, commanded: [wrench; COMMANDS_KEPT], newest: 0 }
    }

    /// Takes up the command of this tick.
    pub fn command(&mut self, wrench: Vector4<f32>) {
        self.newest = (self.newest + 1) % COMMANDS_KEPT;
        if let Some(slot) = self.commanded.get_mut(self.newest) {
            *slot = wrench;
        }
    }

    /// The newest command.
    pub fn newest(&self) -> Vector4<f32> {
        self.command_before(0)
    }

    /// The command of `age` ticks before the newest, at most [`DELAY_MAX_TICKS`].
    fn command_before(&self, age: usize) -> Vector4<f32> {
        self.commanded.get(self.newest.wrapping_sub(age) % COMMANDS_KEPT).copied().unwrap_or_default()
    }
}

impl ActuatorModel {
    /// For ticks `period` seconds apart.
    ///
    /// # Errors
    /// Names `rotors.lag` or `sampling.delay` if negative or not finite, or a delay beyond [`DELAY_MAX_TICKS`] - 1
    /// periods.
    pub fn new(parameters: &ActuatorParameters, period: f32) -> Result<Self, ParameterError> {
        let ActuatorParameters { lag, delay } = *parameters;
        for (value, field) in [(lag, "rotors.lag"), (delay, "sampling.delay")] {
            require_finite(value, field)?;
            require(value >= 0.0, field, Reason::Negative)?;
        }
        let longest = (DELAY_MAX_TICKS - 1) as f32 * period;
        let (lag, period) = (f64::from(lag), f64::from(period));
        let samples = f64::from(delay) / period;
        // A delay of whole samples that rounding put just below or above is one.
        require(
            samples <= (DELAY_MAX_TICKS - 1) as f64 + DELAY_ROUNDING_TICKS,
            "sampling.delay",
            Reason::Above(longest),
        )?;
        let whole = math::floor(samples + DELAY_ROUNDING_TICKS);
        let late = (samples - whole).max(0.0) * period;
        // e(t), and the mean of e over t times t, which is the lag times 1 - e(t).
        let decay = |time: f64| if lag > 0.0 { math::exp(-time / lag) } else { 0.0 };
        let area = |time: f64| lag * (1.0 - decay(time));
        let rest = period - late;
        let end = [decay(period), (1.0 - decay(late)) * decay(rest), 1.0 - decay(rest)];
        let through_older = (late - area(late)) + (1.0 - decay(late)) * area(rest);
        let mean = [area(period), through_older, rest - area(rest)].map(|area| area / period);
        let end = if lag > 0.0 { end } else { [0.0, 0.0, 1.0] };
        let response = |[state, older, newer]: [f64; 3]| Response {
            state: state as f32,
            older: older as f32,
            newer: newer as f32,
        };
        Ok(Self {
            whole_delay: whole as usize,
            lag: parameters.lag,
            late: late as f32,
            period: period as f32,
            end: response(end),
            mean: response(mean),
        })
    }

    /// The impulse that past commands will still deliver: the integral of the wrench, N s and N m s, if all commands
    /// were zero from now on. The lag passes on the whole command, so the integral is the lag times the acting wrench
    /// plus the commands still in the delay.
    pub fn pending(&self, state: &ActuatorState) -> Vector4<f32> {
        let whole = (0..self.whole_delay).fold(Vector4::zeros(), |sum, age| sum + state.command_before(age));
        let oldest = state.command_before(self.whole_delay);
        state.acting * self.lag + whole * self.period + oldest * self.late
    }

    /// Lets one period pass; returns the mean wrench over it.
    pub fn advance(&self, state: &mut ActuatorState) -> Vector4<f32> {
        let (newer, older) = (state.command_before(self.whole_delay), state.command_before(self.whole_delay + 1));
        let mean = self.mean.apply(&state.acting, &older, &newer);
        state.acting = self.end.apply(&state.acting, &older, &newer);
        mean
    }
}

#[cfg(test)]
mod tests;
