//! How a reference comes to rest from the vehicle's motion.
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
//! takes those at their worst (`chain::without_pose`).

use controller_core::math;
use controller_core::reference::{Reference, ReferenceBounds};
use nalgebra::{Vector2, Vector3};

/// How fast a speed across falls, as a share of the maximum horizontal acceleration and jerk of a reference.
const ACROSS_SHARE: f32 = 0.95;

/// How fast a vertical speed falls, m/s^2 (0.4 g, as a shield's law brakes) and m/s^3.
pub(super) const VERTICAL_STOP: Stop = Stop { acceleration: 4.0, jerk: 40.0 };

/// How a speed falls: A, m/s^2, and J, m/s^3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stop {
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
    pub fn way(self, speed: f32) -> f32 {
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
    pub fn is_over(&self) -> bool {
        self.from == Vector3::zeros()
    }

    /// From `velocity`, m/s, on; how far it goes until it has come to rest, m.
    pub fn begin(&mut self, velocity: &Vector3<f32>) -> Vector3<f32> {
        (self.from, self.time) = (*velocity, 0.0);
        let (direction, speed) = self.direction();
        let up = VERTICAL_STOP.way(velocity.z.abs()).copysign(velocity.z);
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
        let [up, rises, _] = VERTICAL_STOP.after(self.time, self.from.z.abs());
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

#[cfg(test)]
mod tests;
