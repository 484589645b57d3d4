//! The vertical motion without a pose, by what the accelerometer adds to it.

use controller_core::math;
use estimation::estimator::EstimatedState;

/// The least speed of a descent by the IMU alone, m/s.
const DESCENT: f32 = 0.6;

/// The error of the vertical speed by the accelerometer alone, m/s in a second: an accelerometer's bias. After poses
/// that lied, an attitude error of 8 degrees as well.
const DRIFT: f32 = 0.05;
const DRIFT_AFTER_LIES: f32 = 0.2;

/// The vertical speed by the accelerometer alone, m/s, beyond which a vehicle moves, and what its drift adds to that in
/// a second: most drift less than [`DRIFT`], and what goes down against the air's drag stays behind what it should.
const MOVING: (f32, f32) = (0.3, 0.01);

/// The same after poses that lied, which leave a speed that may be off.
const MOVING_AFTER_LIES: (f32, f32) = (0.8, 0.05);

/// How much more slowly than it should a vehicle may sink against the air, m/s.
const HELD_BACK: f32 = 0.1;

/// How far, m, the vehicle may fall behind its descent: so much of a steady up- or downdraft is made up for, and no
/// more is left to be made up for where the draft ends.
const BEHIND: f32 = 0.3;

/// How a vehicle that has lost its pose sinks.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Sinking {
    /// m/s, upwards.
    speed: f32,
    /// How far above its descent it is, m.
    behind: f32,
    /// For how long, s.
    time: f32,
    /// Whether the poses before had lied.
    lied: bool,
    /// What the accelerometer had added to the vertical speed by the last tick, m/s.
    last: Option<f32>,
}

impl Sinking {
    /// Without a pose from now on, at a vertical speed of `speed`, m/s; after poses that have `lied`, or not.
    pub fn at(speed: f32, lied: bool) -> Self {
        Self { speed, lied, ..Self::default() }
    }

    /// The vehicle was stopped.
    pub fn stop(&mut self) {
        self.speed = 0.0;
    }

    /// One tick of `period`, s, on; the vertical speed, m/s. Poses that come meanwhile do not count.
    pub fn advance(&mut self, estimated: &EstimatedState, period: f32) -> f32 {
        let now = estimated.gained;
        self.speed += now - self.last.unwrap_or(now);
        self.last = Some(now);
        self.time += period;
        self.speed
    }

    /// How far above its descent the vehicle is, m, after another tick of `period`, s, in which it should move at
    /// `wanted`, m/s.
    pub fn behind(&mut self, wanted: f32, period: f32) -> f32 {
        self.behind = math::clamp(self.behind + (self.speed - wanted) * period, -BEHIND, BEHIND);
        self.behind
    }

    /// Whether the vehicle rises or sinks faster than an accelerometer's drift explains.
    pub fn is_motion(&self) -> bool {
        self.speed.abs() > self.moving()
    }

    /// Whether its descent shows as motion, in an updraft as well: if not, no speed tells what sinks from what stands.
    pub fn shows(&self) -> bool {
        self.descent() > self.moving() + HELD_BACK
    }

    /// The speed beyond which it moves, m/s.
    fn moving(&self) -> f32 {
        let (speed, drift) = if self.lied { MOVING_AFTER_LIES } else { MOVING };
        speed + drift * self.time
    }

    /// How fast to go down, m/s: so fast that the vehicle sinks truly, whatever the accelerometer has summed up.
    pub fn descent(&self) -> f32 {
        DESCENT + if self.lied { DRIFT_AFTER_LIES } else { DRIFT } * self.time
    }
}

#[cfg(test)]
mod tests;
