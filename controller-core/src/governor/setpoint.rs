//! The governor's setpoints.

use crate::error::InputError;
use crate::reference::DERIVATIVE_RANGE;
use crate::state::check_vectors;
use nalgebra::Vector3;

/// The greatest magnitude of a setpoint's or a starting position's component, m.
pub const POSITION_RANGE_M: f32 = 1e7;

/// Where to be, or how to move. World frame, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// Go to a point (m) and rest there. Valid until replaced.
    Position(Vector3<f32>),
    /// Move at a velocity (m/s), cut to the speed limits. Ends in a smooth stop if not renewed in time.
    Velocity(Vector3<f32>),
    /// Follow a moving point. Between setpoints it is extrapolated; if they cease, its last position sent is gone to.
    PositionVelocityAcceleration {
        /// m.
        position: Vector3<f32>,
        /// m/s.
        velocity: Vector3<f32>,
        /// m/s^2.
        acceleration: Vector3<f32>,
    },
    /// Go to a position on the axes that have one, and move at a velocity on the others: across by velocity at a height
    /// that is held, for one. Where an axis has a position, its velocity is that position's own. Velocities end in a
    /// smooth stop if not renewed in time, positions are valid until replaced.
    Mixed {
        /// m.
        position: [Option<f32>; 3],
        /// m/s.
        velocity: Vector3<f32>,
    },
}

/// Which way to point. World frame, counter-clockwise from x seen from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HeadingSetpoint {
    /// As commanded before: an angle on the way is still turned to, a rate still runs out.
    Keep,
    /// Turn to an angle, the shorter way round; any real number of radians is an angle.
    Angle {
        /// rad.
        angle: f32,
        /// How fast that angle itself turns, rad/s; dropped if not renewed in time.
        rate: f32,
    },
    /// Keep turning, rad/s. Ends in a smooth stop if not renewed in time.
    Rate(f32),
}

/// One setpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setpoint {
    /// Position, velocity, or both with feed-forward.
    pub motion: Motion,
    /// Heading.
    pub turn: HeadingSetpoint,
}

/// A setpoint taken apart.
pub(super) struct Parts {
    /// The point to be at, on the axes that have one, m.
    pub position: [Option<f32>; 3],
    /// Its velocity, or on the other axes the one to move at, m/s.
    pub velocity: Vector3<f32>,
    /// m/s^2.
    pub acceleration: Vector3<f32>,
    /// The angle to turn to, if there is one, rad, and its rate, or the one to turn at, rad/s; none to keep both.
    pub turn: Option<(Option<f32>, f32)>,
}

impl Setpoint {
    /// Whether the governor would take it.
    ///
    /// # Errors
    /// Names the field that is not finite or out of range.
    pub fn check(&self) -> Result<(), InputError> {
        self.checked().map(|_| ())
    }

    /// Its parts, where every one of them is finite and in range.
    pub(super) fn checked(&self) -> Result<Parts, InputError> {
        let still = Vector3::zeros();
        let (position, velocity, acceleration) = match self.motion {
            Motion::Position(position) => (point(position), still, still),
            Motion::Velocity(velocity) => ([None; 3], velocity, still),
            Motion::PositionVelocityAcceleration { position, velocity, acceleration } => {
                (point(position), velocity, acceleration)
            }
            Motion::Mixed { position, velocity } => (position, velocity, still),
        };
        let turn = match self.turn {
            HeadingSetpoint::Keep => None,
            HeadingSetpoint::Angle { angle, rate } => Some((Some(angle), rate)),
            HeadingSetpoint::Rate(rate) => Some((None, rate)),
        };
        let (angle, rate) = turn.unwrap_or_default();
        check_vectors(&[
            (&Vector3::from(position.map(Option::unwrap_or_default)), POSITION_RANGE_M, "setpoint.position"),
            (&velocity, DERIVATIVE_RANGE, "setpoint.velocity"),
            (&acceleration, DERIVATIVE_RANGE, "setpoint.acceleration"),
            (&Vector3::repeat(angle.unwrap_or_default()), DERIVATIVE_RANGE, "setpoint.yaw"),
            (&Vector3::repeat(rate), DERIVATIVE_RANGE, "setpoint.yaw_rate"),
        ])?;
        Ok(Parts { position, velocity, acceleration, turn })
    }
}

/// A position on every axis.
fn point(position: Vector3<f32>) -> [Option<f32>; 3] {
    let [x, y, z] = position.into();
    [Some(x), Some(y), Some(z)]
}
