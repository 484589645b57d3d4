//! What takes over a flight brings it to rest from the vehicle's motion, as [`crate::braking`] has it: a command to
//! hold or to land, a failure, a pose that is found again, a jump of the estimate.

use super::{Chain, resting};
use crate::braking::VERTICAL_STOP;
use crate::rules::Mode;
use crate::tilt::heading;
use controller_core::error::InputError;
use controller_core::math;
use controller_core::state::State;
use nalgebra::{Vector2, Vector3};

/// How late feedback brakes a vertical speed.
const VERTICAL_BRAKING_DELAY_S: f32 = 0.2;

/// A reference that comes to rest within this by itself, is left to do so.
const REST_DISTANCE_MAX_M: f32 = 0.05;

/// The speed, at which a vehicle hardly sinks: less than a landing's.
const HARDLY_SINKING_SPEED_M_PER_S: f32 = 0.3;

/// `velocity` with its horizontal part at most `speed` long.
pub(super) fn slowed(velocity: &Vector3<f32>, speed: f32) -> Vector3<f32> {
    let across: Vector2<f32> = velocity.xy();
    let share = (speed / across.norm().max(speed)).min(1.0);
    Vector3::new(across.x * share, across.y * share, velocity.z)
}

impl Chain<'_> {
    /// Brings a vehicle in `state` to rest, not below `ground`, m. A reference that rests, or nearly does, stays where
    /// it is: the law holds the vehicle there.
    #[inline(never)]
    pub fn hold(&mut self, state: &State, ground: f32) {
        if self.is_nearly_at_rest() {
            return self.governor.stop();
        }
        // Out of its range it stops where it is.
        if self.regain(state, ground).is_err() {
            self.governor.stop();
        }
    }

    /// Begins a landing at `speed`, m/s, of a vehicle in `state`; one that sinks more slowly goes on as it does.
    pub fn land(&mut self, state: &State, speed: f32) {
        if self.is_nearly_at_rest() {
            return;
        }
        let sinking = Vector3::new(0.0, 0.0, math::clamp(state.velocity.z, -speed, 0.0));
        // Out of its range it goes down from where the reference is.
        let _ = self.brake(state, &sinking, f32::NEG_INFINITY);
    }

    #[inline(never)]
    fn is_nearly_at_rest(&self) -> bool {
        self.braking.is_over() && self.governor.way_to_rest() < REST_DISTANCE_MAX_M
    }

    /// Takes a flight up again where the vehicle is found, and brings it to rest, not below `ground`, m, with the
    /// heading that was held. The law needs no restart: levelling has left its filters at zero.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn regain(&mut self, state: &State, ground: f32) -> Result<(), InputError> {
        self.brake(state, &Vector3::zeros(), ground)
    }

    /// From the motion in `state` to a steady `velocity`, m/s.
    #[inline(never)]
    fn brake(&mut self, state: &State, velocity: &Vector3<f32>, ground: f32) -> Result<(), InputError> {
        let mut braking = self.braking;
        let mut end = state.position + braking.begin(&slowed(&(state.velocity - velocity), self.speed));
        end.z = end.z.max(ground.min(state.position.z));
        self.go_on(&end, velocity)?;
        self.braking = braking;
        Ok(())
    }

    /// Takes a flight up where the vehicle is, at its velocity as far as references may be as fast.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn take_up(&mut self, state: &State) -> Result<(), InputError> {
        self.go_on(&state.position, &slowed(&state.velocity, self.speed))
    }

    /// The governor anew, with the heading at hand.
    #[inline(never)]
    fn go_on(&mut self, position: &Vector3<f32>, velocity: &Vector3<f32>) -> Result<(), InputError> {
        let heading = &self.reference.heading;
        self.governor.start(position, velocity, heading)?;
        self.braking.end();
        if !self.spool.is_over() {
            // The governor's reference is not flown yet: this one waits at rest for the rotors, where the vehicle is.
            self.reference = resting(position, heading);
        }
        Ok(())
    }

    /// Whether a vehicle in `state` comes to rest within `height`, m, below it; one that hardly sinks does, wherever
    /// the ground is.
    pub fn stops_within(&self, height: f32, state: &State) -> bool {
        let down = (-state.velocity.z).max(0.0);
        down < HARDLY_SINKING_SPEED_M_PER_S || VERTICAL_STOP.way(down) + VERTICAL_BRAKING_DELAY_S * down < height
    }

    /// Goes along where the estimate has jumped to `state`, with the vehicle's heading, which may have jumped too. What
    /// holds or lands brakes; what flies to somewhere goes on as fast as it was. The reference of a take-off goes as
    /// far up as the vehicle jumped; that of a landing stays as far below the vehicle as it was, and does not rise.
    /// Nothing is learnt from the jump. The certificate covers it as it covers any other jump of the reference.
    ///
    /// # Errors
    /// Names the field the governor refuses.
    pub fn jump(&mut self, before: &State, state: &State, mode: Mode) -> Result<(), &'static str> {
        if let Some(heading) = heading(&state.attitude) {
            self.reference.heading = heading;
        }
        self.law.hold_estimates();
        self.lift_off.displace(&state.position);
        let from = |result: Result<(), InputError>| result.map_err(|error| error.field());
        match mode {
            Mode::Landing => {
                let mut landing = *state;
                landing.position.z += (self.reference.position.z - before.position.z).min(0.0);
                landing.velocity.z = self.reference.velocity.z.min(0.0);
                from(self.brake(&landing, &Vector3::new(0.0, 0.0, landing.velocity.z), f32::NEG_INFINITY))
            }
            Mode::TakingOff => {
                from(self.take_up(state))?;
                self.reference.position = state.position;
                self.rising_to += state.position.z - before.position.z;
                self.rise_on()
            }
            Mode::Holding => from(self.regain(state, f32::NEG_INFINITY)),
            _ => from(self.take_up(state)),
        }
    }
}

#[cfg(test)]
mod tests;
