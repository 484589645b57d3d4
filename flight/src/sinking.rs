//! The vertical motion without a pose, by what the accelerometer adds to it.

use controller_core::math;
use estimation::estimator::EstimatedState;

/// Of a descent by the IMU alone.
const DESCENT_SPEED_MIN_M_PER_S: f32 = 0.6;

/// The growth of the error of the vertical speed by the accelerometer alone: an accelerometer's bias. After poses that
/// lied, an attitude error of 8 degrees as well.
const SPEED_DRIFT_M_PER_S2: f32 = 0.05;
const SPEED_DRIFT_AFTER_LIES_M_PER_S2: f32 = 0.2;

/// The vertical speed by the accelerometer alone beyond which a vehicle moves, and how fast that limit grows: most
/// drift less than [`SPEED_DRIFT_M_PER_S2`], and a descent against the air's drag is slower than commanded.
const MOTION_SPEED_MIN_M_PER_S: f32 = 0.3;
const MOTION_DRIFT_M_PER_S2: f32 = 0.01;

/// The same after poses that lied, which leave a speed that may be off.
const MOTION_SPEED_MIN_AFTER_LIES_M_PER_S: f32 = 0.8;
const MOTION_DRIFT_AFTER_LIES_M_PER_S2: f32 = 0.05;

/// How much more slowly than commanded a vehicle may sink against the air.
const HELD_BACK_SPEED_MAX_M_PER_S: f32 = 0.1;

/// How far the vehicle may fall behind its descent: so much of a steady up- or downdraft is made up for, and no more is
/// left to be made up for where the draft ends.
const BEHIND_MAX_M: f32 = 0.3;

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
    /// `desired`, m/s.
    pub fn behind(&mut self, desired: f32, period: f32) -> f32 {
        self.behind = math::clamp(self.behind + (self.speed - desired) * period, -BEHIND_MAX_M, BEHIND_MAX_M);
        self.behind
    }

    /// Whether the vehicle rises or sinks faster than an accelerometer's drift explains.
    pub fn is_motion(&self) -> bool {
        self.speed.abs() > self.moving()
    }

    /// Whether its descent shows as motion, in an updraft as well: if not, no speed tells what sinks from what stands.
    pub fn shows(&self) -> bool {
        self.descent() > self.moving() + HELD_BACK_SPEED_MAX_M_PER_S
    }

    /// The speed beyond which it moves, m/s.
    fn moving(&self) -> f32 {
        if self.lied {
            MOTION_SPEED_MIN_AFTER_LIES_M_PER_S + MOTION_DRIFT_AFTER_LIES_M_PER_S2 * self.time
        } else {
            MOTION_SPEED_MIN_M_PER_S + MOTION_DRIFT_M_PER_S2 * self.time
        }
    }

    /// How fast to go down, m/s: so fast that the vehicle truly sinks, despite the drift of the accelerometer's sum.
    pub fn descent(&self) -> f32 {
        DESCENT_SPEED_MIN_M_PER_S
            + if self.lied { SPEED_DRIFT_AFTER_LIES_M_PER_S2 } else { SPEED_DRIFT_M_PER_S2 } * self.time
    }
}

#[cfg(test)]
mod tests;
