//! A pose as the estimator takes it: where the vehicle was, the sender's deviations, and its report on its own stream.

use crate::measurement::Pose;
use nalgebra::{Quaternion, Vector3};

/// A checked pose with its sender's velocity, deviations, quality and reset counter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseMeasurement {
    /// p, m, world.
    pub(super) position: Vector3<f32>,
    /// q, body to world, unit.
    pub(super) attitude: Quaternion<f32>,
    /// v, m/s, world, if it is to be believed.
    pub(super) velocity: Option<Vector3<f32>>,
    /// Deviations of position (m) and attitude (rad) on each axis; those of the settings if none.
    pub(super) deviations: Option<(f32, f32)>,
    /// Whether the sender reports failed tracking.
    pub(super) failed: bool,
    /// Whether it was rounded to millimetres on its way.
    pub(super) is_rounded: bool,
    /// Whether its sender gave a place alone.
    pub(super) is_place: bool,
    /// Counts the times that the sender's frame has moved.
    pub(super) resets: u8,
}

impl PoseMeasurement {
    /// Position and attitude of `pose`, with deviations as in the settings, from a frame that never moved.
    pub fn new(pose: &Pose) -> Self {
        let (position, attitude) = (pose.position(), pose.attitude());
        Self {
            position,
            attitude,
            velocity: None,
            deviations: None,
            failed: false,
            is_rounded: false,
            is_place: false,
            resets: 0,
        }
    }

    /// p, m, world.
    pub fn position(&self) -> Vector3<f32> {
        self.position
    }

    /// v, m/s, world, if its source gave one.
    pub fn velocity(&self) -> Option<Vector3<f32>> {
        self.velocity
    }

    /// q, body to world, unit.
    pub fn attitude(&self) -> Quaternion<f32> {
        self.attitude
    }

    /// The same with the velocity of `pose`: believed only where the settings give velocities a deviation.
    pub fn with_velocity(pose: &Pose) -> Self {
        Self { velocity: Some(pose.velocity()), ..Self::new(pose) }
    }

    /// The same with the sender's deviations of position (m) and attitude (rad). Numbers that are not finite or
    /// negative are unknown (MAVLink: NaN), and the settings' stay.
    #[must_use]
    pub fn deviations(self, position: f32, attitude: f32) -> Self {
        let says = |deviation: f32| deviation.is_finite() && deviation >= 0.0;
        Self { deviations: (says(position) && says(attitude)).then_some((position, attitude)), ..self }
    }

    /// The same with MAVLink's quality: negative for a failure of tracking, 0 for unknown, up to 100 %.
    #[must_use]
    pub fn quality(self, quality: i8) -> Self {
        Self { failed: quality < 0, ..self }
    }

    /// The same, of a sender that gives a place alone, so exactly (m): its attitude is the receiver's own, worth so much
    /// (rad).
    #[must_use]
    pub fn place(self, position: f32, attitude: f32) -> Self {
        Self { is_place: true, ..self.deviations(position, attitude) }
    }

    /// The same, rounded to millimetres on its way: standing still is less suspicious then.
    #[must_use]
    pub fn rounded(self) -> Self {
        Self { is_rounded: true, ..self }
    }

    /// The same with MAVLink's reset counter.
    #[must_use]
    pub fn reset_counter(self, resets: u8) -> Self {
        Self { resets, ..self }
    }

    /// Whether what its sender gave equals what that of `other` gave, to the last bit.
    pub(super) fn is_identical(&self, other: &Self) -> bool {
        self.position == other.position && (self.attitude == other.attitude || self.is_place)
    }
}
