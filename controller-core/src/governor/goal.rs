//! The governor's goal, by the last setpoint.

use super::stream::Stream;
use nalgebra::Vector3;

/// Setpoints that are nearer to each other, s, say nothing of how the acceleration changes.
const SAME_TIME_S: f32 = 0.0015;

/// What the position is to do: be at a point, or, on the axes without one, move. What moves is renewed or stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Goal {
    /// Length units; zero on the axes without.
    pub position: Vector3<i64>,
    /// Which axes have a position.
    pub held: [bool; 3],
    /// How it moves, or how to move.
    pub stream: Stream,
}

impl Goal {
    /// Come to rest.
    pub const STOP: Self = Self { position: Vector3::new(0, 0, 0), held: [false; 3], stream: Stream::STILL };

    /// Whether it is a point, on every axis.
    pub fn is_point(&self) -> bool {
        self.held == [true; 3]
    }

    /// How the point of a setpoint moves, `time` seconds after the `last` goal, if that is fresh; with what the two say
    /// together where both are points on every axis.
    pub fn stream(
        held: [bool; 3],
        velocity: Vector3<f32>,
        acceleration: Vector3<f32>,
        last: Option<&Self>,
        time: f32,
    ) -> Stream {
        match last.filter(|last| last.is_point() && held == [true; 3]) {
            None => Stream::new(velocity, acceleration),
            // Two at once: too little time to tell a change from an error of its own.
            Some(last) if time < SAME_TIME_S => Stream { velocity, acceleration, ..last.stream },
            Some(last) => last.stream.followed_by(velocity, acceleration, time),
        }
    }
}
