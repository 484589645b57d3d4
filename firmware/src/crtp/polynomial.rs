//! Polynomials of seventh degree, and the segment of a path that has one for each axis and for the yaw.
//!
//! A segment from a moving point to rest: with s = t / T the only c_4 to c_7 for which p, p', p'' and p''' are, at s = 1,
//! the goal and zeros, where c_0 to c_3 are p_0, p_0' T, p_0'' T^2 / 2 and 0. With A = p_1 - c_0 - c_1 - c_2,
//! B = -c_1 - 2 c_2 and C = -2 c_2:
//!
//! ```text
//! c_4 =  35 A - 15 B + 5/2 C      c_6 =  70 A - 34 B + 13/2 C
//! c_5 = -84 A + 39 B -   7 C      c_7 = -20 A + 10 B -    2 C
//! ```

use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use core::f32::consts::{PI, TAU};
use nalgebra::Vector3;

/// Coefficients of a polynomial.
pub const COEFFICIENTS: usize = 8;

/// c_0 + c_1 t + ... + c_7 t^7, t in s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polynomial(pub [f32; COEFFICIENTS]);

/// A value with its first four derivatives by time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moving {
    /// The value.
    pub value: f32,
    /// Its rate.
    pub rate: f32,
    /// And that one's.
    pub acceleration: f32,
    /// The third.
    pub jerk: f32,
    /// The fourth.
    pub snap: f32,
}

impl Moving {
    /// Of a value that moves, and nothing known beyond its acceleration.
    pub const fn new(value: f32, rate: f32, acceleration: f32) -> Self {
        Self { value, rate, acceleration, jerk: 0.0, snap: 0.0 }
    }

    /// At rest.
    pub const fn resting(value: f32) -> Self {
        Self::new(value, 0.0, 0.0)
    }

    /// The same as time passes `rate` times as fast, backwards if that is negative.
    #[must_use]
    pub fn paced(self, rate: f32) -> Self {
        let square = rate * rate;
        Self {
            value: self.value,
            rate: self.rate * rate,
            acceleration: self.acceleration * square,
            jerk: self.jerk * square * rate,
            snap: self.snap * square * square,
        }
    }

    /// This much of it and that much of another.
    #[must_use]
    pub fn mixed(&self, share: f32, other: &Self, others: f32) -> Self {
        let mix = |one: f32, two: f32| share * one + others * two;
        Self {
            value: mix(self.value, other.value),
            rate: mix(self.rate, other.rate),
            acceleration: mix(self.acceleration, other.acceleration),
            jerk: mix(self.jerk, other.jerk),
            snap: mix(self.snap, other.snap),
        }
    }
}

impl Polynomial {
    /// From a moving value to rest at `goal` after `duration`, s.
    pub fn to_rest(from: &Moving, goal: f32, duration: f32) -> Self {
        let (c0, c1, c2) = (from.value, from.rate * duration, from.acceleration * duration * duration * 0.5);
        let (a, b, c) = (goal - c0 - c1 - c2, -c1 - 2.0 * c2, -2.0 * c2);
        let c4 = 35.0 * a - 15.0 * b + 2.5 * c;
        let c5 = -84.0 * a + 39.0 * b - 7.0 * c;
        let c6 = 70.0 * a - 34.0 * b + 6.5 * c;
        let c7 = -20.0 * a + 10.0 * b - 2.0 * c;
        let mut scale = 1.0;
        Self([c0, c1, c2, 0.0, c4, c5, c6, c7].map(|coefficient| {
            let scaled = coefficient * scale;
            scale /= duration;
            scaled
        }))
    }

