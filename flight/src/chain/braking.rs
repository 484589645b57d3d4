//! How a flight comes to rest, or is taken up, from the vehicle's motion: a command to hold or to land, a failure, a
//! pose that is found again, a jump of the estimate.
//!
//! The governor's command is ahead of its reference by half of the averages, a second or more, and its bounds may be
//! far below what a vehicle can do, along the vertical above all: a reference that stops by itself goes on for metres.
//! So the governor starts anew, at rest where the vehicle will stop, and the reference is the governor's with the
//! vehicle's velocity added, which falls to zero: at the jerk J until it falls with a, then at that, and at the jerk J
//! to its end. From the speed v that takes the time T and the way v T / 2, across and along the vertical:
//!
//! T = v / a + a / J,  v T / 2 = v^2 / (2 a) + v a / (2 J),  a = min(A, sqrt(J v))
//!
//! At first that is where the vehicle is, as fast as it is. Across, A and J are shares of what references may have, and
//! the acceleration is fed forward as far as the governor leaves it; along the vertical feedback brakes.
//!
//! **Why it is within the certificate:** acceleration, jerk and snap, and the speed across, which the law feeds drag
//! forward for, stay within the bounds of references; that they jump is an error of the state, and the certificate
//! takes those at their worst (`without_pose`).

use super::{Chain, resting};
use crate::rules::Mode;
use crate::tilt::heading;
use controller_core::error::InputError;
use controller_core::math;
use controller_core::reference::{Reference, ReferenceBounds};
use controller_core::state::State;
use nalgebra::{Vector2, Vector3};

/// How fast a speed across falls, in the greatest acceleration across and the greatest jerk of a reference.
const ACROSS_SHARE: f32 = 0.95;

/// How fast a vertical speed falls, m/s^2 (0.4 g, as a shield's law brakes) and m/s^3.
const VERTICAL: Stop = Stop { acceleration: 4.0, jerk: 40.0 };

/// How late feedback brakes a vertical speed, s.
const VERTICAL_BRAKING_LATE: f32 = 0.2;

/// A reference that comes to rest within this by itself, m, is left to do so.
const NEARLY_AT_REST: f32 = 0.05;

/// The speed, m/s, at which a vehicle hardly sinks: less than a landing's.
const HARDLY_SINKING: f32 = 0.3;

/// How a speed falls: A, m/s^2, and J, m/s^3.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stop {
    acceleration: f32,
    jerk: f32,
}

impl Stop {
    /// a and T from `speed`, m/s, above zero.
    fn course(self, speed: f32) -> (f32, f32) {
        let a = self.acceleration.min(math::sqrt(self.jerk * speed));
        (a, speed / a + a / self.jerk)
    }

    /// The way from `speed`, m/s, to rest, m.
    fn way(self, speed: f32) -> f32 {
        if speed > 0.0 { 0.5 * speed * self.course(speed).1 } else { 0.0 }
    }

    /// After `time`, s, from `speed`, m/s: the way that is left, m, the speed, and how fast it falls, m/s^2.
    #[inline(never)] // or its two callers would each get a copy; likewise below
    fn after(self, time: f32, speed: f32) -> [f32; 3] {
        if speed <= 0.0 {
            return [0.0; 3];
        }
        let (j, (a, whole)) = (self.jerk, self.course(speed));
        let (ramp, left) = (a / j, whole - time);
        if left <= 0.0 {
            [0.0; 3]
        } else if left < ramp {
            [j * left * left * left / 6.0, 0.5 * j * left * left, j * left]
        } else if time < ramp {
            [0.5 * speed * whole - speed * time + j * time * time * time / 6.0, speed - 0.5 * j * time * time, j * time]
        } else {
            // As after the ramp in the middle of it.
            let (now, last) = (a * (left - 0.5 * ramp), 0.5 * a * ramp);
            [(now * now - last * last) / (2.0 * a) + last * ramp / 3.0, now, a]
        }
    }
}

/// What the vehicle's motion adds to the governor's reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Braking {
    /// The velocity when it began, m/s, and the time since, s.
    from: Vector3<f32>,
    time: f32,
    across: Stop,
}

impl Braking {
    /// With nothing to brake, for references within `bounds`.
    pub fn within(bounds: &ReferenceBounds) -> Self {
        let ReferenceBounds { horizontal_acceleration, jerk, .. } = *bounds;
        let across = Stop { acceleration: ACROSS_SHARE * horizontal_acceleration, jerk: ACROSS_SHARE * jerk };
        Self { from: Vector3::zeros(), time: 0.0, across }
    }

    /// Nothing is left to brake.
    pub fn end(&mut self) {
        self.from = Vector3::zeros();
    }

    /// Whether nothing is left to brake.
    fn is_over(&self) -> bool {
        self.from == Vector3::zeros()
    }

    /// From `velocity`, m/s, on; how far it goes until it has come to rest, m.
    fn begin(&mut self, velocity: &Vector3<f32>) -> Vector3<f32> {
        (self.from, self.time) = (*velocity, 0.0);
        let (direction, speed) = self.direction();
        let up = VERTICAL.way(velocity.z.abs()).copysign(velocity.z);
        (direction * self.across.way(speed)).push(up)
    }

    /// The direction across and the speed along it when it began.
    fn direction(&self) -> (Vector2<f32>, f32) {
        let across = self.from.xy();
        let speed = math::sqrt(across.norm_squared());
        (if speed > 0.0 { across / speed } else { Vector2::zeros() }, speed)
    }

    /// The governor's `reference`, with what is left after another `period`, s.
    pub fn advance(&mut self, reference: Reference, period: f32) -> Reference {
        if self.is_over() {
            return reference;
        }
        self.time += period;
        let (direction, speed) = self.direction();
        let [way, left, falls] = self.across.after(self.time, speed);
        let [up, rises, _] = VERTICAL.after(self.time, self.from.z.abs());
        let sign = 1.0_f32.copysign(self.from.z);
        if left == 0.0 && rises == 0.0 {
            self.end();
        }
        let governed = math::sqrt(reference.acceleration.xy().norm_squared());
        let forward = falls.min((self.across.acceleration - governed).max(0.0));
        Reference {
            position: reference.position - (direction * way).push(up * sign),
            velocity: reference.velocity + (direction * left).push(rises * sign),
            acceleration: reference.acceleration - (direction * forward).push(0.0),
            ..reference
        }
    }
}

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
        let sinking = Vector3::new(0.0, 0.0, math::between(state.velocity.z, -speed, 0.0));
        // Out of its range it goes down from where the reference is.
        let _ = self.brake(state, &sinking, f32::NEG_INFINITY);
    }

    #[inline(never)]
    fn is_nearly_at_rest(&self) -> bool {
        self.braking.is_over() && self.governor.way_to_rest() < NEARLY_AT_REST
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
        down < HARDLY_SINKING || VERTICAL.way(down) + VERTICAL_BRAKING_LATE * down < height
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