    /// On a straight line to `goal` within `duration`, s.
    pub fn straight(from: f32, goal: f32, duration: f32) -> Self {
        Self([from, (goal - from) / duration, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    }

    /// At `time`, s.
    pub fn at(&self, time: f32) -> Moving {
        // Horner's rule, and its derivatives.
        self.0.iter().rev().fold(Moving::default(), |sum, coefficient| Moving {
            snap: sum.snap * time + 4.0 * sum.jerk,
            jerk: sum.jerk * time + 3.0 * sum.acceleration,
            acceleration: sum.acceleration * time + 2.0 * sum.rate,
            rate: sum.rate * time + sum.value,
            value: sum.value * time + coefficient,
        })
    }
}

/// Where a path is, and which way it points: m and rad, world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// x, y and z.
    pub axes: [Moving; 3],
    /// Counter-clockwise from x.
    pub yaw: Moving,
}

impl Point {
    /// At rest.
    pub fn resting(position: &Vector3<f32>, yaw: f32) -> Self {
        Self { axes: [position.x, position.y, position.z].map(Moving::resting), yaw: Moving::resting(yaw) }
    }

    /// m.
    pub fn position(&self) -> Vector3<f32> {
        self.axes.map(|axis| axis.value).into()
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        let [x, y, z] = &self.axes;
        [x, y, z, &self.yaw].iter().all(|axis| {
            [axis.value, axis.rate, axis.acceleration, axis.jerk, axis.snap].iter().all(|number| number.is_finite())
        })
    }

    /// There, and not moving.
    #[must_use]
    pub fn at_rest(&self) -> Self {
        Self::resting(&self.position(), self.yaw.value)
    }

    /// For the governor.
    pub fn setpoint(&self) -> Setpoint {
        let motion = Motion::PositionVelocityAcceleration {
            position: self.position(),
            velocity: self.axes.map(|axis| axis.rate).into(),
            acceleration: self.axes.map(|axis| axis.acceleration).into(),
        };
        Setpoint { motion, turn: HeadingSetpoint::Angle { angle: self.yaw.value, rate: self.yaw.rate } }
    }
}

/// A part of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// x, y and z, m.
    pub axes: [Polynomial; 3],
    /// rad.
    pub yaw: Polynomial,
    /// s, above zero.
    pub duration: f32,
}

impl Segment {
    /// From a point to rest at `goal`, turned to `yaw` the shorter way round.
    pub fn to_rest(from: &Point, goal: &Vector3<f32>, yaw: f32, duration: f32) -> Self {
        let [x, y, z] = from.axes;
        let to = |axis: Moving, goal| Polynomial::to_rest(&axis, goal, duration);
        let yaw = to(from.yaw, nearest(yaw, from.yaw.value));
        Self { axes: [to(x, goal.x), to(y, goal.y), to(z, goal.z)], yaw, duration }
    }

    /// The same on a straight line, at one speed.
    pub fn straight(from: &Point, goal: &Vector3<f32>, yaw: f32, duration: f32) -> Self {
        let [x, y, z] = from.axes;
        let to = |axis: Moving, goal| Polynomial::straight(axis.value, goal, duration);
        let yaw = to(from.yaw, nearest(yaw, from.yaw.value));
        Self { axes: [to(x, goal.x), to(y, goal.y), to(z, goal.z)], yaw, duration }
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        let [x, y, z] = &self.axes;
        [x, y, z, &self.yaw].iter().all(|axis| axis.0.iter().all(|coefficient| coefficient.is_finite()))
            && self.duration.is_finite()
    }

    /// At `time`, s, and not beyond its end.
    pub fn at(&self, time: f32) -> Point {
        let time = time.clamp(0.0, self.duration);
        Point { axes: self.axes.map(|axis| axis.at(time)), yaw: self.yaw.at(time) }
    }
}

/// The same angle, rad, as close to another as whole turns bring it.
fn nearest(angle: f32, other: f32) -> f32 {
    let apart = (angle - other) % TAU;
    let apart = if apart > PI {
        apart - TAU
    } else if apart < -PI {
        apart + TAU
    } else {
        apart
    };
    other + apart
}

#[cfg(test)]
mod tests;
